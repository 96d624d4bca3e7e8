/* calibration scale: metres per pixel from known lengths in a photo.
 *
 * Out: film.scale/1: scale_m_per_px for the scene, its standard error from the errors of the marks or, where that is
 * more, from what the lengths disagree by (scatter_px). */
#include <stdio.h>
#include <stdlib.h>

#include "calibration/commands/calibration_commands.h"
#include "calibration/rods/scale.h"
#include "pipeline/command/cli.h"
#include "pipeline/speak/error.h"
#include "pipeline/scene/lens.h"
#include "pipeline/files/json.h"

struct options {
    struct cli cli;
    const char *lens;
    double error_px;
};

#define AT(field) .at = offsetof(struct options, field)
static const struct option_row rows[] = {
    {"lens", NULL, OPTION_TEXT, AT(lens), "FILE", .help = "Lens file: the marks are corrected by it first"},
    {"error-px", NULL, OPTION_NUMBER, AT(error_px), "PX", .max = 100, .help = "Standard error of a mark's position"},
    {0}};

static const char documentation[] =
    "Metres per pixel from known lengths: sides of the frame, a ruler, two marks.\v"
    "Each length is one argument X0,Y0,X1,Y1,METRES: two marks in px as seen in the photo, the distance between them "
    "in m.\n\n"
    "Example: calibration scale 578,1453,7260,1510,0.4008 568,7043,7255,7070,0.4012 -o scale.json\n\n"
    "The result holds scale_m_per_px for the scene and its standard error.";

/* "X0,Y0,X1,Y1,METRES"; the marks are moved to where a lens without distortion shows them. */
static int parse_length(const char *text, const struct lens *lens, struct known_length *length)
{
    char rest;
    if (sscanf(text, "%lf,%lf,%lf,%lf,%lf%c", &length->a.x, &length->a.y, &length->b.x, &length->b.y, &length->metres,
               &rest) != 5)
        return error_input("length '%s': give five numbers X0,Y0,X1,Y1,METRES in px and m", text);
    if (lens) {
        length->a = lens_corrected(lens, length->a);
        length->b = lens_corrected(lens, length->b);
    }
    return 0;
}

/* film.scale/1. One length has nothing to disagree with: no scatter. */
static cJSON *describe(const struct scale *scale, size_t count)
{
    cJSON *object = cJSON_CreateObject();
    cJSON_AddStringToObject(object, "schema", "film.scale/1");
    cJSON_AddNumberToObject(object, "lengths", (double)count);
    cJSON_AddNumberToObject(object, "scale_m_per_px", scale->m_per_px);
    cJSON_AddNumberToObject(object, "s_scale_m_per_px", scale->s_m_per_px);
    if (count > 1)
        cJSON_AddNumberToObject(object, "scatter_px", scale->scatter_px);
    return object;
}

/* Least squares over all lengths (scale.h). */
static int run(const struct options *options)
{
    size_t count = options->cli.inputs.count;
    struct known_length *lengths = calloc(count, sizeof *lengths);
    struct lens lens;
    struct scale scale;
    int status = lengths ? 0 : error_memory("lengths");
    if (!status && options->lens)
        status = lens_read(options->lens, &lens);
    for (size_t k = 0; k < count && !status; k++)
        status = parse_length(options->cli.inputs.paths[k], options->lens ? &lens : NULL, &lengths[k]);
    if (!status)
        status = scale_estimate(lengths, count, options->error_px, &scale);
    if (!status)
        status = calibration_write(options->cli.output, describe(&scale, count));
    if (!status)
        calibration_tell(&options->cli, "scale_m_per_px", scale.m_per_px, scale.s_m_per_px);
    free(lengths);
    return status;
}

int command_scale(int argc, char **argv)
{
    struct options options = {.cli = CLI_NEEDING(CLI_NEEDS_OUTPUT), .error_px = 0.5};
    const struct program program = {"X0,Y0,X1,Y1,METRES...",
                                    documentation,
                                    rows,
                                    &options,
                                    NULL,
                                    1,
                                    CLI_MANY,
                                    "which length? Give X0,Y0,X1,Y1,METRES",
                                    NULL};
    cli_parse(&program, argc, argv);
    return cli_finish(&options.cli, run(&options));
}
