/* How every program speaks: shared options, help, ranges, exit statuses, the one line on failure. A main is
 *
 *     int main(int argc, char **argv)
 *     {
 *         struct options options = {.cli = CLI_DEFAULT, ...};
 *         cli_parse(&parser, argc, argv, &options);        // exits 2 on a wrong command line
 *         return cli_finish(&options.cli, run(&options));  // prints "program: message" and gives the status
 *     }
 *
 * with CLI_CHILD in the parser's children and, in its ARGP_KEY_INIT, state->child_inputs[0] = &options->cli. */
#ifndef PIPELINE_CLI_H
#define PIPELINE_CLI_H

#include <argp.h>
#include <stddef.h>

struct cli {
    const char *scene;  /* --scene */
    const char *output; /* -o */
    const char *log;    /* --log */
    int threads;        /* --threads; 0: as many as the machine has */
    int quiet;          /* --quiet */
    double max_flagged; /* --max-flagged */
    int allow_outside;  /* --allow-outside */
    double max_pixels;  /* --max-pixels; 0: PHOTO_MAX_PIXELS */
    unsigned needs;     /* CLI_NEEDS_*: a missing option is a usage error */
};
#define CLI_MAX_FLAGGED 0.05
#define CLI_DEFAULT                                                                                                    \
    {                                                                                                                  \
        .max_flagged = CLI_MAX_FLAGGED, .needs = CLI_NEEDS_SCENE | CLI_NEEDS_OUTPUT                                    \
    }
enum { CLI_NEEDS_SCENE = 1, CLI_NEEDS_OUTPUT = 2 };

/* The shared options as an argp child (its input is a struct cli *). */
extern const struct argp cli_argp;
#define CLI_CHILD                                                                                                      \
    {                                                                                                                  \
        &cli_argp, 0, "Common options:", 100                                                                           \
    }

/* argp_parse with exit status 2 on a wrong command line and the version of this build; then checks `needs`, applies
 * --threads, opens --log. argv[0] is cut to its base name. */
void cli_parse(const struct argp *argp, int argc, char **argv, void *options);
/* A number in an option's argument, in any locale; outside [min, max] or not a number: usage error. */
double cli_number(const struct argp_state *state, const char *option, const char *text, double min, double max);
/* Position of text among NULL-terminated words, else usage error that lists them. */
int cli_choice(const struct argp_state *state, const char *option, const char *text, const char *const words[]);

/* `status` is -1 after a failure (the error line is printed to stderr and its status returned), else 0 or
 * EXIT_FLAGGED. Closes the log with CPU seconds, wall seconds and peak memory. */
int cli_finish(const struct cli *cli, int status);
/* EXIT_FLAGGED with a note on stderr when flagged > max_flagged * total, else 0; `what`: "grains are flagged". */
int cli_flagged(const struct cli *cli, size_t flagged, size_t total, const char *what);

/* One JSON object per line into --log (no effect without): log_event("refine", "iterations", 3.0, "rms_px", 0.01,
 * NULL): pairs of a name and a double. Not for parallel regions. */
void log_event(const char *event, ...) __attribute__((sentinel));

/* A list of input paths collected in ARGP_KEY_ARG. */
struct cli_inputs {
    char **paths;
    size_t count;
    char *text; /* of cli_inputs_read() */
};
int cli_inputs_add(struct cli_inputs *inputs, char *path);
/* The paths in a file, one per line (once; NULL: none): more than a command line holds. */
int cli_inputs_read(struct cli_inputs *inputs, const char *path);
void cli_inputs_free(struct cli_inputs *inputs);

#endif
