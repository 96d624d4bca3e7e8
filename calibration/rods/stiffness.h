/* Stiffness of one contact from a compression test on two rods (thesis 4.1.1.1): force against deflection, split into
 * loading, unloading and reloading, each fitted by a line, two lines and a power law. */
#ifndef CALIBRATION_STIFFNESS_H
#define CALIBRATION_STIFFNESS_H

#include <stddef.h>
#include <stdint.h>

struct press_point {
    int64_t index;     /* of the photo */
    double time;       /* s; NaN: the record goes by index */
    double force;      /* N; NaN: outside the record */
    double deflection; /* m: how much nearer the middles are than in the reference */
    double s;          /* m: standard error of the deflection; 0: not known */
    int used;          /* 0: lost by the tracker, or outside the force record */
};

enum press_kind { PRESS_LOADING, PRESS_UNLOADING, PRESS_RELOADING };
extern const char *const PRESS_KINDS[];

/* The deflection x is fitted as a function of the force F, where the noise is.
 *   line:     x = x0 + F / k
 *   bilinear: x = x0 + min(F, B) / k_low + max(F - B, 0) / k_high; B by search, errors from the linearised problem
 *   power:    F = c (x - x0)^n; n by search
 * Errors are scaled up by sqrt(chi2 / freedom) where the points scatter more than they say. */
struct press_fit {
    enum press_kind kind;
    size_t begin, end, points;                /* of the table; points used */
    double force[2];                          /* N: smallest and largest */
    double k_line, s_line;                    /* N/m */
    double k_low, s_low;                      /* N/m; NaN: no break */
    double k_high, s_high;                    /* N/m; without a break that of the line */
    double break_force, s_break;              /* N; NaN: two lines are no better than one (see PRESS_BREAK) */
    double power_n, s_n;                      /* 1 */
    double power_c;                           /* N/m^n */
    double rms_line, rms_bilinear, rms_power; /* m */
};
#define PRESS_BREAK 16.0 /* fall of chi2 that two more parameters must bring: by chance 3 times in 10000 */
enum { PRESS_LEAST = 4, PRESS_MOST_PHASES = 64 };

struct stiffness {
    struct press_fit *phase;
    size_t phase_count;
    double kn, s_kn; /* N/m: mean of the k_high of first loading and reloading (the thesis's k_n) */
    double spread;   /* N/m: half the difference between the stiffest and the softest of them; 0: only one */
    double unloading, s_unloading; /* N/m: mean slope of the unloading branches; NaN: none */
};
void stiffness_free(struct stiffness *stiffness);

struct press_options {
    double force_error; /* N: standard error of the force sensor */
    double turn;        /* share of the largest force by which it must come back to begin a new phase */
};
#define PRESS_DEFAULT                                                                                                  \
    {                                                                                                                  \
        .force_error = 0, .turn = 0.05                                                                                 \
    }

/* Points in the order of time. Phases of fewer than PRESS_LEAST points are left out. Errors (EXIT_INPUT): too few
 * points, a stiffness that is not positive. */
int stiffness_fit(const struct press_point *points, size_t count, const struct press_options *options,
                  struct stiffness *stiffness);

#endif
