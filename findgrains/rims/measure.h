/* From captured rims to measured ones: approach, blur, circles or ellipses, texture and band, the last fits. */
#ifndef FINDGRAINS_MEASURE_H
#define FINDGRAINS_MEASURE_H

#include "findgrains/find_options.h"
#include "findgrains/rims/refine_all.h"

#define MEASURE_LEAST_SUPPORT 0.25 /* share of a rim that the fine fit needs */
#define MEASURE_WEAK_SUPPORT 0.40  /* less is flagged */

/* Rims that the fine fit cannot measure stay as they were captured when the capture was sure (or by hand, or keep_all),
 * and go otherwise. state: first guesses in, the photo's own numbers out. */
int measure_rims(const struct photo *photo, const struct zone *zone, enum find_shape shape, int keep_all,
                 struct rims_state *state, struct rims *rims);
/* Number of rims that the fine fit measured. */
size_t measure_count(const struct rims *rims);

#endif
