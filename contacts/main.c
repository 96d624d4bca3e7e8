#include <stdlib.h>
#include <string.h>

#include "contacts/arguments.h"
#include "contacts/files.h"
#include "pipeline/error.h"
#include "pipeline/loads.h"

static int write_packing(const struct arguments *arguments, const struct scene *scene, const struct photo_state *photo,
                         const struct contact_options *options, const struct contact_summary *summary,
                         const struct packing *packing)
{
    size_t count = 0;
    const char **inputs = malloc((arguments->radii.count + 2) * sizeof *inputs);
    struct provenance provenance = PROVENANCE_DEFAULT;
    char *parameters = contact_options_text(options, summary);
    if (!inputs || !parameters) {
        free(inputs);
        free(parameters);
        return inputs ? -1 : error_memory("names of the inputs");
    }
    inputs[count++] = arguments->input;
    if (arguments->previous)
        inputs[count++] = arguments->previous;
    for (size_t m = 0; m < arguments->radii.count; m++)
        inputs[count++] = arguments->radii.paths[m];
    provenance.stage = "contacts";
    provenance.parameters = parameters;
    provenance.scene = scene;
    provenance.input_paths = inputs;
    provenance.input_count = count;
    provenance.index = photo->info.index;
    provenance.time_s = isfinite(photo->info.time_s) ? photo->info.time_s : scene_time(scene, photo->info.index);
    provenance.coordinates = "si";
    provenance.length_m = packing->length_m;
    memcpy(provenance.strain, packing->info.strain, sizeof provenance.strain);
    int status = packing_write(arguments->cli.output, packing, &provenance);
    free(parameters);
    free(inputs);
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
    struct photo_state photo = {0}, *more = NULL;
    const struct photo_grains **radii = calloc(arguments->radii.count + 1, sizeof *radii);
    struct lens lens;
    struct packing previous = {0}, packing = {0};
    struct contact_options options = CONTACT_OPTIONS_DEFAULT;
    struct contact_summary summary;
    int status = radii ? scene_read(arguments->cli.scene, &scene) : error_memory("further radii");
    if (status == 0 && scene.lens)
        status = lens_read(scene.lens, &lens);
    if (status == 0)
        status = photo_state_read(arguments->input, &photo);
    if (status == 0 && arguments->previous)
        status = packing_read(arguments->previous, &previous);
    if (status == 0)
        status = arguments_options(arguments, &scene, &previous, &options);
    if (status == 0)
        status = photos_read(arguments->radii.paths, arguments->radii.count, &more);
    for (size_t m = 0; status == 0 && m < arguments->radii.count; m++)
        radii[m] = &more[m].grains;
    struct contact_input input = {.scene = &scene,
                                  .grains = &photo.grains,
                                  .patches = &photo.patches,
                                  .lens = scene.lens ? &lens : NULL,
                                  .seen = !strcmp(photo.info.coordinates, "seen"),
                                  .more_radii = radii,
                                  .more_count = arguments->radii.count,
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
    photos_free(more, arguments->radii.count);
    free(radii);
    photo_state_free(&photo);
    scene_free(&scene);
    return status;
}

int main(int argc, char **argv)
{
    struct arguments arguments = ARGUMENTS_NONE;
    cli_parse(&contacts_argp, argc, argv, &arguments);
    int status = run(&arguments);
    cli_inputs_free(&arguments.radii);
    return cli_finish(&arguments.cli, status);
}
