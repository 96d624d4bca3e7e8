/* Three voices in this order: the command line, the scene, and for automatic corrections what the previous state found,
 * because radii and their error are constant through a series: a correction that changed from photo to photo would look
 * like motion. */
#include "contacts/arguments.h"

#include <string.h>

#include "pipeline/draw/canvas.h"
#include "pipeline/speak/error.h"
#include "pipeline/files/json.h"

/* An ending that cannot be drawn is told at once, not after the contacts were found. */
static int parse_picture(const char *text, void *member)
{
    *(const char **)member = text;
    return canvas_check_path(text);
}

#define AT(field) .at = offsetof(struct arguments, field)
static const struct option_row rows[] = {
    {"previous", NULL, OPTION_TEXT, AT(previous), "FILE",
     .help = "Contacts of the previous photo: relative motions since then, and what is new"},
    {"radii", NULL, OPTION_LIST, AT(radii), "FILE",
     .help = "Grains of another photo, same rows (findgrains --refine): radii and rims are averaged over all photos "
             "that are given; repeat the option for each"},
    {"radius-scale", "radius_scale", OPTION_NUMBER, AT(options.radius_scale), "X|auto", .min = 0.5, .max = 2,
     .automatic = offsetof(struct arguments, options.radius_scale_auto),
     .help = "Multiply every radius by X; auto: found from the overlaps"},
    {"radius-offset", "radius_offset_px", OPTION_NUMBER, AT(options.radius_offset_px), "PX|auto", .min = -1000,
     .max = 1000, .automatic = offsetof(struct arguments, options.radius_offset_auto),
     .help = "Add PX pixels to every radius; auto: found from the overlaps"},
    {"picture", NULL, OPTION_OUTPUT, AT(picture), "FILE", .parse = parse_picture,
     .help = "Draw the histogram of the overlaps near zero with the fitted density (.svg, .pdf, .png): whether the "
             "radii are right"},
    {"repair", "repair", OPTION_SWITCH, AT(options.repair),
     .help = "Where a grain with a weight could not stand, take in its most probable candidates (flag promoted)"},
    {"tolerance", "tolerance_px", OPTION_NUMBER, AT(options.tolerance_px), "PX", .min = -1000, .max = 1000,
     .help = "Take as contact what overlaps more than -PX pixels; default: what more probably touches than not, at "
             "rest or squeezed"},
    {NULL, "candidate_sigmas", OPTION_NUMBER, AT(options.candidate_sigmas), .max = 100},
    {NULL, "frame_error_px", OPTION_NUMBER, AT(options.frame_error_px), .max = 1000},
    {0}};

static const char help[] =
    "Find which grains of a photo touch, in SI units.\v"
    "Reads the grains of one photo (tracker, or findgrains for a single photo), turns pixels into metres with the "
    "scene's scale_m_per_px, finds the walls from its frame and writes grains, walls and contacts, each contact with "
    "its overlap, the standard error and the probability that it truly touches. Pairs that may touch are kept and "
    "flagged `candidate`; the method map of forces weighs them.\n\n"
    "Keys of the scene's section \"contacts\": radius_scale, radius_offset_px, tolerance_px, candidate_sigmas (4), "
    "frame_error_px (0.3: how well the frame's corners are known; 0 takes them as exact).\n\n"
    "Example:\n  contacts --scene scene.json 0001.tracks.hdf --previous 0000.contacts.hdf -o 0001.contacts.hdf";

/* From the attribute `parameters` of the previous state; one without them (other programs) leaves "auto" standing. */
static int follow(const struct packing *previous, struct contact_options *options)
{
    const char *text = previous->info.parameters;
    struct json *json = text ? json_parse(text, strlen(text), "parameters of the previous state") : NULL;
    int status = 0;
    if (!json)
        return text ? -1 : 0;
    if (options->radius_scale_auto &&
        (status = json_number(json, json_root(json), "radius_scale", 0.5, 2, &options->radius_scale)) > 0)
        options->radius_scale_auto = 0;
    if (status >= 0 && options->radius_offset_auto &&
        (status = json_number(json, json_root(json), "radius_offset_px", -1000, 1000, &options->radius_offset_px)) > 0)
        options->radius_offset_auto = 0;
    json_free(json);
    return status < 0 ? -1 : 0;
}

int arguments_complete(struct arguments *arguments, const struct scene *scene, const struct packing *previous)
{
    if (options_read(rows, scene, "contacts", arguments->cli.given, arguments))
        return -1;
    return follow(previous, &arguments->options);
}

void arguments_parse(int argc, char **argv, struct arguments *arguments)
{
    static struct program program = {"N.tracks.hdf|N.grains.hdf",
                                     help,
                                     rows,
                                     NULL,
                                     "contacts",
                                     1,
                                     1,
                                     "give one file of grains or tracks: N.tracks.hdf or N.grains.hdf",
                                     NULL};
    program.options = arguments;
    cli_parse(&program, argc, argv);
}
