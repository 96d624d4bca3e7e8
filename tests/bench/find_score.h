/* Circles that were found against those that were drawn. */
#ifndef TESTS_BENCH_FIND_SCORE_H
#define TESTS_BENCH_FIND_SCORE_H

#include <stddef.h>

#include "pipeline/packing/grains.h"

/* RMS errors, px; overlap: of true contacts along the branch; ratio: error over stated standard error; bound:
 * Cramer-Rao for the visible rim, grey levels known. */
struct find_score {
    size_t truth, found, wrong, contacts;
    double centre, radius, bias, overlap, ratio_centre, ratio_radius, bound_centre, bound_radius, cpu;
};

/* per_length: Fisher information of the shift per length of rim; blur: of the photo, px. cpu is left alone. */
void find_score(const struct photo_grains *truth, const struct photo_grains *grains, double per_length, double blur,
                struct find_score *score);

#endif
