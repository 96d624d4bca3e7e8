/* Speckled patches that the tracker follows beside the grains: fixed paper (drift) and marks on the walls. Photo
 * side: px, y down. */
#ifndef PIPELINE_PATCHES_H
#define PIPELINE_PATCHES_H

#include "pipeline/state/columns.h"

struct patches {
    size_t count;
    char (*kind)[NAME_LENGTH];     /* "drift" or "wall" */
    char (*name)[NAME_LENGTH];     /* of the wall; "paper" */
    double *x_px, *y_px;           /* centre in this photo */
    double *dx_px, *dy_px, *angle; /* motion since the reference, camera drift undone for walls */
    double *s_x, *s_y, *s_angle;   /* of the motion */
    double *zncc;
    uint32_t *flags; /* grain flags */
};
extern const struct table_kind PATCHES;

#endif
