/* Minimisation of an energy of the grains' positions by limited-memory BFGS: H, the inverse of the second derivative,
 * is built from the last MEMORY steps s and changes of the gradient y with rho = 1 / (s' y), starting from s' y / y' y
 * (Nocedal 1980; Nocedal and Wright, Numerical Optimization, algorithm 7.4). Steps are halved until Armijo's condition
 * holds; pairs with too little curvature are not remembered, so that H stays positive. */
#include "calibration/settlement/unpress.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"

enum { MEMORY = 8 }; /* pairs (s, y) */

struct work {
    struct dem *dem;
    size_t n; /* 2 per grain */
    int *free_grain;
    double *from;                                /* carry: where the grains were put; NULL: part */
    double tether;                               /* N/m: carry: spring to that place */
    double *x, *g, *trial, *trial_g, *direction; /* n each */
    double *s[MEMORY], *y[MEMORY];
    double rho[MEMORY];
    int kept, newest;
    double overlap, contact_force; /* largest of the last evaluation */
    double *block;
};

static double dot(const double *a, const double *b, size_t n)
{
    double sum = 0;
    for (size_t k = 0; k < n; k++)
        sum += a[k] * b[k];
    return sum;
}

/* Overlap and normal (from i outwards) of a pair at the grains' places. */
static double pair_overlap(const struct dem *dem, const struct dem_pair *pair, double *nx, double *ny)
{
    const struct dem_grain *g = &dem->grains[pair->i];
    if ((size_t)pair->j >= dem->count && (size_t)pair->j < dem->count + SIDES) {
        const struct dem_side *side = &dem->box.side[(size_t)pair->j - dem->count];
        *nx = -side->inward.x, *ny = -side->inward.y;
        return g->radius - vec_dot(vec_sub(vec(g->x, g->y), side->point), side->inward);
    }
    double x, y, radius;
    if ((size_t)pair->j >= dem->count) {
        struct vec at = dem_corner_at(&dem->box, (int)((size_t)pair->j - dem->count - SIDES));
        x = at.x, y = at.y, radius = dem->box.corner_radius;
    } else {
        const struct dem_grain *h = &dem->grains[pair->j];
        x = h->x, y = h->y, radius = h->radius;
    }
    double dx = x - g->x, dy = y - g->y, distance = hypot(dx, dy);
    *nx = distance > 0 ? dx / distance : 1, *ny = distance > 0 ? dy / distance : 0;
    return g->radius + radius - distance;
}

/* Energy and force of a pair that overlaps (part), or that was in contact and keeps its overlap (carry). */
static double pair_energy(const struct work *work, size_t p, double overlap, double *force)
{
    const struct dem_pair *pair = &work->dem->pairs[p];
    *force = 0;
    if (work->from && pair->touching) {
        double change = overlap - pair->overlap;
        *force = pair->spring.stiffness * change;
        return 0.5 * *force * change;
    }
    if (!(overlap > 0))
        return 0;
    const struct contact_law *law = &work->dem->law;
    const struct contact_pair *law_of_pair = dem_pair_law(work->dem, p);
    *force = contact_pair_force(law, law_of_pair, overlap);
    return contact_pair_work(law, law_of_pair, overlap, *force);
}

/* Loads (part), or springs to where the grains were put (carry). */
static double grain_energy(const struct work *work, size_t k, double *gradient)
{
    const struct dem_grain *g = &work->dem->grains[k];
    double *to = gradient + 2 * k;
    if (!work->from) {
        to[0] = -(g->load_x + g->mass * work->dem->gravity.x);
        to[1] = -(g->load_y + g->mass * work->dem->gravity.y);
        return to[0] * g->x + to[1] * g->y;
    }
    double dx = g->x - work->from[2 * k], dy = g->y - work->from[2 * k + 1];
    to[0] = work->tether * dx, to[1] = work->tether * dy;
    return 0.5 * work->tether * (dx * dx + dy * dy);
}

