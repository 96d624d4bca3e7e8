/* A compressed packing of the real grading's proportions as a picture: radii 67, 100, 117 and 167 px. */
#ifndef TESTS_BENCH_PACKED_H
#define TESTS_BENCH_PACKED_H

#include <stdint.h>

#include "pipeline/packing/grains.h"

/* Fills the empty table (x_px y_px radius_px angle shape_c shape_s) with about `count` grains and the photo's size. */
int packed_grains(uint64_t seed, long count, struct photo_grains *grains, int *width, int *height);

#endif
