/* contacts: which grains of one photo touch, in SI units. */
#include <stdlib.h>
#include <string.h>

#include "contacts/arguments.h"
#include "contacts/files.h"
#include "contacts/picture/network_picture.h"
#include "pipeline/draw/canvas.h"
#include "pipeline/files/read_record.h"
#include "pipeline/speak/error.h"
#include "pipeline/packing/loads.h"
#include "pipeline/packing/packing_file.h"

/* Reads everything before working, so that what is wrong with the input shows in the first second. */
static int run(struct arguments *arguments)
{
    struct scene scene = {0};
    struct photo_state photo = {0}, *more = NULL;
    const struct photo_grains **radii = calloc(arguments->radii.count + 1, sizeof *radii);
    struct lens lens;
    struct packing previous = {0}, packing = {0};
    const struct contact_options *options = &arguments->options;
    const char *path = arguments->cli.inputs.paths[0];
    struct contact_summary summary;
    int status = radii ? scene_read(arguments->cli.scene, &scene) : error_memory("further radii");
    if (status == 0 && ((scene.lens && lens_read(scene.lens, &lens)) || photo_state_read(path, &photo)))
        status = -1;
    if (status == 0 && arguments->previous)
        status = packing_read(arguments->previous, &previous) ||
                         state_check_order(arguments->previous, &previous.info, &photo.info)
                     ? -1
                     : 0;
    if (status == 0 && (arguments_complete(arguments, &scene, &previous) ||
                        photos_read(arguments->radii.paths, arguments->radii.count, &more)))
        status = -1;
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
                                  .index = photo.info.index,
                                  .is_reference = status == 0 && photo_state_is_reference(&photo, &scene)};
    if (status == 0 && find_contacts(&input, options, &packing, &summary))
        status = error_context("%s", path);
    if (status == 0 && scene.loads && packing.walls.count)
        status = loads_apply(scene.loads, photo.info.index, packing.length_m, &packing.walls);
    if (status == 0 && !(status = contact_indeterminacy(&scene, &packing, &summary)))
        status = contacts_write(arguments, &scene, &photo, options, &summary, &packing);
    if (status == 0 && arguments->picture)
        status = overlap_picture(arguments->picture, &summary);
    if (status == 0)
        status = contacts_tell(&arguments->cli, options, &summary);
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
    struct arguments arguments = ARGUMENTS_DEFAULT;
    read_record_begin();
    arguments_parse(argc, argv, &arguments);
    int status = run(&arguments);
    cli_inputs_free(&arguments.radii);
    canvas_forget_fonts();
    return cli_finish(&arguments.cli, status);
}
