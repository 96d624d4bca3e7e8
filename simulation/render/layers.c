/* Which paint lies over which: faces hide flanks, flanks hide what stands behind. A cell that is half hidden gets half
 * the light of each. */
#include "simulation/render/layers.h"

#include "pipeline/numbers/random.h"

uint64_t body_key(const struct optics *optics, enum body body, size_t number)
{
    return random_bits(random_bits(optics->seed, (uint64_t)body), number);
}

void layers_paint(const struct picture *picture, const struct optics *optics, struct tile *tile)
{
    size_t cells = (size_t)tile->width * (size_t)tile->height;
    faces_paint(picture, optics, tile);
    backdrop_paint(picture, optics, tile);
    for (size_t at = 0; at < cells; at++)
        tile->value[at] += (1 - tile->cover[at]) * tile->back[at];
}
