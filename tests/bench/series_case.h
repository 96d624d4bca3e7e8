/* Measured series with known truth, for bench_series and the tests of series: states of `simulate`, with the errors of
 * a measurement drawn on top. */
#ifndef BENCH_SERIES_CASE_H
#define BENCH_SERIES_CASE_H

#include "forces/infer_forces.h"
#include "forces/series/series.h"

enum { SERIES_CASE_STATES = 64 };

/* Errors in px, 0.11 px being the overlap of <fn> in state 0; constant in all photos unless said. */
struct series_errors {
    double place, radius, wall; /* standard errors: x and y of each grain; its radius; position of a wall */
    double offset;              /* of every radius: this, or its negative */
    double track, track_deg;    /* of one photo: x and y, rotation */
    double shape;               /* rms of each rim, harmonics 2 to 5, turning with the grain */
    double lost;                /* share of the true contacts that the list lacks */
    double margin;              /* not 0: the list ends at so many standard errors of an overlap, not at 4 */
    double wall_load;           /* relative error of each wall load */
    double body;                /* unknown force on each grain, in <fn>, x and y */
};
#define SERIES_ERRORS_USUAL                                                                                            \
    {                                                                                                                  \
        .place = 0.025, .radius = 0.0175, .wall = 0.025, .offset = 0.3, .track = 0.002, .track_deg = 0.002             \
    }

struct series_case {
    struct packing truth[SERIES_CASE_STATES], measured[SERIES_CASE_STATES];
    size_t count;
    int foreign[SERIES_CASE_STATES]; /* measured from another reference photo */
    double pixel, mean;              /* m; N: <fn> of state 0 */
    double offset;                   /* m: as drawn */
};

/* `states`: "0 10 15" are states of FOLDER/kK-sP, "u3" one of FOLDER/kK-sP-unloaded,
 * "x15" one that was measured from another reference photo: with constant errors of its own. */
int series_case_read(const char *folder, double kappa, int packing, const char *states, struct series_case *series);
/* Fill `measured`. */
int series_case_draw(struct series_case *series, const struct series_errors *errors, uint64_t seed);
void series_case_free(struct series_case *series);

/* Over all true contacts, those that are missing counting 0, averaged over the states; in the state's <fn>. */
struct series_score {
    double fn, ft;     /* rms errors */
    double r_fn, r_ft; /* Pearson */
    double z_fn, z_ft; /* rms of error / stated standard deviation; NaN: none stated */
    double held;       /* share of the true fn in the stated 90 % interval */
};
struct series_score series_case_score_one(const struct series_case *series, size_t state, const struct forces *forces);
struct series_score series_case_score(const struct series_case *series, const struct forces *forces);

#endif
