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

/* Writes the output (and the picture); leaves how many rows are flagged, of how many. -1: an error, and no output. */
int grains_of_photo(const struct scene *scene, const struct photo_paths *paths, size_t *flagged, size_t *total);

#endif
