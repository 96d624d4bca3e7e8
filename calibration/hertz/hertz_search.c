/* Two searches over (E*, nu*).
 *
 * Newton: unknowns (ln E*, nu*), answers (ln E, nu). The first Jacobian is that of the closed forms; then Broyden's
 * update J += (dy - J dx) dx' / |dx|^2. The step in nu* is limited by a trust that is halved whenever the cost grows.
 * Adam (the paper): gradients by finite differences along the last step, first and second moments m, g with the decay
 * 0.9 and 0.999, bias taken out by 1 - decay^t, step = -rate m / (g^1/2 + tiny). */
#include "calibration/hertz/hertz_search.h"

#include <math.h>
#include <string.h>

#include "calibration/hertz/hertz.h"
#include "pipeline/command/cli.h"
#include "pipeline/speak/progress.h"

const char *const HERTZ_METHODS[] = {"newton", "adam", NULL};

struct search {
    const struct hertz_goal *goal;
    hertz_evaluate *evaluate;
    void *user;
    struct hertz_found *found;
    struct progress progress;
};

double hertz_cost(const struct hertz_goal *goal, const struct hertz_trial *trial)
{
    double e = trial->young / goal->young - 1, n = goal->fit_poisson ? trial->poisson / goal->poisson - 1 : 0;
    return goal->fit_poisson ? 0.5 * (e * e + n * n) : e * e;
}

/* Ask, and remember the best. */
static int ask(struct search *search, struct hertz_trial *trials, size_t count)
{
    struct hertz_found *found = search->found;
    if (search->evaluate(trials, count, search->user))
        return -1;
    for (size_t k = 0; k < count; k++) {
        double cost = hertz_cost(search->goal, &trials[k]);
        found->probes++;
        progress_step(&search->progress);
        found->poisson_low = fmin(found->poisson_low, trials[k].poisson);
        found->poisson_high = fmax(found->poisson_high, trials[k].poisson);
        if (cost < found->cost) {
            found->cost = cost;
            found->best = trials[k];
        }
    }
    found->reached = found->cost < search->goal->cost;
    return 0;
}

/* ---- Adam (Kingma and Ba 2014) on e = E* / E*_0 and v = nu* / nu*_0 ---- */

struct adam {
    double at[2], step[2];
    double m[2], g[2];
};

static struct hertz_trial trial_at(const struct hertz_goal *goal, double e, double v)
{
    double poisson = fmin(fmax(goal->grain_poisson * v, 0), HERTZ_MOST_POISSON);
    return (struct hertz_trial){.grain_young = goal->grain_young * e, .grain_poisson = poisson};
}

/* Adam's steps are as long as its rate whatever the misfit: without a given one, E* goes a share of the way that the
 * power law of Hertz's contacts leaves from here. */
static double adam_rate(const struct hertz_goal *goal, int freedom, double at, double young)
{
    if (goal->rate > 0)
        return goal->rate;
    return freedom ? HERTZ_RATE_POISSON : HERTZ_SHARE * fabs(at * (pow(goal->young / young, 1.5) - 1));
}

static int adam_iteration(struct search *search, struct adam *adam, int t)
{
    const double b1 = 0.9, b2 = 0.999, tiny = 1e-8;
    const struct hertz_goal *goal = search->goal;
    int freedoms = goal->fit_poisson || goal->vary_poisson ? 2 : 1;
    struct hertz_trial trials[3];
    trials[0] = trial_at(goal, adam->at[0], adam->at[1]);
    trials[1] = trial_at(goal, adam->at[0] + adam->step[0], adam->at[1]);
    trials[2] = trial_at(goal, adam->at[0], adam->at[1] + adam->step[1]);
    if (ask(search, trials, (size_t)freedoms + 1))
        return -1;
    double cost = hertz_cost(goal, &trials[0]);
    for (int f = 0; f < freedoms; f++) {
        double moved = f ? (trials[2].grain_poisson - trials[0].grain_poisson) / goal->grain_poisson : adam->step[0];
        double slope = moved != 0 ? (hertz_cost(goal, &trials[f + 1]) - cost) / moved : 0;
        adam->m[f] = b1 * adam->m[f] + (1 - b1) * slope;
        adam->g[f] = b2 * adam->g[f] + (1 - b2) * slope * slope;
        double m = adam->m[f] / (1 - pow(b1, t)), g = adam->g[f] / (1 - pow(b2, t));
        adam->step[f] = -adam_rate(goal, f, adam->at[f], trials[0].young) * m / (sqrt(g) + tiny);
        adam->at[f] += adam->step[f];
    }
    adam->at[1] = fmin(fmax(adam->at[1], 0), HERTZ_MOST_POISSON / goal->grain_poisson);
    return 0;
}

static int search_adam(struct search *search)
{
    const struct hertz_goal *goal = search->goal;
    struct adam adam = {.at = {1, 1}, .step = {goal->first_step, goal->first_step}};
    int each = goal->fit_poisson || goal->vary_poisson ? 3 : 2;
    while (!search->found->reached && search->found->probes + each <= goal->most_probes) {
        if (adam_iteration(search, &adam, ++search->found->iterations))
            return -1;
        log_event("adam", "iteration", (double)search->found->iterations, "cost", search->found->cost, "probes",
                  (double)search->found->probes, NULL);
    }
    search->found->at_bound = adam.at[1] <= 0 || adam.at[1] * goal->grain_poisson >= HERTZ_MOST_POISSON;
    return 0;
}

