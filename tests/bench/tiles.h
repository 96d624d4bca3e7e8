/* A packing of any size in exact equilibrium: copies of one packing, mirrored at the frictionless walls of its box. A
 * grain that pushed a wall pushes its mirror image with the same force. */
#ifndef BENCH_TILES_H
#define BENCH_TILES_H

#include "pipeline/packing/packing.h"

/* k x k copies of `tile`, with its forces "dem"; overlaps are those that give the forces. */
int tiles_mirrored(const struct packing *tile, size_t k, struct packing *packing);

#endif
