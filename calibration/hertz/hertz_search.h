/* Grain parameters (E*, nu*) whose packing has the target moduli (E, nu): the iteration of Qu et al., section 5, by
 * Adam, and a Gauss-Newton trust-region method that starts from the Jacobian of the closed forms. Each evaluation is a
 * probe by discrete elements; the search knows only the numbers. */
#ifndef CALIBRATION_HERTZ_SEARCH_H
#define CALIBRATION_HERTZ_SEARCH_H

#include <stddef.h>

struct hertz_trial {
    double grain_young, grain_poisson; /* asked */
    double young, poisson;             /* answered, of the packing */
};

/* Answer `count` trials, together if it can. */
typedef int hertz_evaluate(struct hertz_trial *trials, size_t count, void *user);

enum hertz_method { HERTZ_NEWTON, HERTZ_ADAM };
extern const char *const HERTZ_METHODS[]; /* "newton" "adam" NULL */

struct hertz_goal {
    int dimensions;
    double young, poisson;             /* targets */
    int fit_poisson;                   /* 0: only E, at the start's nu* */
    double grain_young, grain_poisson; /* where to start */
    enum hertz_method method;
    double rate;       /* Adam: learning rate, of the normalised parameters; 0: each step as HERTZ_SHARE says */
    double first_step; /* Adam: eta, the first finite difference */
    int vary_poisson;  /* Adam: nu* is varied also where only E counts (the paper's cases 1 and 3) */
    double cost;       /* stop below this */
    int most_probes;
};
#define HERTZ_RATE 0    /* E* by the way that is left, nu* by HERTZ_RATE_POISSON */
#define HERTZ_SHARE 0.8 /* of the way that E ~ E*^(2/3) asks for */
#define HERTZ_RATE_POISSON 0.1
#define HERTZ_FIRST_STEP 0.03
#define HERTZ_COST 1e-4
#define HERTZ_MOST_PROBES 60
#define HERTZ_MOST_POISSON 0.5

/* lambda_1 (E / E_t - 1)^2 + lambda_2 (nu / nu_t - 1)^2; 1, 0 for E alone, 1/2, 1/2 for both. */
double hertz_cost(const struct hertz_goal *goal, const struct hertz_trial *trial);

struct hertz_found {
    struct hertz_trial best;
    double cost;
    int reached;                      /* cost below the goal's */
    int iterations, probes;           /* probes asked of the evaluation */
    double poisson_low, poisson_high; /* packing's nu seen at the probes */
    int at_bound;                     /* 1: nu* ended at 0 or 0.5 */
};
/* -1 only when an evaluation fails; a target that cannot be reached ends with reached = 0 after a bounded number of
 * probes. */
int hertz_search(const struct hertz_goal *goal, hertz_evaluate *evaluate, void *user, struct hertz_found *found);

#endif
