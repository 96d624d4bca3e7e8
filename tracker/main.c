/* tracker: where the grains of the reference photo are in other photos. */
#include "pipeline/command/cli.h"
#include "pipeline/files/read_record.h"
#include "pipeline/speak/error.h"
#include "tracker/track_series.h"

struct options {
    struct cli cli;
    struct series_paths paths;
};
#define AT(field) .at = offsetof(struct options, field)
static const struct option_row rows[] = {
    {"grains", NULL, OPTION_TEXT, AT(paths.grains), "FILE",
     .help = "Grains of the reference photo: from findgrains, or grains.txt or dic_out of the original programs"},
    {"reference", NULL, OPTION_TEXT, AT(paths.reference), "FILE",
     .help = "The reference photo (.tif); every photo is compared with it"},
    {"previous", NULL, OPTION_TEXT, AT(paths.previous), "FILE",
     .help = "Tracks (or dic_out) of the photo before: where to look first"},
    {0}};

static int check(void *input)
{
    const struct options *options = input;
    if (!options->paths.grains || !options->paths.reference)
        return error_input("--grains and --reference are needed");
    return track_series_names(options->cli.inputs.paths, options->cli.inputs.count);
}

static const char help[] =
    "Where is every grain of the reference photo in the other photos?\v"
    "A disc of 0.8 radii of each grain is followed by its speckle: shift, rotation, standard errors and flags, to "
    "about a thousandth of a pixel. A grain that is not found keeps its row, is flagged, and is looked for again in "
    "the next photo. Give the photos in the order of the test. -o is a file for one photo, a folder for several.\n\n"
    "Scene: \"tracker\": {\"subset\": 0.8, \"search_px\": 64, \"search_deg\": 60}; \"drift_patches_px\": fixed "
    "speckled paper, the camera's own motion is undone; \"frame\": {\"markers_px\"}: speckled marks on the walls; "
    "\"lens\": a file of calibration lens, undone.\n\n"
    "Example: tracker --scene scene.json --grains 0000.grains.hdf --reference 0000.tif 0001.tif 0002.tif -o tracks";

static int run(const struct options *options)
{
    struct scene scene;
    struct series_found found;
    struct series_paths paths = options->paths;
    paths.photos = options->cli.inputs.paths;
    paths.photo_count = options->cli.inputs.count;
    paths.output = options->cli.output;
    int status = scene_read(options->cli.scene, &scene) || track_series(&scene, &paths, &found) ? -1 : 0;
    scene_free(&scene);
    if (!status)
        status = cli_flagged(&options->cli, found.flagged, found.grains, "grains are flagged");
    if (!status)
        cli_summary(&options->cli, "%zu photo%s: %zu of %zu followed, median motion %s%.3g px, median ZNCC %s%.3f",
                    paths.photo_count, paths.photo_count > 1 ? "s" : "", found.grains - found.flagged, found.grains,
                    paths.photo_count > 1 ? "up to " : "", found.motion_px, paths.photo_count > 1 ? "down to " : "",
                    found.zncc);
    return status;
}

int main(int argc, char **argv)
{
    struct options options = {.cli = CLI_DEFAULT};
    const struct program program = {"PHOTO.tif...", help, rows, &options, NULL, 1, CLI_MANY, "give a photo", check};
    read_record_begin();
    cli_parse(&program, argc, argv);
    return cli_finish(&options.cli, run(&options));
}