/* Phi and its gradient at x. */
static int evaluate(struct work *work, const double *x, double *gradient, double *energy)
{
    struct dem *dem = work->dem;
    double sum = 0;
    for (size_t k = 0; k < dem->count; k++)
        dem->grains[k].x = x[2 * k], dem->grains[k].y = x[2 * k + 1];
    if (dem_find_pairs(dem) < 0)
        return -1;
    work->overlap = work->contact_force = 0;
    for (size_t k = 0; k < dem->count; k++)
        sum += grain_energy(work, k, gradient);
    for (size_t p = 0; p < dem->pair_count; p++) {
        const struct dem_pair *pair = &dem->pairs[p];
        double nx, ny, force, overlap = pair_overlap(dem, pair, &nx, &ny);
        sum += pair_energy(work, p, overlap, &force);
        gradient[2 * pair->i] += force * nx, gradient[2 * pair->i + 1] += force * ny;
        if ((size_t)pair->j < dem->count)
            gradient[2 * pair->j] -= force * nx, gradient[2 * pair->j + 1] -= force * ny;
        work->overlap = fmax(work->overlap, overlap);
        work->contact_force = fmax(work->contact_force, fabs(force));
    }
    for (size_t k = 0; k < dem->count; k++)
        if (!work->free_grain[k])
            gradient[2 * k] = gradient[2 * k + 1] = 0;
    *energy = sum;
    return 0;
}

/* Largest component. */
static double largest(const double *g, size_t n)
{
    double most = 0;
    for (size_t k = 0; k < n; k++)
        most = fmax(most, fabs(g[k]));
    return most;
}

/* direction = -H g by the two loops of Nocedal; downhill in any case. */
static void find_direction(struct work *work)
{
    double alpha[MEMORY], *d = work->direction;
    for (size_t k = 0; k < work->n; k++)
        d[k] = -work->g[k];
    for (int m = 0; m < work->kept; m++) {
        int k = (work->newest - m + MEMORY) % MEMORY;
        alpha[m] = work->rho[k] * dot(work->s[k], d, work->n);
        for (size_t v = 0; v < work->n; v++)
            d[v] -= alpha[m] * work->y[k][v];
    }
    double scale = 1 / fmax(work->dem->stiffest, 1e-300);
    if (work->kept) {
        int k = work->newest;
        scale = 1 / (work->rho[k] * dot(work->y[k], work->y[k], work->n));
    }
    for (size_t v = 0; v < work->n; v++)
        d[v] *= scale;
    for (int m = work->kept - 1; m >= 0; m--) {
        int k = (work->newest - m + MEMORY) % MEMORY;
        double beta = work->rho[k] * dot(work->y[k], d, work->n);
        for (size_t v = 0; v < work->n; v++)
            d[v] += (alpha[m] - beta) * work->s[k][v];
    }
}

/* The last step as a pair (s, y). */
static void remember(struct work *work)
{
    int k = work->kept ? (work->newest + 1) % MEMORY : 0;
    for (size_t v = 0; v < work->n; v++) {
        work->s[k][v] = work->trial[v] - work->x[v];
        work->y[k][v] = work->trial_g[v] - work->g[v];
    }
    double curvature = dot(work->s[k], work->y[k], work->n);
    if (!(curvature > 1e-12 * dot(work->y[k], work->y[k], work->n) / fmax(work->dem->stiffest, 1e-300)))
        return; /* not convex here: the pair would spoil the metric */
    work->rho[k] = 1 / curvature;
    work->newest = k;
    work->kept = work->kept < MEMORY ? work->kept + 1 : MEMORY;
}

/* Back until Phi falls enough (Armijo); no grain goes farther than `most`. 1: went down; 0: cannot; -1: failed. */
static int go_down(struct work *work, double most, double *energy)
{
    double slope = dot(work->g, work->direction, work->n), step = fmin(1, most / largest(work->direction, work->n));
    if (!(slope < 0))
        return 0;
    for (int halving = 0; halving < 50; halving++, step *= 0.5) {
        double trial;
        for (size_t v = 0; v < work->n; v++)
            work->trial[v] = work->x[v] + step * work->direction[v];
        if (evaluate(work, work->trial, work->trial_g, &trial))
            return -1;
        if (trial <= *energy + 1e-4 * step * slope && trial < *energy) {
            remember(work);
            memcpy(work->x, work->trial, work->n * sizeof *work->x);
            memcpy(work->g, work->trial_g, work->n * sizeof *work->g);
            *energy = trial;
            return 1;
        }
    }
    return 0;
}

/* Down from where the grains stand until the largest unbalanced component is small beside the largest contact force.
 * Where no step goes down, once more along the gradient itself; then it is done. */
