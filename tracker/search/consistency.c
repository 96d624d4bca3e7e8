/* A wrong place with a fair correlation is told from a right one by what the other grains say: it leaves more noise
 * than matches of this photo usually do (all grains are seen by one camera), lies where another grain is (rods are
 * hard: nothing overlaps by 15 % of a radius), or is a radius away from where its neighbours went (docs/tracker.md). */
#include "tracker/search/consistency.h"

#include <math.h>
#include <stdlib.h>

#include "pipeline/numbers/quantiles.h"
#include "pipeline/speak/error.h"

static const double usual_noise = 3;     /* times the median */
static const double beyond_doubt = 0.95; /* ZNCC: no wrong place reaches it, whatever the noise says */
static const double deep = 0.15;         /* overlap over the smaller radius that grains cannot have */
enum { FEWEST = 8 };                     /* grains that make a usual noise */

int consistency_demote(struct outcome *outcomes, size_t count)
{
    double *noise = malloc((count + 1) * sizeof *noise);
    size_t good = 0;
    if (!noise)
        return error_memory("the noise of the grains");
    for (size_t k = 0; k < count; k++)
        if (outcomes[k].found == 2)
            noise[good++] = outcomes[k].fit.noise;
    if (good >= FEWEST) {
        double limit = usual_noise * select_rank(noise, good, good / 2);
        for (size_t k = 0; k < count; k++)
            if (outcomes[k].found == 2 && outcomes[k].fit.zncc < beyond_doubt && outcomes[k].fit.noise > limit)
                outcomes[k].found = 1;
    }
    free(noise);
    return 0;
}

static int sits_on_another(const struct target *targets, const double *radius, const struct outcome *outcomes,
                           size_t count, size_t k)
{
    double x = targets[k].shape.cx + outcomes[k].fit.motion.u, y = targets[k].shape.cy + outcomes[k].fit.motion.v;
    for (size_t m = 0; m < count; m++) {
        if (m == k || outcomes[m].found < 2)
            continue;
        double dx = targets[m].shape.cx + outcomes[m].fit.motion.u - x;
        double dy = targets[m].shape.cy + outcomes[m].fit.motion.v - y;
        double before = hypot(targets[m].shape.cx - targets[k].shape.cx, targets[m].shape.cy - targets[k].shape.cy);
        double limit = fmin(radius[k] + radius[m], before) - deep * fmin(radius[k], radius[m]);
        if (hypot(dx, dy) < limit)
            return 1;
    }
    return 0;
}

static int left_its_neighbours(const long *nearest, const double *radius, const struct outcome *outcomes, size_t k)
{
    struct motion usual;
    if (neighbours_motion(nearest + k * NEIGHBOURS, outcomes, &usual) < 3)
        return 0;
    return hypot(outcomes[k].fit.motion.u - usual.u, outcomes[k].fit.motion.v - usual.v) > radius[k];
}

void consistency_check(const struct target *targets, const double *grain_radius, const long *nearest,
                       struct outcome *outcomes, size_t count)
{
    for (size_t k = 0; k < count; k++)
        if (outcomes[k].found && outcomes[k].searched)
            outcomes[k].contradicted = sits_on_another(targets, grain_radius, outcomes, count, k) ||
                                       left_its_neighbours(nearest, grain_radius, outcomes, k);
}
