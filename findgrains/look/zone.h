/* The specimen zone: where grains can be. px, x right, y down. */
#ifndef FINDGRAINS_ZONE_H
#define FINDGRAINS_ZONE_H

#include "pipeline/numbers/geometry.h"

struct zone {
    int width, height;     /* of the photo */
    int has_frame;         /* 0: the whole photo */
    struct vec corners[4]; /* top-left, top-right, bottom-right, bottom-left */
    double corner_radius;  /* of the discs at the corners; 0: none */
    double bend;           /* px that the frame's sides are seen away from the lines between the corners */
    struct vec inward[4];  /* unit normals of the four sides, into the zone */
    int x0, y0, x1, y1;    /* bounding box inside the photo, x1 and y1 excluded */
};

/* The whole photo when corners is NULL. An error when the corners do not stand in order round a convex quadrilateral
 * or lie outside the photo. */
int zone_make(int width, int height, const struct vec *corners, double corner_radius, struct zone *zone);
/* Distance to the zone's nearest edge, positive inside; the border of the photo does not count. */
double zone_depth(const struct zone *zone, double x, double y);
/* Distance to the nearest outermost pixel centre, plus half a pixel; positive inside the photo. */
double zone_photo_depth(const struct zone *zone, double x, double y);

#endif
