#include "contacts/arguments.h"

#include <errno.h>
#include <string.h>

#include "pipeline/draw/canvas.h"
#include "pipeline/speak/error.h"

enum { PREVIOUS = 256, RADII, RADIUS_SCALE, RADIUS_OFFSET, TOLERANCE, REPAIR, PICTURE };

static const struct argp_option option_list[] = {
    {"previous", PREVIOUS, "FILE", 0, "Contacts of the previous photo: relative motions since then, and what is new",
     0},
    {"radii", RADII, "FILE", 0,
     "Grains of another photo, same rows (findgrains --refine): radii and rims are averaged over all photos that are "
     "given; repeat the option for each",
     0},
    {"radius-scale", RADIUS_SCALE, "X|auto", 0, "Multiply every radius by X (1); auto: found from the overlaps", 0},
    {"radius-offset", RADIUS_OFFSET, "PX|auto", 0, "Add PX pixels to every radius (0); auto: found from the overlaps",
     0},
    {"picture", PICTURE, "FILE", 0,
     "Draw the histogram of the overlaps near zero with the fitted density (.svg, .pdf, .png): whether the radii are "
     "right",
     0},
    {"repair", REPAIR, NULL, 0,
     "Where a grain with a weight could not stand, take in its most probable candidates (flag promoted)", 0},
    {"tolerance", TOLERANCE, "PX", 0,
     "Take as contact what overlaps more than -PX pixels (default: what more probably touches than not, at rest or "
     "squeezed)",
     0},
    {0}};

static error_t parse_option(int key, char *arg, struct argp_state *state)
{
    struct arguments *arguments = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &arguments->cli;
        return 0;
    case PREVIOUS:
        arguments->previous = arg;
        return 0;
    case RADII:
        return cli_inputs_add(&arguments->radii, arg) ? ENOMEM : 0;
    case RADIUS_SCALE:
        if (strcmp(arg, "auto"))
            arguments->given.radius_scale = cli_number(state, "radius-scale", arg, 0.5, 2);
        else
            arguments->given.radius_scale_auto = 1;
        return 0;
    case RADIUS_OFFSET:
        if (strcmp(arg, "auto"))
            arguments->given.radius_offset_px = cli_number(state, "radius-offset", arg, -1000, 1000);
        else
            arguments->given.radius_offset_auto = 1;
        return 0;
    case PICTURE:
        if (canvas_check_path(arg))
            argp_error(state, "--picture %s", error_message());
        arguments->picture = arg;
        return 0;
    case REPAIR:
        arguments->given.repair = 1;
        return 0;
    case TOLERANCE:
        arguments->given.tolerance_px = cli_number(state, "tolerance", arg, -1000, 1000);
        return 0;
    case ARGP_KEY_ARG:
        if (arguments->input)
            argp_error(state, "one file of grains or tracks at a time, not also %s", arg);
        arguments->input = arg;
        return 0;
    case ARGP_KEY_END:
        if (!arguments->input)
            argp_error(state, "which file? Give N.tracks.hdf or N.grains.hdf");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

int arguments_options(const struct arguments *arguments, const struct scene *scene, const struct packing *previous,
                      struct contact_options *options)
{
    const struct contact_options *given = &arguments->given;
    if (contact_options_read(scene, options))
        return -1;
    if (isfinite(given->radius_scale) || given->radius_scale_auto) {
        options->radius_scale_auto = given->radius_scale_auto;
        options->radius_scale = given->radius_scale_auto ? 1 : given->radius_scale;
    }
    if (isfinite(given->radius_offset_px) || given->radius_offset_auto) {
        options->radius_offset_auto = given->radius_offset_auto;
        options->radius_offset_px = given->radius_offset_auto ? 0 : given->radius_offset_px;
    }
    options->repair |= given->repair;
    options->tolerance_px = isfinite(given->tolerance_px) ? given->tolerance_px : options->tolerance_px;
    return contact_options_follow(previous, options);
}

static const struct argp_child children[] = {CLI_CHILD, {0}};
const struct argp contacts_argp = {
    option_list,
    parse_option,
    "N.tracks.hdf|N.grains.hdf",
    "Find which grains of a photo touch, in SI units.\v"
    "Reads the grains of one photo (tracker, or findgrains for a single photo), turns pixels into metres with the "
    "scene's scale_m_per_px, finds the walls from its frame and writes grains, walls and contacts, each contact "
    "with its overlap, the standard error and the probability that it truly touches. Pairs that may touch are kept "
    "and flagged `candidate`; the method map of forces weighs them.\n\n"
    "Keys of the scene's section \"contacts\": radius_scale, radius_offset_px, tolerance_px, candidate_sigmas (4), "
    "frame_error_px (0.3: how well the frame's corners are known; 0 takes them as exact).\n\n"
    "Example:\n  contacts --scene scene.json 0001.tracks.hdf --previous 0000.contacts.hdf -o 0001.contacts.hdf",
    children,
    NULL,
    NULL};
