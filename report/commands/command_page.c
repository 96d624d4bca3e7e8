/* report page: one HTML page about a series, which needs no other file: pictures stand in it. With --pictures
 * each of them is also written by itself, for slides and papers. */
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
    const char *truth, *pictures, *list;
    int format;
    int maps;
};

static const char *const formats[] = {"svg", "pdf", "png", NULL};

#define AT(field) .at = offsetof(struct options, field)
static const struct option_row rows[] = {
    {"truth", NULL, OPTION_TEXT, AT(truth), "DIR",
     .help = "Compare with DIR/NAME.truth.hdf and DIR/NAME.photo-truth.hdf (virtual tests)"},
    {"maps", NULL, OPTION_WHOLE, AT(maps), "N", .max = 10000,
     .help = "Draw force maps of N states at most, spread over the series"},
    {"pictures", NULL, OPTION_TEXT, AT(pictures), "DIR",
     .help = "Also write every curve, rose and map of the page as a file into DIR"},
    {"format", NULL, OPTION_CHOICE, AT(format), "svg|pdf|png", .words = formats, .help = "Their format"},
    {"list", NULL, OPTION_TEXT, AT(list), "FILE", .help = "Further state files: their paths, one per line"},
    {0}};

static const char documentation[] =
    "Write one HTML page about a series: warnings first, counts and flags per photo, standard errors, contacts, "
    "applied against Weber stress, force maps, inputs with their hashes. The page needs nothing else: no script, no "
    "network.\v"
    "Give the files of all stages in any order; files belong to one state when their names begin alike up to the "
    "first dot.\n\n"
    "Example:\n"
    "  report page --scene scene.json -o report.html out/*.grains.hdf out/*.tracks.hdf out/*.forces.hdf";

static int check(void *input)
{
    const struct options *options = input;
    return options->cli.inputs.count || options->list ? 0 : error_input("give the state files of the series");
}

/* The page is made in memory: it appears whole. Pictures are files of their own as they are drawn. */
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

/* The page links to files that lie beside it, so it is told the folder in which it will lie. */
static int run(struct options *options)
{
    struct scene scene = {0};
    struct series series = {0};
    struct page page = {.truth_folder = options->truth, .maps = options->maps};
    int result = scene_read(options->cli.scene, &scene) || cli_inputs_read(&options->cli.inputs, options->list) ||
                         series_read(options->cli.inputs.paths, options->cli.inputs.count, &series)
                     ? -1
                     : 0;
    char *folder = strdup(options->cli.output);
    if (!folder)
        result = error_memory("a path");
    if (result == 0) {
        page.scene = &scene;
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
    struct options options = {.cli = CLI_DEFAULT, .maps = PAGE_MAPS};
    const struct program program = {"STATE.hdf...", documentation, rows, &options, NULL, 0, CLI_MANY, NULL, check};
    cli_parse(&program, argc, argv);
    int status = cli_finish(&options.cli, run(&options));
    canvas_forget_fonts();
    return status;
}
