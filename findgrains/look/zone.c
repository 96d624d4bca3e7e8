/* The zone is what lies on the inner side of four straight lines and outside the discs at the corners. y points down,
 * so that corners in the order top-left, top-right, bottom-right, bottom-left go clockwise as seen and a quarter turn
 * of a side points inwards. */
#include "findgrains/look/zone.h"

#include "pipeline/speak/error.h"

#include <math.h>

static int clamp(double value, int low, int high)
{
    return value < low ? low : value > high ? high : (int)value;
}

/* Inward normals of the four sides; -1 when the corners are in the wrong order. */
static int make_sides(struct zone *zone)
{
    for (int side = 0; side < 4; side++) {
        struct vec a = zone->corners[side], b = zone->corners[(side + 1) % 4], c = zone->corners[(side + 2) % 4];
        /* Clockwise as seen with y down: the interior lies on vec_turn's side of each edge. */
        zone->inward[side] = vec_turn(vec_unit(vec_sub(b, a)));
        if (!(vec_dot(vec_sub(c, b), zone->inward[side]) > 0))
            return error_input("frame.corners_px: the corners do not go round a convex quadrilateral: give them as "
                               "top-left, top-right, bottom-right, bottom-left");
    }
    return 0;
}

/* The whole pixels around the corners. */
static int make_box(struct zone *zone)
{
    double x0 = INFINITY, y0 = INFINITY, x1 = -INFINITY, y1 = -INFINITY;
    for (int k = 0; k < 4; k++) {
        x0 = fmin(x0, zone->corners[k].x);
        y0 = fmin(y0, zone->corners[k].y);
        x1 = fmax(x1, zone->corners[k].x);
        y1 = fmax(y1, zone->corners[k].y);
    }
    zone->x0 = clamp(floor(x0) - 4, 0, zone->width);
    zone->y0 = clamp(floor(y0) - 4, 0, zone->height);
    zone->x1 = clamp(ceil(x1) + 5, 0, zone->width);
    zone->y1 = clamp(ceil(y1) + 5, 0, zone->height);
    if (zone->x1 - zone->x0 < 8 || zone->y1 - zone->y0 < 8)
        return error_input("frame.corners_px: the frame lies outside the photo (%d x %d px): correct the corners",
                           zone->width, zone->height);
    return 0;
}

int zone_make(int width, int height, const struct vec *corners, double corner_radius, struct zone *zone)
{
    *zone = (struct zone){.width = width, .height = height, .x1 = width, .y1 = height};
    if (!corners)
        return 0;
    zone->has_frame = 1;
    zone->corner_radius = corner_radius > 0 ? corner_radius : 0;
    for (int k = 0; k < 4; k++)
        zone->corners[k] = corners[k];
    return make_sides(zone) || make_box(zone) ? -1 : 0;
}

double zone_depth(const struct zone *zone, double x, double y)
{
    if (!zone->has_frame)
        return INFINITY;
    double depth = INFINITY;
    for (int side = 0; side < 4; side++)
        depth = fmin(depth, vec_dot(vec_sub(vec(x, y), zone->corners[side]), zone->inward[side]));
    if (zone->corner_radius > 0)
        for (int k = 0; k < 4; k++)
            depth = fmin(depth, hypot(x - zone->corners[k].x, y - zone->corners[k].y) - zone->corner_radius);
    return depth;
}

double zone_photo_depth(const struct zone *zone, double x, double y)
{
    return fmin(fmin(x, zone->width - 1 - x), fmin(y, zone->height - 1 - y)) + 0.5;
}
