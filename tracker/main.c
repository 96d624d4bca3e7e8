#include <errno.h>
#include <string.h>

#include "pipeline/command/cli.h"
#include "pipeline/files/read_record.h"
#include "pipeline/speak/error.h"
#include "tracker/track_series.h"

struct options {
    struct cli cli;
    struct cli_inputs photos;
    struct series_paths paths;
};

enum { KEY_GRAINS = 0x100, KEY_REFERENCE, KEY_PREVIOUS };

static const struct argp_option option_list[] = {
    {"grains", KEY_GRAINS, "FILE", 0,
     "Grains of the reference photo: from findgrains, or grains.txt or dic_out of the original programs", 0},
    {"reference", KEY_REFERENCE, "FILE", 0, "The reference photo (.tif); every photo is compared with it", 0},
    {"previous", KEY_PREVIOUS, "FILE", 0, "Tracks (or dic_out) of the photo before: where to look first", 0},
    {0}};

static size_t stem_length(const char *name)
{
    const char *dot = strrchr(name, '.');
    return dot && dot > name ? (size_t)(dot - name) : strlen(name);
}

static int same_stem(const char *a, const char *b)
{
    const char *x = basename(a), *y = basename(b);
    return stem_length(x) == stem_length(y) && !strncmp(x, y, stem_length(x));
}

/* Tracks are named after their photos: two of one name would be one file. */
static void check_names(const struct argp_state *state, const struct cli_inputs *photos)
{
    for (size_t k = 1; k < photos->count; k++)
        for (size_t m = 0; m < k; m++)
            if (same_stem(photos->paths[k], photos->paths[m]))
                argp_error(state,
                           "%s has the name of %s, and its tracks would replace those: rename one, or track it "
                           "alone",
                           photos->paths[k], photos->paths[m]);
}

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct options *options = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->cli;
        return 0;
    case KEY_GRAINS:
        options->paths.grains = argument;
        return 0;
    case KEY_REFERENCE:
        options->paths.reference = argument;
        return 0;
    case KEY_PREVIOUS:
        options->paths.previous = argument;
        return 0;
    case ARGP_KEY_ARG:
        return cli_inputs_add(&options->photos, argument) ? ENOMEM : 0;
    case ARGP_KEY_END:
        if (!options->paths.grains || !options->paths.reference)
            argp_error(state, "--grains and --reference are needed");
        if (!options->photos.count)
            argp_error(state, "no photo is given");
        check_names(state, &options->photos);
        return 0;
    }
    return ARGP_ERR_UNKNOWN;
}

static const char help[] =
    "Where is every grain of the reference photo in the other photos?\v"
    "A disc of 0.8 radii of each grain is followed by its speckle: shift, rotation, standard errors and flags, to "
    "about "
    "a thousandth of a pixel. A grain that is not found keeps its row, is flagged, and is looked for again in the next "
    "photo. Give the photos in the order of the test. -o is a file for one "
    "photo, a folder for several.\n\n"
    "Scene: \"tracker\": {\"subset\": 0.8, \"search_px\": 64, \"search_deg\": 60}; \"drift_patches_px\": fixed "
    "speckled "
    "paper, the camera's own motion is undone; \"frame\": {\"markers_px\"}: speckled marks on the walls; \"lens\": a "
    "file of calibration lens, undone.\n\n"
    "Example: tracker --scene scene.json --grains 0000.grains.hdf --reference 0000.tif 0001.tif 0002.tif -o tracks";

static int run(struct options *options)
{
    struct scene scene;
    size_t flagged = 0, total = 0;
    options->paths.photos = options->photos.paths;
    options->paths.photo_count = options->photos.count;
    options->paths.output = options->cli.output;
    int status = scene_read(options->cli.scene, &scene);
    if (!status)
        status = track_series(&scene, &options->paths, &flagged, &total);
    scene_free(&scene);
    cli_inputs_free(&options->photos);
    return status ? status : cli_flagged(&options->cli, flagged, total, "grains are flagged");
}

int main(int argc, char **argv)
{
    const struct argp_child children[] = {CLI_CHILD, {0}};
    const struct argp parser = {option_list, parse, "PHOTO.tif...", help, children, NULL, NULL};
    struct options options = {.cli = CLI_DEFAULT};
    read_record_begin();
    cli_parse(&parser, argc, argv, &options);
    return cli_finish(&options.cli, run(&options));
}
