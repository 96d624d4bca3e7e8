/* From photo to file: the grains of one photo, in px, with what the scene and the hand corrections say. */
#ifndef FINDGRAINS_GRAINS_OF_PHOTO_H
#define FINDGRAINS_GRAINS_OF_PHOTO_H

#include <stddef.h>

#include "pipeline/scene/scene.h"

struct photo_paths {
    const char *photo, *output;  /* N.tif, N.grains.hdf */
    const char *picture;         /* P.png with the circles drawn over the photo; NULL: none */
    const char *refine;          /* grains that are measured again, row for row, instead of a search; NULL: a search */
    const char *added, *removed; /* lists of corrections (corrections.h); NULL: none */
};

/* What was found, for people. */
struct photo_found {
    size_t grains, flagged;
    double least_px, most_px; /* radii of the rows that are not flagged; NaN: none */
};

/* Writes the output (and the picture), and says what was found. -1: an error, and no output. */
int grains_of_photo(const struct scene *scene, const struct photo_paths *paths, struct photo_found *found);

#endif
