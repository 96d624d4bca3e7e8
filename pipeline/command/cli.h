/* How every program speaks: its options and the shared ones from tables of rows, help, exit statuses, the one line on
 * failure. A main is
 *
 *     int main(int argc, char **argv)
 *     {
 *         struct options options = {.cli = CLI_DEFAULT, ...};
 *         const struct program program = {"PHOTO.tif", help, rows, &options, .least = 1, .most = 1, ...};
 *         cli_parse(&program, argc, argv);                 // exits 2 on a wrong command line
 *         return cli_finish(&options.cli, run(&options));  // prints "program: message" and gives the status
 *     } */
#ifndef PIPELINE_CLI_H
#define PIPELINE_CLI_H

#include "pipeline/command/cli_inputs.h"
#include "pipeline/command/option_table.h"

/* What every program takes; the first member of each program's struct of options. */
struct cli {
    const char *scene;  /* --scene */
    const char *output; /* -o */
    const char *log;    /* --log */
    int threads;        /* --threads; 0: as many as the machine has */
    int quiet;          /* --quiet */
    double max_flagged; /* --max-flagged */
    int allow_outside;  /* --allow-outside */
    size_t max_pixels;  /* --max-pixels */
    unsigned needs;     /* CLI_NEEDS_*: a missing option is a usage error */

    struct cli_inputs inputs; /* the words that are no options; freed by cli_finish() */
    const struct program *program;
    uint64_t given; /* bit k: row k of the program's table stood on the command line */
};
enum { CLI_NEEDS_SCENE = 1, CLI_NEEDS_OUTPUT = 2 };
#define CLI_MAX_FLAGGED 0.05
#define CLI_NEEDING(what)                                                                                              \
    {                                                                                                                  \
        .max_flagged = CLI_MAX_FLAGGED, .max_pixels = PHOTO_MAX_PIXELS, .needs = (what)                                \
    }
#define CLI_DEFAULT CLI_NEEDING(CLI_NEEDS_SCENE | CLI_NEEDS_OUTPUT)

struct program {
    const char *arguments;         /* of the usage line, one form per line: "PHOTO.tif..."; NULL: takes no files */
    const char *help;              /* what stands before the options, then \v, then what stands after them */
    const struct option_row *rows; /* its own options; NULL: the shared ones only */
    void *options;                 /* its struct of options, which begins with a struct cli */
    const char *section;           /* of the scene, whose keys the rows name; NULL: none */
    size_t least, most;            /* how many inputs; CLI_MANY: any number */
    const char *asks;              /* said when there are fewer or more: "give one TIFF file" */
    /* What only the whole command line tells: -1 with an error that becomes a usage error. May change `needs`. */
    int (*check)(void *options);
};
#define CLI_MANY SIZE_MAX

/* Fills program->options (argp underneath); a wrong command line ends the program with EXIT_USAGE and one line that
 * says what to give. Then applies --threads and opens --log. argv[0] is cut to its base name. */
void cli_parse(const struct program *program, int argc, char **argv);
/* Did the program's own option --name stand on the command line? */
int cli_given(const struct cli *cli, const char *name);

/* `status` is -1 after a failure (the error line is printed to stderr and its status returned), else 0 or
 * EXIT_FLAGGED. Closes the log with CPU seconds, wall seconds and peak memory; frees the inputs. */
int cli_finish(struct cli *cli, int status);
/* EXIT_FLAGGED with a note on stderr when flagged > max_flagged * total, else 0; `what`: "grains are flagged". */
int cli_flagged(const struct cli *cli, size_t flagged, size_t total, const char *what);
/* A result that was written and is hardly what was wanted: one line on stderr, also with --quiet, that says what is
 * wrong and what to do, as printf() would print it. EXIT_FLAGGED. */
int cli_doubt(const char *format, ...) __attribute__((format(printf, 1, 2)));
/* What was found, for people, at the end of a run that went well: one line on stderr, "program: ...", as printf() would
 * print it; nothing with --quiet. */
void cli_summary(const struct cli *cli, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* One JSON object per line into --log (no effect without): log_event("refine", "iterations", 3.0, "rms_px", 0.01,
 * NULL): pairs of a name and a double. Not for parallel regions. */
void log_event(const char *event, ...) __attribute__((sentinel));

/* A program of several commands, each with a command line of its own: "report map ...". */
struct subcommand {
    const char *name, *full_name; /* "map", "report map" */
    int (*run)(int argc, char **argv);
    const char *what; /* a line of --help */
};
/* The main of such a program: runs the command that argv[1] names, or says which there are. `commands` ends with a
 * NULL name; `what`: a line about the program. */
int cli_command(const char *program, const char *what, const struct subcommand *commands, int argc, char **argv);

#endif
