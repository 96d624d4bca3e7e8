/* argp does the parsing: this file hands it the rows as options, and its finds back to the rows. What it cannot know,
 * such as ranges, defaults and what several options say together, is judged here, always through argp_error(), so that
 * every wrong command line ends alike: one line, a hint at --help, EXIT_USAGE.
 *
 * One program runs per process: the log, the clock and the running program are static. */
#include "pipeline/command/cli.h"

#include <argp.h>
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
#include "pipeline/speak/version.h"

static FILE *log_file;
static const char *log_path;
static struct timespec begin;

/* Wall time by a clock that nobody sets. */
static double seconds_since(const struct timespec *then)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)(now.tv_sec - then->tv_sec) + 1e-9 * (double)(now.tv_nsec - then->tv_nsec);
}

/* One line, whatever stands in a file's name. */
static void print_line(const char *message)
{
    char line[2048];
    text_clean(message, line, sizeof line);
    fprintf(stderr, "%s: %s\n", program_invocation_short_name, line);
}

/* ---- options ---- */

#define AT(field) .at = offsetof(struct cli, field)
static const struct option_row shared[] = {
    {"scene", NULL, OPTION_TEXT, AT(scene), "SCENE.json", .help = "The description of the experiment"},
    {"output", NULL, OPTION_OUTPUT, AT(output), "OUT", .letter = 'o',
     .help = "Write the result here (and nowhere else); a folder where there are several files"},
    {"threads", NULL, OPTION_WHOLE, AT(threads), "N", .max = 4096,
     .help = "Use N threads, 0: as many as the machine has; results do not depend on it"},
    {"quiet", NULL, OPTION_SWITCH, AT(quiet), .letter = 'q', .help = "No progress bar, no summary"},
    {"log", NULL, OPTION_OUTPUT, AT(log), "FILE", .help = "Write times and iterations here, one JSON object per line"},
    {"max-flagged", NULL, OPTION_NUMBER, AT(max_flagged), "SHARE", .max = 1,
     .help = "Exit with status 4 when a larger share of the rows is flagged; the output is written all the same"},
    {"allow-outside", NULL, OPTION_SWITCH, AT(allow_outside),
     .help = "The scene may name files outside its own folder: absolute paths, '..', links that lead out of it"},
    {"max-pixels", NULL, OPTION_LONG, AT(max_pixels), "N", .min = 1, .max = (double)PHOTO_MAX_PIXELS,
     .help = "Refuse photos of more than N pixels before reading them"},
    {0}};

/* argp knows the rows of a program's own table by OWN + k, those of the shared one by SHARED + k. */
enum { OWN = 0x1000, SHARED = 0x2000 };
static const struct program *running;
static struct cli_inputs written, words; /* that options took as outputs; all others that may name files */

/* The row that argp means; NULL: one of argp's own keys, or none. */
static const struct option_row *row_of(int key)
{
    enum { SHARED_ROWS = sizeof shared / sizeof *shared };
    return key >= SHARED && key < SHARED + SHARED_ROWS              ? &shared[key - SHARED]
           : running->rows && key >= OWN && key < OWN + OPTION_MOST ? &running->rows[key - OWN]
                                                                    : NULL;
}

/* The short letter of a row is its key for argp. */
static int key_of(int letter)
{
    for (int k = 0; option_is_row(&shared[k]); k++)
        if (shared[k].letter == letter)
            return SHARED + k;
    for (int k = 0; running->rows && option_is_row(&running->rows[k]); k++)
        if (running->rows[k].letter == letter)
            return OWN + k;
    return letter;
}

/* What argp calls an option, for each row that has a name; `list` has room for OPTION_MOST + 1. */
static void list_options(const struct option_row *rows, int base, struct argp_option *list)
{
    for (int k = 0; rows && option_is_row(&rows[k]); k++)
        if (rows[k].name)
            *list++ = (struct argp_option){rows[k].name,     rows[k].letter ? rows[k].letter : base + k,
                                           rows[k].argument, 0,
                                           rows[k].help,     rows[k].group};
    *list = (struct argp_option){0};
}

/* argp's hook on every text of --help. */
static char *describe(int key, const char *text, void *input)
{
    const struct option_row *row = row_of(key > 0 && key < OWN ? key_of(key) : key);
    (void)input;
    if (!row)
        return (char *)text;
    return option_describe(row, running->section, running->options);
}

/* Of the program's rows and the shared ones. Only memory can fail otherwise than by a wrong word: then argp_parse()
 * ends with ENOMEM. */
static error_t parse_row(int key, char *argument, struct argp_state *state)
{
    struct cli *cli = running->options;
    if (key > 0 && key < OWN)
        key = key_of(key);
    const struct option_row *row = row_of(key);
    if (!row)
        return ARGP_ERR_UNKNOWN;
    if (option_take(row, argument, running->options)) {
        if (error_status() == EXIT_FAILED)
            return ENOMEM;
        argp_error(state, "--%s %s: %s", row->name, argument, error_message());
    }
    if (row->type == OPTION_OUTPUT || row->type == OPTION_TEXT || row->type == OPTION_LIST)
        if (cli_inputs_add(row->type == OPTION_OUTPUT ? &written : &words, argument))
            return ENOMEM;
    if (key >= OWN && key < OWN + OPTION_MOST)
        cli->given |= (uint64_t)1 << (key - OWN);
    return 0;
}

int cli_given(const struct cli *cli, const char *name)
{
    const struct option_row *rows = cli->program->rows;
    for (int k = 0; rows && option_is_row(&rows[k]); k++)
        if (rows[k].name && !strcmp(rows[k].name, name))
            return cli->given >> k & 1;
    return 0;
}

