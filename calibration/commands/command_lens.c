/* calibration lens: the distortion from photos of one speckled plate, moved rigidly by unknown motions.
 *
 * Discs of the plate are followed by the tracker from the reference photo into each other photo; what deviates from the
 * best rigid motion of each photo is distortion. One fit over all photos: the lens and every motion (lens_fit.h). */
#include "calibration/commands/calibration_commands.h"
#include "calibration/commands/lens_picture.h"
#include "calibration/lens/lens_fit.h"
#include "calibration/lens/lens_plate.h"
#include "pipeline/command/cli.h"
#include "pipeline/draw/canvas.h"
#include "pipeline/speak/error.h"
#include "pipeline/files/json.h"

struct options {
    struct cli cli;
    const char *reference, *picture;
    struct plate_options plate;
};

#define AT(field) .at = offsetof(struct options, field)
static const struct option_row rows[] = {
    {"reference", NULL, OPTION_TEXT, AT(reference), "FILE",
     .help = "Photo of the plate that the others are compared with"},
    {"radius", NULL, OPTION_NUMBER, AT(plate.radius_px), "PX", .min = 8, .max = 1000,
     .help = "Radius of the discs that are followed; default: a sixtieth of the photo"},
    {"search-px", NULL, OPTION_NUMBER, AT(plate.search_px), "PX", .max = 4000,
     .help = "How far the plate may have moved"},
    {"search-deg", NULL, OPTION_NUMBER, AT(plate.search_deg), "DEG", .max = 180, .help = "How far it may have turned"},
    {"picture", NULL, OPTION_OUTPUT, AT(picture), "FILE",
     .help = "Draw what is corrected and what is left as arrows (.svg, .pdf, .png)"},
    {0}};

static const char documentation[] =
    "The distortion of the lens, from three or more photos of one speckled plate that is moved rigidly between them; "
    "the motions need not be known.\v"
    "Cover the whole photo with the plate, shift it by a tenth of the photo or more in both directions, turn it once. "
    "What deviates from a rigid motion is distortion: eight parameters in Brown's form, from what is seen to what a "
    "lens without distortion would show, with their covariance; s_map_px is the standard error of a corrected "
    "position. Name the file in the scene: \"lens\": \"lens.json\".\n\n"
    "Example: calibration lens --reference plate0.tif plate1.tif plate2.tif plate3.tif -o lens.json";

/* For struct program: the fit needs a reference and enough moved photos. */
static int check(void *input)
{
    const struct options *options = input;
    if (!options->reference)
        return error_input("--reference is needed");
    if (options->cli.inputs.count < LENS_FEWEST_PHOTOS)
        return error_input("give at least %d photos of the moved plate", LENS_FEWEST_PHOTOS);
    return 0;
}

/* film.lens/1: centre, K and P of Brown's form, corrected from seen (lens.h); rms_px: what is left at the points that
 * were used; covariance of the eight unknowns, row by row. */
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

/* Follow the plate, fit the lens, write; the picture shows what the fit took away and what it left. */
static int run(const struct options *options)
{
    struct plate plate = {0};
    struct lens_fitted fitted;
    int status =
        plate_follow(options->reference, options->cli.inputs.paths, options->cli.inputs.count, &options->plate, &plate);
    if (!status)
        status = lens_fit(&plate.points, &fitted);
    if (!status)
        status = calibration_write(options->cli.output, describe(&fitted, &plate.points));
    if (!status && options->picture)
        status = lens_picture(options->picture, &plate.points, &fitted);
    if (!status)
        cli_summary(&options->cli, "%zu points, RMS %.3f px, largest correction %.3g px", fitted.used, fitted.rms,
                    fitted.largest);
    plate_free(&plate);
    return status;
}

int command_lens(int argc, char **argv)
{
    struct options options = {.cli = CLI_NEEDING(CLI_NEEDS_OUTPUT), .plate = PLATE_DEFAULT};
    const struct program program = {"PHOTO.tif...", documentation, rows, &options, NULL, 0, CLI_MANY, NULL, check};
    cli_parse(&program, argc, argv);
    return cli_finish(&options.cli, canvas_check_path(options.picture) ? -1 : run(&options));
}
