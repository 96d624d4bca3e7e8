#include <stdlib.h>
#include <string.h>

#include "contacts/files.h"
#include "pipeline/cli.h"
#include "pipeline/error.h"
#include "pipeline/loads.h"

struct arguments {
    struct cli cli;
    const char *input, *previous;
    struct contact_options given; /* NaN: not on the command line */
};

enum { PREVIOUS = 256, RADIUS_SCALE, RADIUS_OFFSET, TOLERANCE };

static const struct argp_option option_list[] = {
    {"previous", PREVIOUS, "FILE", 0, "Contacts of the previous photo: relative motions since then, and what is new",
     0},
    {"radius-scale", RADIUS_SCALE, "X|auto", 0, "Multiply every radius by X (1); auto: found from the overlaps", 0},
    {"radius-offset", RADIUS_OFFSET, "PX|auto", 0, "Add PX pixels to every radius (0); auto: found from the overlaps",
     0},
    {"tolerance", TOLERANCE, "PX", 0,
     "Take as contact what overlaps more than -PX pixels (default: what touches with a probability above one quarter)",
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

/* The scene's options, then those of the command line. */
static int choose_options(const struct arguments *arguments, const struct scene *scene, struct contact_options *options)
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
    options->tolerance_px = isfinite(given->tolerance_px) ? given->tolerance_px : options->tolerance_px;
    return 0;
}

static int write_packing(const struct arguments *arguments, const struct scene *scene, const struct photo_state *photo,
                         const struct contact_options *options, const struct contact_summary *summary,
                         const struct packing *packing)
{
    const char *inputs[] = {arguments->cli.scene, arguments->input, arguments->previous};
    struct provenance provenance = PROVENANCE_DEFAULT;
    char *parameters = contact_options_text(options, summary);
    if (!parameters)
        return -1;
    provenance.stage = "contacts";
    provenance.parameters = parameters;
    provenance.input_paths = inputs;
    provenance.input_count = arguments->previous ? 3 : 2;
    provenance.index = photo->info.index;
    provenance.time_s = isfinite(photo->info.time_s) ? photo->info.time_s : scene_time(scene, photo->info.index);
    provenance.coordinates = "si";
    provenance.length_m = packing->length_m;
    memcpy(provenance.strain, packing->info.strain, sizeof provenance.strain);
    int status = packing_write(arguments->cli.output, packing, &provenance);
    free(parameters);
    return status;
}

static void tell(const struct contact_summary *summary)
{
    log_event("contacts", "grains", (double)summary->grains, "unusable", (double)summary->unusable, "contacts",
              (double)summary->contacts, "wall_contacts", (double)summary->wall_contacts, "candidates",
              (double)summary->candidates, "rattlers", (double)summary->rattlers, "floating", (double)summary->floating,
              "mean_overlap_px", summary->mean_overlap_px, "s_overlap_px", summary->s_overlap_px, "resting_share",
              summary->resting_share, "radius_scale", summary->radius_scale, "radius_offset_px",
              summary->radius_offset_px, "s_radius_scale", summary->s_radius_scale, "s_radius_offset_px",
              summary->s_radius_offset_px, "undecided", summary->undecided ? 1.0 : 0.0, NULL);
}

static int run(const struct arguments *arguments)
{
    struct scene scene = {0};
    struct photo_state photo = {0};
    struct packing previous = {0}, packing = {0};
    struct contact_options options = CONTACT_OPTIONS_DEFAULT;
    struct contact_summary summary;
    int status = scene_read(arguments->cli.scene, &scene);
    if (status == 0)
        status = choose_options(arguments, &scene, &options);
    if (status == 0)
        status = photo_state_read(arguments->input, &photo);
    if (status == 0 && arguments->previous)
        status = packing_read(arguments->previous, &previous);
    if (status == 0)
        status = contact_options_follow(&previous, &options);
    struct contact_input input = {.scene = &scene,
                                  .grains = &photo.grains,
                                  .patches = &photo.patches,
                                  .previous = arguments->previous ? &previous : NULL,
                                  .is_reference = status == 0 && photo_state_is_reference(&photo, &scene)};
    if (status == 0 && find_contacts(&input, &options, &packing, &summary))
        status = error_context("%s", arguments->input);
    if (status == 0 && scene.loads && packing.walls.count)
        status = loads_apply(scene.loads, photo.info.index, packing.length_m, &packing.walls);
    if (status == 0)
        status = write_packing(arguments, &scene, &photo, &options, &summary, &packing);
    if (status == 0) {
        tell(&summary);
        status = cli_flagged(&arguments->cli, summary.unusable, summary.grains, "grains without position or radius");
    }
    packing_free(&packing);
    packing_free(&previous);
    photo_state_free(&photo);
    scene_free(&scene);
    return status;
}

int main(int argc, char **argv)
{
    static const struct argp_child children[] = {CLI_CHILD, {0}};
    static const struct argp argp = {
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
    struct arguments arguments = {.cli = CLI_DEFAULT,
                                  .given = {.radius_scale = NAN, .radius_offset_px = NAN, .tolerance_px = NAN}};
    cli_parse(&argp, argc, argv, &arguments);
    return cli_finish(&arguments.cli, run(&arguments));
}
