/* What the virtual camera looks at. */
#ifndef SIMULATION_PICTURE_H
#define SIMULATION_PICTURE_H

#include "pipeline/packing/grains.h"
#include "simulation/render/camera.h"

struct drawn_disc {
    double x, y, radius; /* px */
};

/* A rectangle: speckled paper fixed beside the machine, a speckled marker on a wall, or a bright label. */
enum plate_kind { PLATE_PAPER, PLATE_MARKER, PLATE_LABEL };
struct plate {
    enum plate_kind kind;
    char name[NAME_LENGTH];     /* "paper", or the wall's */
    double x, y, width, height; /* px: middle, sides */
    double angle;               /* rad, counter-clockwise as seen */
    double x_ref, y_ref;        /* px: middle in the scene's rectangle */
};

/* What the camera looks at, in px of the photo (x right, y down, pixel middles at integers). */
struct picture {
    int width, height;
    long index;                        /* of the photo in its series: another index, other noise */
    const struct photo_grains *grains; /* x_px y_px radius_px; angle, shape_c, shape_s when there. Row k is always
                                          painted the same way, wherever it goes */
    int framed;                        /* is there a steel frame around the specimen? */
    struct vec corners[4];             /* where its inner lines meet, in the order of enum CORNER_* */
    struct drawn_disc hinges[4];       /* convex discs of the frame */
    int hinge_count;
    const struct plate *plates;
    size_t plate_count;
    struct view view;        /* the camera's motion; zeroed: none */
    const struct lens *lens; /* NULL: none */
};

/* The camera that takes it. */
static inline struct camera picture_camera(const struct picture *picture)
{
    return (struct camera){vec(0.5 * (picture->width - 1), 0.5 * (picture->height - 1)), picture->view, picture->lens};
}

#endif
