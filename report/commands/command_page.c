/* report page: options, read, call, write. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "pipeline/command/cli.h"
#include "pipeline/speak/error.h"
#include "pipeline/scene/scene.h"
#include "pipeline/draw/canvas.h"
#include "report/commands/report_commands.h"
#include "report/page/page.h"
#include "report/export/text_file.h"

struct options {
    struct cli cli;
    struct cli_inputs files;
    const char *truth, *pictures, *list;
    int format;
    int maps;
};

enum { KEY_TRUTH = 0x2000, KEY_MAPS, KEY_PICTURES, KEY_FORMAT, KEY_LIST };
static const char *const formats[] = {"svg", "pdf", "png", NULL};

static const struct argp_option option_list[] = {
    {"truth", KEY_TRUTH, "DIR", 0, "Compare with DIR/NAME.truth.hdf and DIR/NAME.photo-truth.hdf (virtual tests)", 0},
    {"maps", KEY_MAPS, "N", 0, "Draw force maps of N states at most, spread over the series (default 6)", 0},
    {"pictures", KEY_PICTURES, "DIR", 0, "Also write every curve, rose and map of the page as a file into DIR", 0},
    {"format", KEY_FORMAT, "svg|pdf|png", 0, "Their format (default svg)", 0},
    {"list", KEY_LIST, "FILE", 0, "Further state files: their paths, one per line", 0},
    {0}};

static const char documentation[] =
    "Write one HTML page about a series: warnings first, counts and flags per photo, standard errors, contacts, "
    "applied "
    "against Weber stress, force maps, inputs with their hashes. The page needs nothing else: no script, no network.\v"
    "Give the files of all stages in any order; files belong to one state when their names begin alike up to the first "
    "dot.\n\n"
    "Example:\n"
    "  report page --scene scene.json -o report.html out/*.grains.hdf out/*.tracks.hdf out/*.forces.hdf";

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    struct options *options = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->cli;
        return 0;
    case KEY_TRUTH:
        options->truth = argument;
        return 0;
    case KEY_MAPS:
        options->maps = (int)cli_number(state, "--maps", argument, 0, 10000);
        return 0;
    case KEY_PICTURES:
        options->pictures = argument;
        return 0;
    case KEY_FORMAT:
        options->format = cli_choice(state, "--format", argument, formats);
        return 0;
    case ARGP_KEY_ARG:
        return cli_inputs_add(&options->files, argument) ? ENOMEM : 0;
    case KEY_LIST:
        options->list = argument;
        return 0;
    case ARGP_KEY_END:
        if (options->files.count == 0 && !options->list)
            argp_error(state, "give the state files of the series");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static int write_page(const struct options *options, const struct page *page, const struct series *series)
{
    struct html html;
    if (options->pictures && mkdir(options->pictures, 0777) && errno != EEXIST)
        return error_failed("%s: %s: name a folder that can be made", options->pictures, strerror(errno));
    if (html_begin(&html))
        return -1;
    html.pictures = options->pictures;
    html.extension = formats[options->format];
    int result = page_write(page, series, &html);
    if (html_end(&html) || result)
        result = -1;
    else
        result = text_file_write(options->cli.output, html.text, html.length);
    html_free(&html);
    return result;
}

static int run(struct options *options)
{
    struct scene scene = {0};
    struct series series = {0};
    struct page page = {.truth_folder = options->truth, .maps = options->maps};
    int result = scene_read(options->cli.scene, &scene) || cli_inputs_read(&options->files, options->list) ||
                         series_read(options->files.paths, options->files.count, &series)
                     ? -1
                     : 0;
    char *folder = strdup(options->cli.output);
    if (!folder)
        result = error_memory("a path");
    if (result == 0) {
        page.name = scene.name;
        folder[basename(folder) - folder] = '\0';
        page.folder = folder;
        result = write_page(options, &page, &series);
    }
    free(folder);
    series_free(&series);
    scene_free(&scene);
    return result;
}

int command_page(int argc, char **argv)
{
    const struct argp_child children[] = {CLI_CHILD, {0}};
    const struct argp parser = {option_list, parse_option, "STATE.hdf...", documentation, children, NULL, NULL};
    struct options options = {.cli = CLI_DEFAULT, .maps = PAGE_MAPS};
    cli_parse(&parser, argc, argv, &options);
    int status = cli_finish(&options.cli, run(&options));
    cli_inputs_free(&options.files);
    canvas_forget_fonts();
    return status;
}
