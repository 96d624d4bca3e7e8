#include "pipeline/speak/version.h"
#include "pipeline/command/cli.h"

#include <errno.h>
#include <math.h>
#include <omp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

#include "pipeline/command/cli_messages.h"
#include "pipeline/command/cli_overwrite.h"
#include "pipeline/speak/error.h"
#include "pipeline/files/new_file.h"
#include "pipeline/files/number.h"
#include "pipeline/scene/photo.h"
#include "pipeline/speak/progress.h"
#include "pipeline/scene/scene.h"
#include "pipeline/speak/text.h"

static FILE *log_file;
static const char *log_path;
static struct timespec begin;

static double seconds_since(const struct timespec *then)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)(now.tv_sec - then->tv_sec) + 1e-9 * (double)(now.tv_nsec - then->tv_nsec);
}

/* ---- options ---- */

enum { KEY_SCENE = 0x1000, KEY_LOG, KEY_THREADS, KEY_MAX_FLAGGED, KEY_ALLOW_OUTSIDE, KEY_MAX_PIXELS };

static const struct argp_option options[] = {
    {"scene", KEY_SCENE, "SCENE.json", 0, "The description of the experiment", 0},
    {"output", 'o', "OUT", 0, "Write the result here (and nowhere else); a folder where there are several files", 0},
    {"threads", KEY_THREADS, "N", 0,
     "Use N threads (default 0: as many as the machine has); results do not depend on it", 0},
    {"quiet", 'q', NULL, 0, "No progress bar", 0},
    {"log", KEY_LOG, "FILE", 0, "Write times and iterations here, one JSON object per line", 0},
    {"max-flagged", KEY_MAX_FLAGGED, "SHARE", 0,
     "Exit with status 4 when a larger share of the rows is flagged (default 0.05); the output is written all the same",
     0},
    {"allow-outside", KEY_ALLOW_OUTSIDE, NULL, 0,
     "The scene may name files outside its own folder: absolute paths, '..', links that lead out of it", 0},
    {"max-pixels", KEY_MAX_PIXELS, "N", 0, "Refuse photos of more than N pixels (default 2^30) before reading them", 0},
    {0}};

/* Runs after every parser has seen the whole command line, so a program can still change what it needs. */
static void check_and_apply(const struct argp_state *state, const struct cli *cli)
{
    if ((cli->needs & CLI_NEEDS_SCENE) && !cli->scene)
        argp_error(state, "which experiment? Give --scene SCENE.json");
    if ((cli->needs & CLI_NEEDS_OUTPUT) && !cli->output)
        argp_error(state, "where should the result go? Give -o OUT");
    const char *overwritten = cli_overwritten(state->argc, state->argv);
    if (overwritten)
        argp_error(state, "%s is also an input, and would be overwritten: name another file", overwritten);
    if (cli->threads > 0)
        omp_set_num_threads(cli->threads);
    if (cli->quiet)
        progress_silence();
    if (cli->allow_outside)
        scene_allow_outside();
    if (cli->max_pixels > 0)
        photo_limit_pixels((size_t)cli->max_pixels);
    log_path = cli->log;
    if (log_path && !(log_file = fopen(log_path, "w"))) {
        fprintf(stderr, "%s: %s: %s: name a file that can be written\n", state->name, log_path, strerror(errno));
        exit(EXIT_FAILED);
    }
}

