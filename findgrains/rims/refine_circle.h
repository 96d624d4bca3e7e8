/* Circle or ellipse through the shifts of a rim's sectors, by robust least squares, with honest standard errors. */
#ifndef FINDGRAINS_REFINE_CIRCLE_H
#define FINDGRAINS_REFINE_CIRCLE_H

#include "findgrains/rims/edge_fit.h"

struct refined {
    struct rim rim;
    double s_x, s_y, s_radius, s_shape; /* px, for sectors that err independently of each other */
    double support;                     /* share of the rim that the fit used and found near the curve */
    double hidden;                      /* share hidden by neighbours, frame or border */
    double scatter;                     /* px: robust standard deviation of the sectors about the curve */
    double formal;                      /* px: what the grey noise of the sectors alone would give */
    double noise;                       /* grey levels, median over the sectors */
    double blur_error;                  /* px, median over the sectors; NaN unless fitted */
    double lag[8], lag_count[8];        /* sums of products of neighbouring sectors' standardised influences */
    double moved;                       /* px, in the last iteration */
    int sectors;                        /* used */
};

/* One iteration from refined->rim: edges, then the curve, and a step of settings->damping times the shift. Everything
 * else in *refined is replaced. settings->fit_blur: the rim stays, blur_error tells. `others`: rims near it; `work`: a
 * thread's own. 0, with refined->support == 0 when no curve is determined; -1 when memory is gone. */
int refine_circle(const struct photo *photo, const struct zone *zone, const struct rim *others, size_t other_count,
                  const struct edge_settings *settings, int ellipse, struct edge_work *work, struct refined *refined);

#endif
