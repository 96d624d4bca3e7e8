/* Grains as they cross a stage boundary. Row k is grain k in every table and file, for ever; rows are never dropped.
 * Photo side (findgrains, tracker): px, x right, y down, pixel centres at integers, angles counter-clockwise as seen.
 * SI side (contacts on): m, x right, y up, angles counter-clockwise. */
#ifndef PIPELINE_GRAINS_H
#define PIPELINE_GRAINS_H

#include "pipeline/state/columns.h"

/* Bits 0-15: do not trust this row. Bits 16-31: information. Names in the file: GRAIN_FLAG_NAMES. */
enum grain_flag {
    GRAIN_CUT = 1u << 0,            /* cut by the border of the photo or of the specimen zone */
    GRAIN_WEAK_EDGE = 1u << 1,      /* too little of the rim supports the circle */
    GRAIN_NOT_CONVERGED = 1u << 2,  /* an iteration reached its limit */
    GRAIN_LOW_ZNCC = 1u << 3,       /* the photo does not look like the reference here */
    GRAIN_LOST = 1u << 4,           /* not found in this photo: its motion is NaN */
    GRAIN_AMBIGUOUS = 1u << 5,      /* a second place fits as well, or neighbours disagree */
    GRAIN_OUT_OF_VIEW = 1u << 6,    /* (partly) outside the photo */
    GRAIN_SATURATED = 1u << 7,      /* too many pixels at the end of the grey range */
    GRAIN_NO_CONTRAST = 1u << 8,    /* no texture to follow, or no edge to fit */
    GRAIN_NOT_FINITE = 1u << 9,     /* an input number of this row was missing */
    GRAIN_OVERLAPPING = 1u << 10,   /* its circle overlaps another one more than grains can */
    GRAIN_OUTSIDE_RANGE = 1u << 11, /* its radius lies outside the range that the scene gives */
    GRAIN_FIXED = 1u << 16,         /* held in place: its reaction is a result */
    GRAIN_RATTLER = 1u << 18,       /* carries nothing (iterative peeling) */
    GRAIN_FLOATING = 1u << 19,      /* loaded, but too few contacts to hold it: a contact was missed */
    GRAIN_RESCUED = 1u << 20,       /* found by the wider search */
    GRAIN_MASKED = 1u << 21,        /* part of its subset was left out (a neighbour, saturation, the border) */
    GRAIN_FLANK = 1u << 22,         /* a second edge on one side: the flank of the rod is visible */
    GRAIN_BY_HAND = 1u << 23,       /* added by the user's list */
    GRAIN_VAGUE = 1u << 25,         /* errors of 0.5 px or 0.5 degrees are within four standard errors */
    GRAIN_SPECKLED_FINE = 1u << 24  /* fine speckle: refined with the quintic spline */
};
#define GRAIN_DISTRUST 0xFFFFu

extern const char *const GRAIN_FLAG_NAMES[32];

/* /grains of findgrains and tracker, and of N.photo-truth.hdf. */
struct photo_grains {
    size_t count;
    double *x_px, *y_px, *radius_px;     /* px; findgrains: as seen; tracker: lens and drift undone */
    double *angle;                       /* rad; tracker: rotation since the reference */
    double *s_x, *s_y, *s_radius;        /* px, standard errors; tracker: s_x s_y of the motion since the reference */
    double *s_angle;                     /* rad */
    double *shape_c, *shape_s, *s_shape; /* px; rim r(phi) = radius + c cos 2(phi - angle) + s sin 2(phi - angle) */
    double *zncc, *iterations;           /* 1 */
    double *x_seen_px, *y_seen_px, *angle_seen;      /* tracker: this photo as it is */
    double *x_ref_px, *y_ref_px, *s_x_ref, *s_y_ref; /* tracker: corrected reference position, its own errors */
    double *dx_px, *dy_px, *dangle;                  /* tracker: motion since the previous photo */
    uint32_t *flags;
};
extern const struct table_kind PHOTO_GRAINS;

/* /grains of contacts on, and of truth. */
struct grains {
    size_t count;
    double *x, *y, *radius;               /* m */
    double *angle;                        /* rad since the reference */
    double *s_x, *s_y;                    /* m, of the motion in this photo alone */
    double *s_angle;                      /* rad, of this photo alone */
    double *s_x_ref, *s_y_ref, *s_radius; /* m, constant through the series */
    double *shape_c, *shape_s, *s_shape;  /* m */
    double *mass, *inertia;               /* kg, kg m2; without a density: proportional to R2, R4/2 */
    double *load_x, *load_y, *load_m;     /* N, N, N m: force from outside on the grain, gravity included */
    uint32_t *flags;
};
extern const struct table_kind GRAINS;

#endif
