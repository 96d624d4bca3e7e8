/* What else is to be seen at a measured rim: a second edge, the end of the grey range. */
#ifndef FINDGRAINS_RIM_LOOKS_H
#define FINDGRAINS_RIM_LOOKS_H

#include "pipeline/scene/photo.h"
#include "findgrains/capture/rim.h"
#include "findgrains/look/threshold.h"

/* The flank of the rod beside its face, as a camera sees it that does not stand straight in front: behind the rim, on
 * one side only, a plateau between grain and void and a second fall. */
int rim_shows_flank(const struct photo *photo, const struct rim *rim, const struct grey_levels *levels, double blur);
/* More than a quarter of the band below the rim is at the end of the grey range: the rim then seems to lie outside. */
int rim_is_saturated(const struct photo *photo, const struct rim *rim, double blur);

#endif
