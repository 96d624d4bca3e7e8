/* The public call of findgrains (CONTRIBUTING.md, "Public headers"): the scene says everything, no options are needed.
 */
#ifndef FINDGRAINS_GRAINS_IN_PHOTO_H
#define FINDGRAINS_GRAINS_IN_PHOTO_H

#include "pipeline/packing/grains.h"
#include "pipeline/scene/photo.h"
#include "pipeline/scene/scene.h"

/* Find the grains of one photo, with the scene's frame, lens, grains.radius_px and section "findgrains". Fills the
 * empty table `grains`, a row per grain, from top to bottom: x_px y_px radius_px and their standard errors s_x s_y
 * s_radius, px of the photo as seen (x right, y down, pixel centres at integers), flags (enum grain_flag), with
 * ellipses shape_c shape_s s_shape. A grain that is cut, crowded or badly seen keeps its row and gets a flag.
 *
 * Scene and photo stay the caller's; grains are to be freed by table_free(&PHOTO_GRAINS, grains), after a failure, too.
 * 0, or -1 with a line (pipeline/speak/error.h): no grain, a wrong key of the scene, a frame that does not fit the
 * photo (EXIT_INPUT); memory is gone (EXIT_FAILED). How: docs/findgrains.md. */
int grains_in_photo(const struct scene *scene, const struct photo *photo, struct photo_grains *grains);

#endif
