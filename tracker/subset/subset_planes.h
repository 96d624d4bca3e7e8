/* What an iteration needs of a subset's pixels: instruments, grey, their products, and the matrices made of these. */
#ifndef TRACKER_SUBSET_PLANES_H
#define TRACKER_SUBSET_PLANES_H

#include "tracker/subset/subset.h"

/* The runs are there, with a pixel at least. A subset without texture gets energy 0. */
int subset_fill(const struct photo *reference, struct subset *subset);

#endif
