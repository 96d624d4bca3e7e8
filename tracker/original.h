/* Text files of the original 1gamma2epsilon programs, read where the tracker takes grains or an earlier photo.
 *
 *     grains.txt       N, then  x y rot R                               px
 *     dic_out_n.txt    N, then  refx refy refrot R dx dy drot upix vpix rot_inc NCC NCC_rescue NCC_subpix    px, rad
 *     CONFnnnn         N, then  x y rot R and #CORNERS ... or  x y R rot NCC1 NCC2                 m (y up), rad
 *
 * Which one it is, is told by the number of columns, and for four of them by a #CORNERS line. In the four columns of
 * CONF R stands in px. */
#ifndef TRACKER_ORIGINAL_H
#define TRACKER_ORIGINAL_H

#include "pipeline/grains.h"
#include "pipeline/scene.h"

/* Does the file begin with a digit, as all of these do? A state file does not. */
int original_is_text(const char *path);

/* Circles of the reference photo, from any of the three; metres become px by the scene's scale and origin. */
int original_read_grains(const char *path, const struct scene *scene, struct photo_grains *grains);

/* Where the `reference` grains were in an earlier photo, from dic_out or CONF: only what says where to look next.
 * NaN stands for a grain that was lost. */
int original_read_motion(const char *path, const struct scene *scene, const struct photo_grains *reference,
                         struct photo_grains *previous);

#endif
