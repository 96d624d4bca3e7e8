/* From the scene to the photo: the camera moves between photos. "Corrected" positions are those of the first
 * camera position, "seen" ones are those in the photo; both in px, x right, y down. */
#ifndef SIMULATION_CAMERA_H
#define SIMULATION_CAMERA_H

#include "pipeline/numbers/geometry.h"
#include "pipeline/scene/lens.h"

/* How the camera has moved when a photo is taken: seen = middle + zoom Q(angle) (corrected - middle) + shift, with the
 * photo's middle and angle counter-clockwise as seen. */
struct view {
    double dx, dy, angle; /* px, px, rad */
    double zoom;          /* 0 counts as 1, so that a zeroed view is the first camera */
    double blur;          /* px: added to the standard deviation of the point spread */
    double brightness;    /* multiplies the light; 0 counts as 1 */
};

struct camera {
    struct vec middle; /* of the photo */
    struct view view;
    const struct lens *lens; /* NULL: none */
};

/* From corrected to seen px (the camera moves, then its lens distorts) and back. */
struct vec camera_seen(const struct camera *camera, struct vec corrected);
struct vec camera_corrected(const struct camera *camera, struct vec seen);
/* Seen px per corrected px (root of the area's), and rotation of a small body, at a corrected position. */
void camera_local(const struct camera *camera, struct vec corrected, double *zoom, double *angle);

#endif
