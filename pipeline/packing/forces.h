/* Contact forces of one method, one row per contact of the packing; and what they leave unbalanced on each grain.
 * The force on j from i is fn n + ft t. */
#ifndef PIPELINE_FORCES_H
#define PIPELINE_FORCES_H

#include "pipeline/laws/contact_law.h"
#include "pipeline/state/columns.h"

struct contact_forces {
    size_t count;
    double *fn, *ft;          /* N; fn >= 0 in compression */
    double *s_fn, *s_ft;      /* N: standard deviations */
    double *fn_min, *fn_max;  /* N: stated 90 % interval */
    double *fn_low, *fn_high; /* N: exact range over all admissible states */
    uint32_t *status;         /* enum contact_status */
};
extern const struct table_kind CONTACT_FORCES;

struct residuals {
    size_t count;
    double *residual_x, *residual_y; /* N: unbalanced force on each grain */
    double *residual_m;              /* N m */
};
extern const struct table_kind RESIDUALS;

/* Motion of each grain that proves that no admissible forces balance the loads (docs/forces.md). */
struct rays {
    size_t count;
    double *ray_x, *ray_y; /* 1 */
    double *ray_m;         /* 1: rotation times the mean radius */
};
extern const struct table_kind RAYS;

/* The motion that meets the least resistance (docs/forces.md); its squares sum to 1 with those of the walls. */
struct softest {
    size_t count;
    double *soft_x, *soft_y; /* 1 */
    double *soft_m;          /* 1: rotation times the mean radius */
};
extern const struct table_kind SOFTEST;

/* What a random walk over admissible forces has seen, means over the contacts, of fn and of ft (thesis 3.8, 3.9). */
struct walk_summary {
    double states;      /* 0: no walk */
    double variance[2]; /* over <fn>^2 */
    double range[2];    /* over <fn> */
};

/* What the forces are worth (packing/verdict.h); the attribute is the word in VERDICT_NAMES. */
enum verdict { VERDICT_UNKNOWN, VERDICT_BALANCED, VERDICT_DOUBTFUL, VERDICT_VOID };
extern const char *const VERDICT_NAMES[]; /* "" "balanced" "doubtful" "void", NULL at the end */

/* One group /forces/METHOD. */
struct forces {
    char method[NAME_LENGTH]; /* "cem" "qsm" "cdm" "map" "series"; truth: "dem" */
    char start[NAME_LENGTH];  /* how it was started */
    struct contact_forces contact;
    struct residuals residual;
    struct rays ray; /* empty unless infeasible */
    int iterations;
    int converged;    /* imbalance <= tolerance, and the loads themselves balance (packing/verdict.h) */
    double tolerance; /* of the imbalance, by which this method is judged; NaN: not said */
    int solved;       /* the method's own iteration ended by its own criterion: 1 yes, -1 no, 0 not said */
    enum verdict verdict;
    char reasons[1000];    /* why, in words; "" when balanced */
    int infeasible;        /* proved: no admissible forces balance the loads */
    double imbalance;      /* attribute `residual`: largest unbalanced component (moments over radius) / <fn> */
    double imbalance_mean; /* attribute `residual_mean`: that of each grain, in the mean */
    double violation;      /* attribute `cone_violation`: largest |ft| - mu fn or -fn over <fn>; only with that */
    double stress[2][2];   /* Pa (or N/m without a length): Weber stress, compression positive */
    double kn, kt;         /* N/m, as used; NaN when not used */
    double mu;
    double misfit[2];   /* N: what the loads on all four walls leave over, x and y; NaN: a wall bears no load */
    double data_misfit; /* series: squared errors of this photo's data over their variances, per datum; 0: not said */
    struct walk_summary walk; /* attributes walk_states, walk_variance, walk_range (fn, ft) */
    /* Smallest eigenvalue of K over kn: every contact that carries sticks; those that slip do. Only with `softest`. */
    double stability[2];
    struct softest softest; /* of the second; empty unless asked */
};

/* <fn>: the mean normal force over the contacts that carry, those with fn > 0 (NaN and open contacts are left out);
 * the unit of forces in every stage and picture. fn[c * apart] is that of contact c (apart 2: fn and ft in turn).
 * *loaded, unless NULL: how many carry. NaN when none does. */
double forces_mean(const double *fn, size_t count, size_t apart, size_t *loaded);

void forces_free(struct forces *forces); /* accepts a zeroed struct */

#endif
