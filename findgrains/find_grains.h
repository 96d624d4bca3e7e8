/* Circles (or ellipses) around the grains of one photo, at the noise limit, with standard errors. Nothing needs to be
 * tuned by hand: grey levels, blur, noise, the width of the fitted band and the radius range come from the photo. */
#ifndef FINDGRAINS_FIND_GRAINS_H
#define FINDGRAINS_FIND_GRAINS_H

#include "findgrains/find_options.h"
#include "pipeline/packing/grains.h"
#include "pipeline/scene/photo.h"

/* Fills the empty table `grains`, from top to bottom: x_px y_px radius_px s_x s_y s_radius flags, with ellipses shape_c
 * shape_s s_shape; px of the photo as seen, standard errors included. A grain that is cut, crowded or badly seen keeps
 * its row and gets a flag. 0, or -1 with a line: no grain (EXIT_INPUT), the zone does not fit the photo, a correction
 * by hand fits nothing, memory is gone. On failure the caller frees the table. notes: NULL is fine. */
int find_grains(const struct photo *photo, const struct find_options *options, struct photo_grains *grains,
                struct find_notes *notes);
/* Measure known grains again, on a later photo: rows keep their numbers; one that cannot be measured keeps its place,
 * flagged. From `known`: x_seen_px y_seen_px where there, else x_px y_px; radius_px. */
int find_known_grains(const struct photo *photo, const struct find_options *options, const struct photo_grains *known,
                      struct photo_grains *grains, struct find_notes *notes);
/* Number of rows that are not to be trusted (GRAIN_DISTRUST). */
size_t find_count_flagged(const struct photo_grains *grains);

#endif
