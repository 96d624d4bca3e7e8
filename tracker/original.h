/* Text files of the original 1gamma2epsilon programs, read where the tracker takes grains or an earlier photo; px and
 * rad.
 *
 *     grains.txt       N, then  x y rot R
 *     dic_out_n.txt    N, then  refx refy refrot R dx dy drot upix vpix rot_inc NCC NCC_rescue NCC_subpix
 *
 * Which one it is, is told by the number of columns. CONF files are in metres: they are refused by name. */
#ifndef TRACKER_ORIGINAL_H
#define TRACKER_ORIGINAL_H

#include "pipeline/packing/grains.h"

/* Does the file begin with a digit, as both do? A state file does not. */
int original_is_text(const char *path);

/* Circles of the reference photo, from either, into the empty table: x_px, y_px, radius_px; flags 0. 0, or -1 with a
 * line that names file and row; nothing is to be freed then. */
int original_read_grains(const char *path, struct photo_grains *grains);

/* Where the `reference` grains were in an earlier photo, from dic_out: only what says where to look next. These files
 * know nothing of lens and camera: when these are `corrected` here, the motion since that photo is not known. NaN
 * stands for a grain that was lost. */
int original_read_motion(const char *path, int corrected, const struct photo_grains *reference,
                         struct photo_grains *previous);

#endif
