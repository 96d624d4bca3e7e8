/* Where the rim really runs, from the pixels of an annulus around where it is thought to run. The annulus is cut into
 * short sectors; each has its own grey levels on both sides:
 *
 *     I = B + A Phi(-rho / s) + a phi(rho / s) / s [+ A_j Phi(-rho_j / s)] [+ b rho phi(rho / s) / s^2]
 *
 * rho: distance outside the rim, s: blur of the photo (point spread and pixel), Phi, phi: normal distribution. a / A is
 * the shift of the rim outwards, b / A the error of s; the term in rho_j is the neighbour's edge. The half level of
 * a blurred disc lies at R - s^2 / (2 R): blurring is diffusion over a "time" s^2 / 2, under which a level line of
 * curvature 1 / R moves inwards at speed 1 / R. rho is measured from there. */
#ifndef FINDGRAINS_EDGE_FIT_H
#define FINDGRAINS_EDGE_FIT_H

#include <stddef.h>

#include "pipeline/photo.h"
#include "findgrains/rim.h"
#include "findgrains/zone.h"

struct edge_settings {
    double blur;       /* s, px */
    double window;     /* half width of the annulus, px */
    double sector;     /* length of a sector along the rim, px */
    int fit_blur;      /* also fit b */
    double least_step; /* grey levels: sectors with a smaller A have no edge */
    double
        void_level; /* prior of B, with a standard deviation of void_spread: decides only where a sector sees no void */
    double void_spread;
    double damping; /* share of a step that is taken: a blur assumed too large makes steps too long */
    double noise;   /* grey levels, of a pixel: the weight of the prior against the pixels */
};

struct sector {
    double theta;    /* of its middle, clockwise as seen */
    double shift;    /* px, outwards */
    double variance; /* px2, of the shift, from this sector's own residual */
    double step;     /* A */
    double blur_error;
    double residual; /* grey levels squared: variance of the residual */
    int used;        /* 0: no edge, or hidden by a neighbour, the border or the frame */
    int hidden;      /* not used because something else is there */
};

/* Work space for one thread. */
struct edge_work {
    struct sector *sectors;
    double *sums;
    int count, room;
};
void edge_work_free(struct edge_work *work);

/* Fill work->sectors for the rim; `others` are the rims near it. */
int edge_fit(const struct photo *photo, const struct zone *zone, const struct rim *rim, const struct rim *others,
             size_t other_count, const struct edge_settings *settings, struct edge_work *work);

/* r(theta) of a rim. */
double rim_radius_at(const struct rim *rim, double cos_theta, double sin_theta);

#endif
