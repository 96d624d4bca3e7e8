/* What findgrains is told beside the photo, and what it learns on the way. px of the photo, x right, y down. */
#ifndef FINDGRAINS_FIND_OPTIONS_H
#define FINDGRAINS_FIND_OPTIONS_H

#include <math.h>

#include "findgrains/corrections.h"
#include "findgrains/look/find_frame.h"
#include "findgrains/look/threshold.h"
#include "findgrains/look/zone.h"

enum find_shape { FIND_SHAPE_AUTO, FIND_SHAPE_CIRCLE, FIND_SHAPE_ELLIPSE };

/* FIND_OPTIONS_DEFAULT: everything from the photo, no frame, no corrections. */
struct find_options {
    double radius_min_px, radius_max_px; /* NaN: estimated */
    int has_frame;
    struct vec corners_px[4]; /* top-left, top-right, bottom-right, bottom-left */
    double frame_bend_px;     /* how far the lens bends the frame's sides away from the lines between these corners */
    double corner_radius_px;  /* 0: no discs at the corners */
    const struct corrections *corrections; /* by hand; NULL: none */
    enum find_shape shape;                 /* auto: ellipses when the rims of this photo ask for them */
};
#define FIND_OPTIONS_DEFAULT                                                                                           \
    {                                                                                                                  \
        .radius_min_px = NAN, .radius_max_px = NAN                                                                     \
    }

/* What the photo told on the way. */
struct find_notes {
    struct zone zone;
    struct grey_levels levels;
    double radius_min_px, radius_max_px; /* that were looked for */
    double blur_px;                      /* Gaussian: point spread and pixel together */
    double noise;                        /* grey levels: median residual at the rims, texture included */
    double texture;                      /* of the grains at the rims, in units of the noise */
    double window_px;                    /* half width of the fitted band */
    double correlation;                  /* factor on standard errors: neighbouring sectors err alike */
    int ellipses;                        /* were fitted */
    struct found_frame frame;            /* when none was given */
    size_t candidates, captured;
};

#endif
