/* calibration lens: options, call, write. */
#include <errno.h>

#include "calibration/commands/calibration_commands.h"
#include "calibration/commands/lens_picture.h"
#include "calibration/lens/lens_fit.h"
#include "calibration/lens/lens_plate.h"
#include "pipeline/command/cli.h"
#include "pipeline/draw/canvas.h"
#include "pipeline/speak/error.h"

struct options {
    struct cli cli;
    struct cli_inputs photos;
    const char *reference, *picture;
    struct plate_options plate;
};

enum { KEY_REFERENCE = 0x100, KEY_RADIUS, KEY_SEARCH, KEY_TURN, KEY_PICTURE };

static const struct argp_option option_list[] = {
    {"reference", KEY_REFERENCE, "FILE", 0, "Photo of the plate that the others are compared with", 0},
    {"radius", KEY_RADIUS, "PX", 0, "Radius of the discs that are followed (default: a sixtieth of the photo)", 0},
    {"search-px", KEY_SEARCH, "PX", 0, "How far the plate may have moved (default 400)", 0},
    {"search-deg", KEY_TURN, "DEG", 0, "How far it may have turned (default 30)", 0},
    {"picture", KEY_PICTURE, "FILE", 0, "Draw what is corrected and what is left as arrows (.svg, .pdf, .png)", 0},
    {0}};

static const char documentation[] =
    "The distortion of the lens, from three or more photos of one speckled plate that is moved rigidly between them; "
    "the motions need not be known.\v"
    "Cover the whole photo with the plate, shift it by a tenth of the photo or more in both directions, turn it once. "
    "What deviates from a rigid motion is distortion: eight parameters in Brown's form, from what is seen to what a "
    "lens without distortion would show, with their covariance; s_map_px is the standard error of a corrected "
    "position. Name the file in the scene: \"lens\": \"lens.json\".\n\n"
    "Example: calibration lens --reference plate0.tif plate1.tif plate2.tif plate3.tif -o lens.json";

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    struct options *options = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->cli;
        return 0;
    case KEY_REFERENCE:
        options->reference = argument;
        return 0;
    case KEY_RADIUS:
        options->plate.radius_px = cli_number(state, "--radius", argument, 8, 1000);
        return 0;
    case KEY_SEARCH:
        options->plate.search_px = cli_number(state, "--search-px", argument, 0, 4000);
        return 0;
    case KEY_TURN:
        options->plate.search_deg = cli_number(state, "--search-deg", argument, 0, 180);
        return 0;
    case KEY_PICTURE:
        options->picture = argument;
        return 0;
    case ARGP_KEY_ARG:
        return cli_inputs_add(&options->photos, argument) ? ENOMEM : 0;
    case ARGP_KEY_END:
        if (!options->reference)
            argp_error(state, "--reference is needed");
        if (options->photos.count < LENS_FEWEST_PHOTOS)
            argp_error(state, "give at least %d photos of the moved plate", LENS_FEWEST_PHOTOS);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static cJSON *describe(const struct lens_fitted *fitted, const struct lens_points *points)
{
    const double centre[2] = {fitted->lens.centre.x, fitted->lens.centre.y};
    const double size[2] = {points->width, points->height};
    cJSON *object = cJSON_CreateObject();
    cJSON_AddStringToObject(object, "schema", "film.lens/1");
    cJSON_AddStringToObject(object, "map", "corrected from seen");
    cJSON_AddItemToObject(object, "centre_px", cJSON_CreateDoubleArray(centre, 2));
    cJSON_AddItemToObject(object, "K", cJSON_CreateDoubleArray(fitted->lens.k, 3));
    cJSON_AddItemToObject(object, "P", cJSON_CreateDoubleArray(fitted->lens.p, 3));
    cJSON_AddItemToObject(object, "size_px", cJSON_CreateDoubleArray(size, 2));
    cJSON_AddNumberToObject(object, "photos", (double)points->photos);
    cJSON_AddNumberToObject(object, "points", (double)fitted->used);
    cJSON_AddNumberToObject(object, "left_out", (double)fitted->left_out);
    cJSON_AddNumberToObject(object, "rms_px", fitted->rms);
    cJSON_AddNumberToObject(object, "s_map_px", fitted->s_map);
    cJSON_AddNumberToObject(object, "largest_px", fitted->largest);
    cJSON *rows = cJSON_AddArrayToObject(object, "covariance");
    for (int a = 0; a < LENS_UNKNOWNS; a++)
        cJSON_AddItemToArray(rows, cJSON_CreateDoubleArray(fitted->covariance[a], LENS_UNKNOWNS));
    return object;
}

static int run(const struct options *options)
{
    struct plate plate = {0};
    struct lens_fitted fitted;
    int status =
        plate_follow(options->reference, options->photos.paths, options->photos.count, &options->plate, &plate);
    if (!status)
        status = lens_fit(&plate.points, &fitted);
    if (!status)
        status = calibration_write(options->cli.output, describe(&fitted, &plate.points));
    if (!status && options->picture)
        status = lens_picture(options->picture, &plate.points, &fitted);
    plate_free(&plate);
    return status;
}

int command_lens(int argc, char **argv)
{
    const struct argp_child children[] = {CLI_CHILD, {0}};
    const struct argp parser = {option_list, parse_option, "PHOTO.tif...", documentation, children, NULL, NULL};
    struct options options = {.cli = {.max_flagged = CLI_MAX_FLAGGED, .needs = CLI_NEEDS_OUTPUT},
                              .plate = PLATE_DEFAULT};
    cli_parse(&parser, argc, argv, &options);
    int status = cli_finish(&options.cli, canvas_check_path(options.picture) ? -1 : run(&options));
    cli_inputs_free(&options.photos);
    return status;
}
