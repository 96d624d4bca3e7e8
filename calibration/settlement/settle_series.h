/* Residual and reversible displacement of tracked grains under cycles: from the state files of a series. */
#ifndef CALIBRATION_SETTLE_SERIES_H
#define CALIBRATION_SETTLE_SERIES_H

#include "calibration/settlement/settlement.h"

/* Positions (m; x0 y0 x1 y1 ...) of one file after another. NaN: not to be trusted in that photo. */
struct settle_series {
    size_t grains, states;
    double *at; /* states x 2 grains */
};
/* contacts, forces or truth files; with a scale (m/px, not NaN) also tracks files. */
int settle_series_read(char *const *paths, size_t count, double scale, struct settle_series *series);
void settle_series_free(struct settle_series *series);

struct grain_settlement {
    double residual[2]; /* m: since the first cycle's beginning */
    struct trend trend[2];
    double ahead[2];   /* m: residual, h cycles after the last photo */
    double reversible; /* m: mean over the cycles of the largest way from the straight line between their ends */
    int used;          /* 0: missing at the end of a cycle */
};

struct settle_estimate {
    struct grain_settlement *grain;
    size_t grains, cycles, unused;
    double held_out;    /* error of the displacement over the last h cycles had they been extrapolated; NaN: too few */
    double chernoff[2]; /* cycles for the wanted error: median and largest over grains and directions */
};
struct settle_wanted {
    enum trend_kind trend;
    size_t per_cycle; /* photos; the first is the beginning of cycle 1 */
    double first;     /* number of the first cycle's beginning, counted from 1 */
    double ahead;     /* h */
    double error, p;  /* m, 1: for the Chernoff bound; NaN: none */
};
int settle_estimate(const struct settle_series *series, const struct settle_wanted *wanted,
                    struct settle_estimate *estimate);
void settle_estimate_free(struct settle_estimate *estimate);

#endif
