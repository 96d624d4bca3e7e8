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

/* One member of each type. */
struct options {
    struct cli cli;
    double size;
    int count;
    long many;
    int loud, colour;
    double scale;
    int scale_auto;
    int pair[2];
    double depth;
    const char *work, *written;
    struct cli_inputs list;
};

static int parse_pair(const char *text, void *member)
{
    int *pair = member;
    return sscanf(text, "%d,%d", &pair[0], &pair[1]) == 2 ? 0 : error_input("give two numbers, I,J");
}

static const char *const colours[] = {"red", "green", NULL};

#define AT(field) .at = offsetof(struct options, field)
static const struct option_row rows[] = {
    {"size", "size", OPTION_NUMBER, AT(size), "S", .max = 10, .letter = 's', .help = "Size"},
    {"count", "count", OPTION_WHOLE, AT(count), "N", .min = 2, .max = 100, .zero = 1, .help = "Draws"},
    {"many", "group.many", OPTION_LONG, AT(many), "N", .max = 0x1p53, .help = "Many"},
    {"loud", "loud", OPTION_SWITCH, AT(loud), .help = "Speak up"},
    {"colour", "colour", OPTION_CHOICE, AT(colour), "C", .words = colours, .letter = 'c', .help = "Colour"},
    {"scale", "group.scale", OPTION_NUMBER, AT(scale), "X|auto", .min = 0.5, .max = 2,
     .automatic = offsetof(struct options, scale_auto), .help = "Scale"},
    {"pair", "pair", OPTION_TEXT, AT(pair), "I,J", .parse = parse_pair, .help = "Two"},
    {NULL, "group.inner.depth", OPTION_NUMBER, AT(depth), .min = 1, .max = 9},
    {NULL, "elsewhere", .type = OPTION_ELSE},
    {"work", NULL, OPTION_TEXT, AT(work), "W", .letter = 'w', .help = "What to do"},
    {"written", NULL, OPTION_OUTPUT, AT(written), "FILE", .help = "A second output"},
    {"list", NULL, OPTION_LIST, AT(list), "FILE", .help = "More files"},
    {0}};

/* Judged on the command line, and again with the scene. */
static int check(void *input)
{
    const struct options *options = input;
    return options->count > 50 && options->loud ? error_input("count above 50 and loud: give one of them") : 0;
}

/* `speaker --work scene`: what the command line and the section "tracker" come to together. */
static int speak_scene(struct options *options)
{
    struct scene scene;
    int status =
        scene_read(options->cli.scene, &scene) || options_read(rows, &scene, "tracker", options->cli.given, options);
    if (!status && check(options))
        status = error_context("%s", scene.path);
    if (!status)
        printf("size=%g count=%d many=%ld loud=%d colour=%s scale=%g%s pair=%d,%d depth=%g list=%zu\n", options->size,
               options->count, options->many, options->loud, colours[options->colour], options->scale,
               options->scale_auto ? " auto" : "", options->pair[0], options->pair[1], options->depth,
               options->list.count);
    scene_free(&scene);
    return status ? -1 : 0;
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

static int work(struct options *options)
{
    if (!options->work) {
        printf("size=%g colour=%d threads=%d inputs=%zu\n", options->size, options->colour, omp_get_max_threads(),
               options->cli.inputs.count);
        return 0;
    }
    if (!strcmp(options->work, "scene"))
        return speak_scene(options);
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
    if (!strcmp(options->work, "doubt"))
        return cli_doubt("%d contacts: give a radius", 0);
    if (!strcmp(options->work, "summary"))
        cli_summary(&options->cli, "%d grains,\n%.2f px", 7, 0.5);
    if (!strcmp(options->work, "log"))
        log_event("step", "third", 1.0 / 3, "missing", NAN, NULL);
    return !strcmp(options->work, "flag") ? cli_flagged(&options->cli, 6, 100, "grains are flagged") : 0;
}

int main(int argc, char **argv)
{
    struct options options = {.cli = CLI_DEFAULT, .size = 0.25, .scale = 1, .many = 7};
    const struct program program = {"[FILE ...]", "Speak.", rows, &options, "tracker", 0, CLI_MANY, NULL, check};
    cli_parse(&program, argc, argv);
    int status = cli_finish(&options.cli, work(&options));
    cli_inputs_free(&options.list);
    return status;
}