/* By what the words mean, not how they are spelt: argp lets an option be cut short or joined with its value. Texts that
 * are no paths are asked for too: they name no file, and cost a stat(). */
static void check_overwriting(const struct argp_state *state)
{
    const char *overwritten = cli_overwritten(&written, &words);
    if (overwritten)
        argp_error(state, "%s is also an input, and would be overwritten: name another file", overwritten);
}

/* After every word has been seen; the program's own check may still change what it needs. */
static void check_whole(const struct argp_state *state, const struct cli *cli)
{
    if (cli->inputs.count > running->most)
        argp_error(state, "'%s' is one too many: %s", cli->inputs.paths[running->most],
                   running->asks ? running->asks : "this command takes no files");
    if (cli->inputs.count < running->least)
        argp_error(state, "%s", running->asks);
    if (running->check && running->check(running->options))
        argp_error(state, "%s", error_message());
    if ((cli->needs & CLI_NEEDS_SCENE) && !cli->scene)
        argp_error(state, "which experiment? Give --scene SCENE.json");
    if ((cli->needs & CLI_NEEDS_OUTPUT) && !cli->output)
        argp_error(state, "where should the result go? Give -o OUT");
    check_overwriting(state);
}

/* The root parser: it alone sees the words that are no options, and the end of the line. */
static error_t parse_word(int key, char *argument, struct argp_state *state)
{
    struct cli *cli = running->options;
    if (key == ARGP_KEY_ARG)
        return cli_inputs_add(&cli->inputs, argument) || cli_inputs_add(&words, argument) ? ENOMEM : 0;
    if (key == ARGP_KEY_END)
        check_whole(state, cli);
    return key == ARGP_KEY_END ? 0 : parse_row(key, argument, state);
}

/* What acts on the whole process. Not before the line is known to be right: --log empties a file. */
static void apply(const struct cli *cli)
{
    if (cli->threads > 0)
        omp_set_num_threads(cli->threads);
    if (cli->quiet)
        progress_silence();
    if (cli->allow_outside)
        scene_allow_outside();
    photo_limit_pixels(cli->max_pixels);
    log_path = cli->log;
    if (log_path && !(log_file = fopen(log_path, "w"))) {
        error_set(EXIT_FAILED, "%s: %s: name a file that can be written", log_path, strerror(errno));
        print_line(error_message());
        exit(EXIT_FAILED);
    }
}

void cli_parse(const struct program *program, int argc, char **argv)
{
    static char version[100];
    struct argp_option own[OPTION_MOST + 1], common[OPTION_MOST + 1];
    const struct argp shared_argp = {.options = common, .parser = parse_row, .help_filter = describe};
    const struct argp_child children[] = {{&shared_argp, 0, "Common options:", 100}, {0}};
    const struct argp argp = {
        program->rows ? own : NULL, parse_word, program->arguments, program->help, children, describe, NULL};
    struct cli *cli = program->options;
    clock_gettime(CLOCK_MONOTONIC, &begin);
    running = cli->program = program;
    list_options(program->rows, OWN, own);
    list_options(shared, SHARED, common);
    argv[0] = program_invocation_short_name;
    snprintf(version, sizeof version, "%.60s (film) %s", argv[0], film_version);
    argp_program_version = version;
    argp_err_exit_status = EXIT_USAGE;
    new_file_remove_on_signals();
    FILE *before = cli_messages_begin(argv);
    error_t failed = argp_parse(&argp, argc, argv, 0, NULL, NULL);
    cli_messages_end(before);
    cli_inputs_free(&written);
    cli_inputs_free(&words);
    if (failed) {
        fprintf(stderr, "%s: %s\n", argv[0], strerror(failed));
        exit(failed == ENOMEM ? EXIT_FAILED : EXIT_USAGE);
    }
    apply(cli);
}

/* ---- the end of a program ---- */

/* Of all threads, user and system. */
static double cpu_seconds(const struct rusage *usage)
{
    return (double)(usage->ru_utime.tv_sec + usage->ru_stime.tv_sec) +
           1e-6 * (double)(usage->ru_utime.tv_usec + usage->ru_stime.tv_usec);
}

/* A log that could not be written whole is a failure, as any output is. */
static int close_log(void)
{
    if (!log_file)
        return 0;
    int failed = ferror(log_file);
    failed |= fclose(log_file);
    log_file = NULL;
    return failed ? error_failed("%s: %s: is the disk full?", log_path, strerror(errno)) : 0;
}

/* Standard output is data: a program that could not write it has failed, also when an early write failed and the last
 * one did not. A failure that set no status counts as EXIT_FAILED. */
int cli_finish(struct cli *cli, int status)
{
    struct rusage usage;
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
    cli_inputs_free(&cli->inputs);
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

static void print_format(const char *format, va_list values)
{
    char line[2000];
    vsnprintf(line, sizeof line, format, values);
    print_line(line);
}

int cli_doubt(const char *format, ...)
{
    va_list values;
    va_start(values, format);
    print_format(format, values);
    va_end(values);
    return EXIT_FLAGGED;
}

void cli_summary(const struct cli *cli, const char *format, ...)
{
    va_list values;
    if (cli->quiet)
        return;
    va_start(values, format);
    print_format(format, values);
    va_end(values);
}

/* ---- log ---- */

/* Numbers with 17 digits, so that nothing is lost; those that are not finite become null, as JSON has no other. */
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
