/* Circles (or ellipses) around the grains of one photo, at the noise limit, with standard errors. Nothing needs to be
 * tuned by hand: grey levels, blur, noise, the width of the fitted band and the radius range come from the photo. */
#ifndef FINDGRAINS_FIND_GRAINS_H
#define FINDGRAINS_FIND_GRAINS_H

#include "findgrains/find_options.h"
#include "pipeline/packing/grains.h"
#include "pipeline/scene/photo.h"

/* Fills the empty table `grains`, from top to bottom. An error (EXIT_INPUT) when there is no grain. notes: NULL is
 * fine. */
int find_grains(const struct photo *photo, const struct find_options *options, struct photo_grains *grains,
                struct find_notes *notes);
/* Measure known grains again, on a later photo: rows keep their numbers; one that cannot be measured keeps its place,
 * flagged. From `known`: x_seen_px y_seen_px where there, else x_px y_px; radius_px. */
int find_known_grains(const struct photo *photo, const struct find_options *options, const struct photo_grains *known,
                      struct photo_grains *grains, struct find_notes *notes);
/* Rows that are not to be trusted. */
size_t find_count_flagged(const struct photo_grains *grains);

#endif