static double whole_number(const struct argp_state *state, const char *option, const char *text, double min, double max)
{
    double number = cli_number(state, option, text, min, max);
    if (number != floor(number))
        argp_error(state, "%s %s: give a whole number", option, text);
    return number;
}

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    struct cli *cli = state->input;
    switch (key) {
    case KEY_SCENE:
        cli->scene = argument;
        break;
    case 'o':
        cli->output = argument;
        break;
    case KEY_LOG:
        cli->log = argument;
        break;
    case KEY_THREADS:
        cli->threads = (int)whole_number(state, "--threads", argument, 0, 4096);
        break;
    case KEY_ALLOW_OUTSIDE:
        cli->allow_outside = 1;
        break;
    case KEY_MAX_PIXELS:
        cli->max_pixels = whole_number(state, "--max-pixels", argument, 1, (double)PHOTO_MAX_PIXELS);
        break;
    case 'q':
        cli->quiet = 1;
        break;
    case KEY_MAX_FLAGGED:
        cli->max_flagged = cli_number(state, "--max-flagged", argument, 0, 1);
        break;
    case ARGP_KEY_SUCCESS:
        check_and_apply(state, cli);
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

const struct argp cli_argp = {.options = options, .parser = parse_option};

void cli_parse(const struct argp *argp, int argc, char **argv, void *input)
{
    static char version[100];
    clock_gettime(CLOCK_MONOTONIC, &begin);
    argv[0] = program_invocation_short_name;
    snprintf(version, sizeof version, "%.60s (film) %s", argv[0], film_version);
    argp_program_version = version;
    argp_err_exit_status = EXIT_USAGE;
    new_file_remove_on_signals();
    FILE *before = cli_messages_begin(argv);
    error_t failed = argp_parse(argp, argc, argv, 0, NULL, input);
    cli_messages_end(before);
    if (failed) {
        fprintf(stderr, "%s: %s\n", argv[0], strerror(failed));
        exit(failed == ENOMEM ? EXIT_FAILED : EXIT_USAGE);
    }
}

double cli_number(const struct argp_state *state, const char *option, const char *text, double min, double max)
{
    double value = min;
    if (number_parse(text, &value) || !(value >= min && value <= max))
        argp_error(state, "%s %s: give a number from %g to %g", option, text, min, max);
    return value;
}

int cli_choice(const struct argp_state *state, const char *option, const char *text, const char *const words[])
{
    char list[500] = "";
    size_t used = 0;
    for (int k = 0; words[k]; k++) {
        if (!strcmp(words[k], text))
            return k;
        if (used < sizeof list)
            used += (size_t)snprintf(list + used, sizeof list - used, "%s%s", k ? ", " : "", words[k]);
    }
    argp_error(state, "%s %s: give one of: %s", option, text, list);
    return -1;
}

/* ---- the end of a program ---- */

/* One line, whatever stands in a file's name. */
static void print_line(const char *message)
{
    char line[2048];
    text_clean(message, line, sizeof line);
    fprintf(stderr, "%s: %s\n", program_invocation_short_name, line);
}

static double cpu_seconds(const struct rusage *usage)
{
    return (double)(usage->ru_utime.tv_sec + usage->ru_stime.tv_sec) +
           1e-6 * (double)(usage->ru_utime.tv_usec + usage->ru_stime.tv_usec);
}

static int close_log(void)
{
    if (!log_file)
        return 0;
    int failed = ferror(log_file);
    failed |= fclose(log_file);
    log_file = NULL;
    return failed ? error_failed("%s: %s: is the disk full?", log_path, strerror(errno)) : 0;
}

int cli_finish(const struct cli *cli, int status)
{
    struct rusage usage;
    (void)cli;
    int cut = ferror(stdout); /* an earlier write failed; why is no longer known */
    if ((fflush(stdout) || cut) && status >= 0)
        status = error_failed("standard output: %s: is the disk full?", cut ? "cut short" : strerror(errno));
    int code = status >= 0 ? status : error_status() != EXIT_DONE ? error_status() : EXIT_FAILED;
    getrusage(RUSAGE_SELF, &usage);
    log_event("finish", "status", (double)code, "cpu_s", cpu_seconds(&usage), "wall_s", seconds_since(&begin),
              "peak_memory_bytes", 1024.0 * (double)usage.ru_maxrss, NULL);
    if (status < 0)
        print_line(error_message());
    if (close_log() && status >= 0) {
        print_line(error_message());
        code = EXIT_FAILED;
    }
    return code;
}

int cli_flagged(const struct cli *cli, size_t flagged, size_t total, const char *what)
{
    if ((double)flagged <= cli->max_flagged * (double)total)
        return 0;
    char note[400];
    snprintf(note, sizeof note,
             "%.150s: %zu of %zu %.100s, more than --max-flagged %g allows: it is written, look at its rows",
             cli->output ? cli->output : "done", flagged, total, what, cli->max_flagged);
    print_line(note);
    return EXIT_FLAGGED;
}

/* ---- log ---- */

void log_event(const char *event, ...)
{
    va_list pairs;
    const char *name;
    if (!log_file)
        return;
    fprintf(log_file, "{\"event\":\"%s\"", event);
    va_start(pairs, event);
    while ((name = va_arg(pairs, const char *))) {
        double value = va_arg(pairs, double);
        if (isfinite(value))
            fprintf(log_file, ",\"%s\":%.17g", name, value);
        else
            fprintf(log_file, ",\"%s\":null", name);
    }
    va_end(pairs);
    fputs("}\n", log_file);
}
