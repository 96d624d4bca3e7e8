/* Bins without a contact have no density (NaN) instead of 0: on a logarithmic axis a 0 has no place, and one contact
 * more or less decides about it. */
#include "report/states/distribution.h"

#include <math.h>
#include <string.h>

size_t force_distribution(const struct forces *forces, double density[DISTRIBUTION_BINS])
{
    const double *fn = forces->contact.fn;
    size_t loaded, inside[DISTRIBUTION_BINS] = {0};
    double mean = forces_mean(fn, forces->contact.count, 1, &loaded);
    for (size_t c = 0; c < forces->contact.count; c++) {
        double bin = fn[c] > 0 ? fn[c] / mean / DISTRIBUTION_STEP : DISTRIBUTION_BINS;
        if (bin < DISTRIBUTION_BINS)
            inside[(size_t)bin]++;
    }
    for (int b = 0; b < DISTRIBUTION_BINS; b++)
        density[b] = inside[b] ? (double)inside[b] / ((double)loaded * DISTRIBUTION_STEP) : NAN;
    return loaded;
}

void contact_rose(const struct packing *packing, const struct forces *forces, double share[ROSE_BINS],
                  double mean_fn[ROSE_BINS])
{
    const struct contacts *contacts = &packing->contacts;
    double sum = 0;
    size_t count[ROSE_BINS] = {0}, total = 0, wall;
    for (int b = 0; b < ROSE_BINS && forces; b++)
        mean_fn[b] = 0;
    for (size_t c = 0; c < contacts->count; c++) {
        double angle = atan2(contacts->ny[c], contacts->nx[c]), fn = forces ? forces->contact.fn[c] : 0;
        if ((contacts->flags[c] & CONTACT_CANDIDATE) || packing_is_wall(packing, c, &wall) || !isfinite(angle) ||
            !isfinite(fn))
            continue;
        int bin = (int)floor(angle / (2 * M_PI) * ROSE_BINS + 0.5);
        for (int side = 0; side < 2; side++) {
            int b = ((bin + side * ROSE_BINS / 2) % ROSE_BINS + ROSE_BINS) % ROSE_BINS;
            count[b]++;
            if (forces)
                mean_fn[b] += fn;
        }
        sum += fn;
        total++;
    }
    for (int b = 0; b < ROSE_BINS; b++) {
        share[b] = (double)count[b] / (2.0 * (double)total / ROSE_BINS);
        if (forces)
            mean_fn[b] = count[b] ? mean_fn[b] / (double)count[b] / (sum / (double)total) : NAN;
    }
}