/* ---- Gauss-Newton with Broyden's updates on (ln E*, nu*) for (ln E, nu) ---- */

/* The closed forms at fixed pressure and fabric: E goes with E*^(2/3); in nu* by differences of the formulas. */
static void closed_jacobian(const struct hertz_goal *goal, double nu, double j[2][2])
{
    struct hertz_packing packing = {goal->dimensions, 1, 1, 1};
    double h = 1e-4, young[2], poisson[2];
    nu = fmin(nu, HERTZ_MOST_POISSON - h);
    for (int k = 0; k < 2; k++) {
        double kn, ks, grain = nu + k * h;
        hertz_stiffness(1, 1 / (2 * (1 + grain)), grain, hertz_mean_force(&packing), &kn, &ks);
        hertz_moduli(&packing, kn, ks, &young[k], &poisson[k]);
    }
    j[0][0] = 2.0 / 3, j[1][0] = 0;
    j[0][1] = log(young[1] / young[0]) / h;
    j[1][1] = (poisson[1] - poisson[0]) / h;
}

static void rest_of(const struct hertz_goal *goal, const struct hertz_trial *trial, double rest[2])
{
    rest[0] = log(goal->young / trial->young);
    rest[1] = goal->fit_poisson ? goal->poisson - trial->poisson : 0;
}

/* Step that the Jacobian asks for, nu* kept in its range, no longer than the trust allows. */
static void newton_step(const struct hertz_goal *goal, double j[2][2], const double rest[2], double nu, double trust,
                        double step[2])
{
    step[1] = goal->fit_poisson && j[1][1] != 0
                  ? (rest[1] - j[1][0] / j[0][0] * rest[0]) / (j[1][1] - j[1][0] / j[0][0] * j[0][1])
                  : 0;
    step[1] = fmin(fmax(step[1], fmax(-trust, -nu)), fmin(trust, HERTZ_MOST_POISSON - nu));
    step[0] = (rest[0] - j[0][1] * step[1]) / j[0][0];
    step[0] = fmin(fmax(step[0], -2), 2);
}

/* Broyden's rank-one change: the Jacobian agrees with the last step. Only E where only E counts. */
static void broyden(double j[2][2], const double step[2], const double change[2], int both)
{
    double length = step[0] * step[0] + step[1] * step[1];
    for (int r = 0; r < 1 + both; r++) {
        double miss = change[r] - j[r][0] * step[0] - j[r][1] * step[1];
        for (int c = 0; c < 1 + both; c++)
            j[r][c] += miss * step[c] / length;
    }
}

static int search_newton(struct search *search)
{
    const struct hertz_goal *goal = search->goal;
    struct hertz_trial here = {.grain_young = goal->grain_young, .grain_poisson = goal->grain_poisson};
    double j[2][2], rest[2], step[2], trust = 0.25;
    closed_jacobian(goal, here.grain_poisson, j);
    if (ask(search, &here, 1))
        return -1;
    while (!search->found->reached && search->found->probes < goal->most_probes) {
        rest_of(goal, &here, rest);
        newton_step(goal, j, rest, here.grain_poisson, trust, step);
        if (hypot(step[0], step[1]) < 1e-6)
            break; /* at the bound of nu*, E met */
        struct hertz_trial next = {.grain_young = here.grain_young * exp(step[0]),
                                   .grain_poisson = fmin(fmax(here.grain_poisson + step[1], 0), HERTZ_MOST_POISSON)};
        if (ask(search, &next, 1))
            return -1;
        double change[2] = {log(next.young / here.young), next.poisson - here.poisson};
        broyden(j, step, change, goal->fit_poisson);
        j[0][0] = fmin(fmax(j[0][0], 0.3), 1.2); /* noise of a small step may not turn E's answer around */
        if (hertz_cost(goal, &next) < hertz_cost(goal, &here))
            here = next;
        else
            trust *= 0.5;
        search->found->iterations++;
        log_event("newton", "iteration", (double)search->found->iterations, "cost", search->found->cost, "probes",
                  (double)search->found->probes, NULL);
        if (trust < 1e-3)
            break;
    }
    double nu = search->found->best.grain_poisson;
    search->found->at_bound = goal->fit_poisson && (nu <= 1e-9 || nu >= HERTZ_MOST_POISSON - 1e-9);
    return 0;
}

int hertz_search(const struct hertz_goal *goal, hertz_evaluate *evaluate, void *user, struct hertz_found *found)
{
    struct search search = {.goal = goal, .evaluate = evaluate, .user = user, .found = found};
    memset(found, 0, sizeof *found);
    found->cost = found->poisson_low = INFINITY;
    found->poisson_high = -INFINITY;
    progress_begin(&search.progress, "probes (at most)", (size_t)goal->most_probes);
    int status = goal->method == HERTZ_ADAM ? search_adam(&search) : search_newton(&search);
    progress_end(&search.progress);
    return status;
}
