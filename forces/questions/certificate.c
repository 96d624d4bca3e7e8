/* The admissible forces with the least squares of what they leave unbalanced, r = A f + b, satisfy A' r in the dual
 * cones and f . A' r = 0, so that b . r = |r|^2: where r is not zero it is the ray of Farkas's lemma. They are found
 * with the interior point of map: an unknown load of variance 1 on every degree of freedom, hardly any belief about f.
 */
#include "forces/questions/certificate.h"

#include <stdlib.h>
#include <string.h>

#include "forces/methods/map.h"
#include "pipeline/speak/error.h"

#define FORCE_VARIANCE 1e8  /* <fn>^2 */
#define MOST_FORCE 1e3      /* <fn> */
#define CERTIFICATE_W 1e-12 /* weight of the barrier */
#define TOLERANCE 1e-8      /* <fn>: far below what decides */

static int least_squares(const struct network *network, const struct force_options *options, double *y)
{
    struct force_options plain = *options;
    struct evidence evidence = {0};
    struct map map = {0};
    int iterations = 0;
    int status = evidence_blank(network, &evidence);
    plain.tolerance = TOLERANCE;
    if (!status)
        status = map_begin(network, &plain, &evidence, &map);
    if (!status) {
        for (size_t c = 0; c < network->count; c++) {
            map.weight[c] = CERTIFICATE_W;
            map.variance[2 * c] = map.variance[2 * c + 1] = FORCE_VARIANCE;
        }
        for (size_t d = 0; d < network->dofs; d++)
            map.soft[d] = 1;
        map.feasible = 1;
        status = map_interior(&map, &iterations) < 0 ? -1 : 0;
        network_unbalance(network, map.forces, y);
    }
    map_free(&map);
    evidence_free(&evidence);
    return status;
}

/* y may miss the dual cones by rounding: then it only bounds the sum of fn, from below, which is a proof all the same
 * when the bound is beyond what the loads allow. */
int certificate_find(const struct network *network, const struct force_options *options, double *y, double *least_sum)
{
    double *u = malloc((2 * network->count + 1) * sizeof *u), gain = 0, violation = 0;
    int status = u ? least_squares(network, options, y) : error_memory("certificate");
    if (!status)
        network_motion(network, y, u);
    for (size_t d = 0; !status && d < network->dofs; d++)
        gain += network->load[d] * y[d];
    for (size_t c = 0; !status && c < network->count; c++)
        violation = fmax(violation, network->contact[c].mu * fabs(u[2 * c + 1]) - u[2 * c]);
    *least_sum = !(gain > 0) ? 0 : violation > 0 ? gain / violation : INFINITY;
    free(u);
    return status;
}

int certificate_holds(const struct network *network, double least_sum)
{
    double shortest = INFINITY;
    for (size_t c = 0; c < network->count; c++)
        shortest = fmin(shortest, network->contact[c].length);
    double most =
        isfinite(network->virial) && shortest > 0 ? network->virial / shortest : MOST_FORCE * (double)network->count;
    return least_sum > most;
}