static int minimise(struct work *work, double most, double *history, size_t room, struct unpress *result)
{
    double energy;
    if (evaluate(work, work->x, work->g, &energy))
        return -1;
    result->overlap[0] = result->overlap[1] = work->overlap;
    result->energy[0] = energy;
    result->force[0] = largest(work->g, work->n);
    for (result->iterations = 0; result->iterations < UNPRESS_ITERATIONS; result->iterations++) {
        if (history && (size_t)result->iterations < room)
            history[result->iterations] = energy;
        result->done = largest(work->g, work->n) <= UNPRESS_TOLERANCE * work->contact_force;
        if (result->done)
            break;
        find_direction(work);
        int went = go_down(work, most, &energy);
        if (went < 0)
            return -1;
        if (!went && !work->kept)
            break;
        if (!went)
            work->kept = 0; /* once more, straight down */
    }
    double again;
    if (evaluate(work, work->x, work->g, &again))
        return -1;
    result->overlap[1] = work->overlap;
    result->energy[1] = energy;
    result->force[1] = largest(work->g, work->n);
    return 0;
}

/* Grains that touch a wall, and fixed ones, stay. */
static void choose_free(struct work *work)
{
    const struct dem *dem = work->dem;
    for (size_t k = 0; k < dem->count; k++)
        work->free_grain[k] = !dem->grains[k].fixed;
    for (size_t p = dem->first[dem->count]; p < dem->pair_count; p++) {
        double nx, ny;
        if (pair_overlap(dem, &dem->pairs[p], &nx, &ny) > 0)
            work->free_grain[dem->pairs[p].i] = 0;
    }
}

static int work_alloc(struct work *work)
{
    const struct dem *dem = work->dem;
    work->n = 2 * dem->count;
    work->block = calloc((6 + 2 * MEMORY) * work->n + 1, sizeof *work->block);
    work->free_grain = calloc(dem->count + 1, sizeof *work->free_grain);
    if (!work->block || !work->free_grain)
        return error_memory("moving of grains");
    double **vectors[] = {&work->x, &work->g, &work->trial, &work->trial_g, &work->direction};
    for (size_t v = 0; v < 5; v++)
        *vectors[v] = work->block + v * work->n;
    for (size_t m = 0; m < MEMORY; m++) {
        work->s[m] = work->block + (5 + 2 * m) * work->n;
        work->y[m] = work->block + (6 + 2 * m) * work->n;
    }
    for (size_t k = 0; k < dem->count; k++)
        work->x[2 * k] = dem->grains[k].x, work->x[2 * k + 1] = dem->grains[k].y;
    return 0;
}

static void work_free(struct work *work)
{
    free(work->block);
    free(work->free_grain);
}

/* No grain moves farther than this in one iteration. */
static double longest_way(const struct dem *dem)
{
    double most = INFINITY;
    for (size_t k = 0; k < dem->count; k++)
        most = fmin(most, 0.1 * dem->grains[k].radius);
    return most;
}

int unpress(struct dem *dem, double *history, size_t room, struct unpress *result)
{
    struct work work = {.dem = dem};
    memset(result, 0, sizeof *result);
    int status = work_alloc(&work);
    if (!status)
        status = dem_forces_static(dem, 0); /* pairs, and the stiffest contact */
    if (!status) {
        choose_free(&work);
        status = minimise(&work, longest_way(dem), history, room, result);
    }
    if (!status)
        status = dem_forces_static(dem, 0);
    work_free(&work);
    return status;
}

int carry_contacts(struct dem *dem, struct unpress *result)
{
    const double tether = 1e-3; /* of the contacts' stiffness: decides only what overlaps leave open */
    struct work work = {.dem = dem, .tether = tether * dem->stiffest};
    memset(result, 0, sizeof *result);
    int status = work_alloc(&work);
    if (!status) {
        work.from = work.block + (5 + 2 * MEMORY) * work.n;
        memcpy(work.from, work.x, work.n * sizeof *work.x);
        for (size_t k = 0; k < dem->count; k++)
            work.free_grain[k] = !dem->grains[k].fixed;
        dem_place_walls(dem);
        status = minimise(&work, longest_way(dem), NULL, 0, result);
    }
    if (!status)
        status = dem_forces_static(dem, 0);
    work_free(&work);
    return status;
}
