/* The loads' say (the equations are in the header). The walls of the scene's corners serve: their error is small
 * against the specimen, over which V tr sigma is summed. */
#include "contacts/radii/loaded_overlaps.h"

#include "contacts/walls/frame.h"
#include "pipeline/packing/loads.h"
#include "pipeline/packing/stress.h"

static int is_known(const struct scene *scene)
{
    return scene->loads && scene->frame.given && scene->contact_given && contact_law_row(&scene->contact)->linear &&
           scene->contact.kn > 0;
}

static double mean_radius(const struct grains *grains)
{
    double sum = 0, count = 0;
    for (size_t k = 0; k < grains->count; k++)
        if (!(grains->flags[k] & GRAIN_DISTRUST)) {
            sum += grains->radius[k];
            count++;
        }
    return count > 0 ? sum / count : 0;
}

/* The walls as the corners in the scene have them: the grains are not asked yet. */
static int walls_of_scene(const struct contact_input *input, const struct grains *grains, struct frame *frame)
{
    const struct frame_request request = {.scene = input->scene, .lens = input->lens, .grains = grains};
    return frame_walls(&request, frame);
}

int loaded_overlaps(const struct contact_input *input, const struct grains *grains, double *sum)
{
    const struct scene *scene = input->scene;
    struct frame frame = {0};
    double sigma[2][2];
    *sum = 0;
    if (!is_known(scene))
        return 0;
    int status = walls_of_scene(input, grains, &frame);
    if (status == 0)
        status = loads_apply(scene->loads, input->index, scene->grains.length, &frame.now);
    struct packing view = {.grains = *grains, .walls = frame.now, .length_m = NAN};
    double area;
    if (status == 0)
        status = packing_area(&view, &area);
    if (status == 0) {
        double share_of_walls = 2 * mean_radius(grains) / sqrt(area);
        stress_applied(&view, 1, sigma); /* times the volume */
        double value = (sigma[0][0] + sigma[1][1]) / scene->contact.kn * (1 - share_of_walls);
        *sum = value > 0 ? value : 0;
    }
    frame_free(&frame);
    return status;
}
