/* Projections onto the Coulomb cone fn >= 0, |ft| <= mu fn. The vertical one keeps fn, as sliding does in Coulomb's law
 * (thesis 2.1.3); the orthogonal one finds the nearest point, which would be associated flow: sliding that opens. */
#include "forces/methods/coulomb.h"

#include <math.h>

static void vertical(double mu, double *fn, double *ft)
{
    if (!(*fn > 0)) {
        *fn = *ft = 0;
        return;
    }
    *ft = fmax(-mu * *fn, fmin(mu * *fn, *ft));
}

/* On the edge (1, mu) / sqrt(1 + mu^2) nearest to f; where f lies beyond the corner, the corner. */
static void orthogonal(double mu, double *fn, double *ft)
{
    if (*fn >= 0 && fabs(*ft) <= mu * *fn)
        return;
    double along = (*fn + mu * fabs(*ft)) / (1 + mu * mu);
    if (!(along > 0)) {
        *fn = *ft = 0;
        return;
    }
    *ft = copysign(mu * along, *ft);
    *fn = along;
}

void admit(const struct network *network, const struct force_options *options, const double *held, double *f)
{
    for (size_t c = 0; c < network->count; c++) {
        double mu = network->contact[c].mu, *fn = &f[2 * c], *ft = &f[2 * c + 1];
        if (options->fix == FIX_NORMAL && held) {
            *fn = fmax(0, held[2 * c]);
            vertical(mu, fn, ft);
        } else if (options->fix == FIX_TANGENTIAL && held) {
            *ft = mu > 0 ? held[2 * c + 1] : 0;
            *fn = fmax(*fn, mu > 0 ? fabs(*ft) / mu : 0);
        } else if (options->orthogonal) {
            orthogonal(mu, fn, ft);
        } else {
            vertical(mu, fn, ft);
        }
    }
}
