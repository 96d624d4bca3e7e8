/* Where the rim really runs, from the pixels of an annulus around where it is thought to run. The annulus is cut into
 * short sectors; each has its own grey levels:
 *
 *     I = B + A Phi(-t) + a phi(t) / s + T_1 P_1(t) + T_2 P_2(t) [+ A_j Phi(-t_j)] [+ b t phi(t) / s]
 *
 * t = rho / s; rho: distance outside the rim; s: blur of the photo (point spread and pixel); Phi, phi: normal
 * distribution. a over the step at the rim is the shift of the rim outwards, b over it the error of s; the term in
 * t_j is the neighbours' edge. T_1 and T_2 let the grain's level differ just below the rim and a little deeper
 * (P_1 + P_2 + ... = Phi): specks and rings make it do so. They are random effects: a prior of mean 0 and the photo's
 * texture as standard deviation keeps them small where the pixels do not ask for them. B has a wide prior at the
 * void's level, for sectors that see no void.
 *
 * The half level of a blurred disc lies at R - s^2 / (2 R): blurring is diffusion over a time s^2 / 2, in which a level
 * line of curvature 1 / R moves inwards at speed 1 / R. rho is measured from there. */
#ifndef FINDGRAINS_EDGE_FIT_H
#define FINDGRAINS_EDGE_FIT_H

#include <stddef.h>

#include "pipeline/scene/photo.h"
#include "findgrains/capture/rim.h"
#include "findgrains/look/zone.h"

struct edge_settings {
    double blur;                    /* s, px */
    double window;                  /* half width of the annulus, px */
    double sector;                  /* length of a sector along the rim, px */
    int fit_blur;                   /* also fit b */
    double least_step;              /* grey levels: sectors with a smaller step have no edge */
    double noise;                   /* grey levels, of a pixel: its weight against the priors */
    double void_level, void_spread; /* grey levels: prior of B */
    double texture;                 /* prior of T_1 and T_2 in units of the noise; 0: there is no texture */
    double damping;                 /* share of a step that is taken: a blur assumed too large makes steps too long */
    double tukey;                   /* where the biweight reaches zero, in standard deviations */
};

struct sector {
    double theta;    /* of its middle, from x towards y */
    double shift;    /* px, outwards */
    double variance; /* px2 per grey level squared: times the variance of a pixel gives that of the shift */
    double step;     /* at the rim, grey levels */
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

/* Fill work->sectors (work->count of them, from theta = -pi on) for the rim, which is possible; `others` are the rims
 * near it, whose edges may reach into its annulus. A sector that cannot be fitted is not `used`. 0, or -1 when memory
 * is gone. `work` is a thread's own, zeroed before its first use. */
int edge_fit(const struct photo *photo, const struct zone *zone, const struct rim *rim, const struct rim *others,
             size_t other_count, const struct edge_settings *settings, struct edge_work *work);

#endif
