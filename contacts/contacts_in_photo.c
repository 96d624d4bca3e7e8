#include "contacts/contacts_in_photo.h"

#include <stdlib.h>

#include "contacts/arguments.h"
#include "contacts/files.h"
#include "pipeline/packing/loads.h"

/* The network, its loads, and the text by which the next photo takes over automatic corrections. */
static int build(const struct contact_input *input, const struct contact_options *options, struct packing *packing)
{
    const struct scene *scene = input->scene;
    struct contact_summary summary;
    if (find_contacts(input, options, packing, &summary) ||
        (scene->loads && packing->walls.count &&
         loads_apply(scene->loads, input->index, packing->length_m, &packing->walls)) ||
        contact_indeterminacy(scene, packing, &summary))
        return -1;
    packing->info.index = input->index;
    packing->info.time_s = scene_time(scene, (long)input->index);
    free(packing->info.parameters);
    packing->info.parameters = contact_options_text(options, &summary, scene);
    return packing->info.parameters ? 0 : -1;
}

int contacts_in_photo(const struct scene *scene, const struct photo_grains *grains, const struct patches *patches,
                      int64_t index, const struct packing *previous, struct packing *packing)
{
    const struct photo_state state = {.grains = *grains, .info.index = index};
    const struct packing none = {0};
    struct arguments arguments = ARGUMENTS_DEFAULT;
    struct lens lens;
    if ((scene->lens && lens_read(scene->lens, &lens)) ||
        arguments_complete(&arguments, scene, previous ? previous : &none))
        return -1;
    const struct contact_input input = {.scene = scene,
                                        .grains = grains,
                                        .patches = patches,
                                        .lens = scene->lens ? &lens : NULL,
                                        .seen = grains->x_seen_px == NULL,
                                        .previous = previous,
                                        .index = index,
                                        .is_reference = photo_state_is_reference(&state, scene)};
    if (!build(&input, &arguments.options, packing))
        return 0;
    packing_free(packing);
    return -1;
}
