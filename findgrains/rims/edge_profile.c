/* Phi(-t) = erfc(t / sqrt 2) / 2, and differences of it: a layer between two depths below the rim, blurred, is the
 * difference of two edges. */
#include "findgrains/rims/edge_profile.h"

#include <math.h>
#include <pthread.h>

struct profile profile_table[2 * PROFILE_REACH * PROFILE_PER_UNIT + 2];

static double below(double t)
{
    return 0.5 * erfc(t * M_SQRT1_2);
}

static void fill_table(void)
{
    for (int k = 0; k < 2 * PROFILE_REACH * PROFILE_PER_UNIT + 2; k++) {
        double t = (double)k / PROFILE_PER_UNIT - PROFILE_REACH;
        double step = below(t), near = below(t + PROFILE_NEAR), deep = below(t + PROFILE_DEEP);
        profile_table[k] = (struct profile){step, 0.3989422804014327 * exp(-0.5 * t * t), step - near, near - deep};
    }
}

void profile_prepare(void)
{
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    pthread_once(&once, fill_table);
}
