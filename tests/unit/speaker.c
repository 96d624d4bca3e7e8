/* A program of the smallest kind, for test_cli and test_progress: what the shared command line does to it. */
#include <fcntl.h>
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "pipeline/command/cli.h"
#include "pipeline/speak/error.h"
#include "pipeline/speak/progress.h"

struct options {
    struct cli cli;
    double size;
    int colour;
    const char *work;
    struct cli_inputs inputs;
};

static error_t parse(int key, char *argument, struct argp_state *state)
{
    static const char *const colours[] = {"red", "green", NULL};
    struct options *options = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->cli;
        break;
    case 's':
        options->size = cli_number(state, "--size", argument, 0, 10);
        break;
    case 'c':
        options->colour = cli_choice(state, "--colour", argument, colours);
        break;
    case 'w':
        options->work = argument;
        break;
    case ARGP_KEY_ARG:
        if (cli_inputs_add(&options->inputs, argument))
            return ENOMEM;
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

static void count_to(size_t total)
{
    struct progress progress;
    const struct timespec pause = {0, 2000000};
    progress_begin(&progress, "counting", total);
#pragma omp parallel for
    for (size_t k = 0; k < total; k++) {
        nanosleep(&pause, NULL);
        progress_step(&progress);
    }
    progress_end(&progress);
    printf("counted %zu\n", atomic_load(&progress.done));
}

/* Standard output has no room for the beginning of the text, and has room again at its end. */
static void print_with_a_hole(void)
{
    int out = dup(STDOUT_FILENO), full = open("/dev/full", O_WRONLY);
    dup2(full, STDOUT_FILENO);
    for (int k = 0; k < 3000; k++)
        printf("row %d\n", k);
    dup2(out, STDOUT_FILENO);
    close(full);
    close(out);
}

static int work(const struct options *options)
{
    if (!options->work) {
        printf("size=%g colour=%d threads=%d inputs=%zu\n", options->size, options->colour, omp_get_max_threads(),
               options->inputs.count);
        return 0;
    }
    if (!strcmp(options->work, "input"))
        return error_input("a.tif: two\nlines: do this");
    if (!strcmp(options->work, "odd"))
        return error_input("\xC2\x9B"
                           "31m\x1B[31m\xE9.tif: bad: do this");
    if (!strcmp(options->work, "hole"))
        print_with_a_hole();
    if (!strcmp(options->work, "memory"))
        return error_memory("a table");
    if (!strcmp(options->work, "count"))
        count_to(200);
    if (!strcmp(options->work, "log"))
        log_event("step", "third", 1.0 / 3, "missing", NAN, NULL);
    return !strcmp(options->work, "flag") ? cli_flagged(&options->cli, 6, 100, "grains are flagged") : 0;
}

int main(int argc, char **argv)
{
    const struct argp_child children[] = {CLI_CHILD, {0}};
    const struct argp_option table[] = {{"size", 's', "S", 0, "Size", 0},
                                        {"colour", 'c', "C", 0, "Colour", 0},
                                        {"work", 'w', "W", 0, "What to do", 0},
                                        {0}};
    const struct argp parser = {table, parse, "[FILE ...]", "Speak.", children, NULL, NULL};
    struct options options = {.cli = CLI_DEFAULT};
    cli_parse(&parser, argc, argv, &options);
    int status = cli_finish(&options.cli, work(&options));
    cli_inputs_free(&options.inputs);
    return status;
}
