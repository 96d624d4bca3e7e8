/* The camera's own motion, from pieces of fixed speckled paper: translation, rotation and zoom by weighted least
 * squares, undone for everything else in the photo. */
#ifndef TRACKER_DRIFT_H
#define TRACKER_DRIFT_H

#include <stddef.h>

#include "tracker/follow/correct.h"

/* moved = centre + t + (1 + zoom, turn; -turn, 1 + zoom) (corrected - centre): the direction is corrected -> moved;
 * what is seen is that through the lens. */
struct camera {
    int known;     /* 0: every patch was lost; nothing can be corrected */
    double cx, cy; /* px */
    double p[4];   /* zoom, turn (rad), tx, ty (px) */
    double covariance[4][4];
};
#define CAMERA_FIXED                                                                                                   \
    {                                                                                                                  \
        .known = 1                                                                                                     \
    }

/* From `count` patches with the lens undone; those that are not good are left out. One patch gives translation and
 * rotation, two or more the zoom too. The covariance is widened when the patches disagree by more than their errors. */
struct camera camera_fit(const struct corrected *patches, const int *good, size_t count);

/* Undo the camera's motion at a place (px, moved) and an angle (rad), in place. The camera is known. */
void camera_undo(const struct camera *camera, double *x, double *y, double *angle);
/* Variance that it adds to a position there (x, y) and to an angle. */
void camera_variance(const struct camera *camera, double x, double y, double *xx, double *yy, double *angle);

#endif
