/* Circles (or ellipses) around the grains of one photo, at the noise limit, with standard errors. Nothing needs to be
 * tuned by hand: grey levels, blur, noise, the width of the fitted band and the radius range come from the photo. */
#ifndef FINDGRAINS_FIND_GRAINS_H
#define FINDGRAINS_FIND_GRAINS_H

#include "pipeline/packing/grains.h"
#include "findgrains/corrections.h"
#include "findgrains/look/find_frame.h"
#include "pipeline/scene/photo.h"
#include "findgrains/look/threshold.h"
#include "findgrains/look/zone.h"

enum find_shape { FIND_SHAPE_AUTO, FIND_SHAPE_CIRCLE, FIND_SHAPE_ELLIPSE };

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

/* Fills the empty table `grains`, from top to bottom. An error (EXIT_INPUT) when there is no grain. notes: NULL is
 * fine. */
int find_grains(const struct photo *photo, const struct find_options *options, struct photo_grains *grains,
                struct find_notes *notes);
/* Measure known grains again, on a later photo: rows keep their numbers; one that cannot be measured keeps its place,
 * flagged. From `known`: x_seen_px y_seen_px where there, else x_px y_px; radius_px. */
int find_known_grains(const struct photo *photo, const struct find_options *options, const struct photo_grains *known,
                      struct photo_grains *grains, struct find_notes *notes);
/* Rows that are not to be trusted. */
size_t find_count_flagged(const struct photo_grains *grains);

#endif
