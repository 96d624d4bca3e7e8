/* Quasi-static method (thesis 2.1.3): the forces are projected in turn onto equilibrium (a linear solve with the
 * stiffness matrix K = A D A', factorised once) and onto the Coulomb cones (contact by contact), from any start.
 * Working stiffness: 1 along normals, kt/kn along tangents. */
#include <stdlib.h>
#include <string.h>

#include "forces/algebra/anderson.h"
#include "forces/algebra/arena.h"
#include "forces/algebra/sparse.h"
#include "forces/methods/coulomb.h"
#include "forces/methods/method.h"
#include "pipeline/speak/error.h"

enum {
    QSM_ITERATIONS = 4000, /* limit, when none is given */
    FAILURES = 20,         /* restarts after which plain projections go on for a while */
    PAUSE = 25,            /* iterations; doubled each time, 64-fold at the most */
};
#define WORSE 10 /* times the best imbalance: acceleration has failed */

/* A component that is held gets next to no stiffness: the others take up what is out of balance. */
#define HELD_STIFFNESS 1e-8

struct qsm {
    const struct network *network;
    const struct force_options *options;
    struct sparse *matrix;
    double *store;     /* all arrays below */
    double *stiffness; /* per component of f */
    double *held;      /* start forces */
    double *unbalance, *motion, *relative;
    double *x, *p, *g; /* statically admissible; its plastic projection, which is judged; the next x */
    double *best;      /* the p of least imbalance so far */
};

static void qsm_free(struct qsm *qsm)
{
    sparse_free(qsm->matrix);
    free(qsm->store);
}

/* Contacts without friction have no tangential stiffness, held components next to none. */
static void fill_stiffness(struct qsm *qsm)
{
    for (size_t c = 0; c < qsm->network->count; c++) {
        double normal = 1, tangential = qsm->network->contact[c].mu > 0 ? qsm->options->law.kt_over_kn : 0;
        if (qsm->options->fix == FIX_NORMAL)
            normal = HELD_STIFFNESS;
        if (qsm->options->fix == FIX_TANGENTIAL)
            tangential = fmin(tangential, HELD_STIFFNESS);
        qsm->stiffness[2 * c] = normal;
        qsm->stiffness[2 * c + 1] = tangential;
    }
}

/* K = A D A' is factorised once: it does not change with the forces. */
static int build_matrix(struct qsm *qsm)
{
    const struct network *network = qsm->network;
    qsm->matrix = network_matrix(network);
    if (!qsm->matrix)
        return -1;
    sparse_clear(qsm->matrix);
    for (size_t c = 0; c < network->count; c++) {
        const double stiffness[3] = {qsm->stiffness[2 * c], 0, qsm->stiffness[2 * c + 1]};
        double block[NETWORK_WIDTH * NETWORK_WIDTH];
        contact_block(&network->contact[c], stiffness, NETWORK_WIDTH, block);
        sparse_add(qsm->matrix, c, block);
    }
    return sparse_factorise(qsm->matrix) < 0 ? -1 : 0;
}

static size_t lay_out(struct qsm *qsm, double *block)
{
    struct arena arena = {.block = block};
    size_t unknowns = 2 * qsm->network->count;
    qsm->stiffness = arena_take(&arena, unknowns), qsm->held = arena_take(&arena, unknowns);
    qsm->relative = arena_take(&arena, unknowns);
    qsm->unbalance = arena_take(&arena, qsm->network->dofs), qsm->motion = arena_take(&arena, qsm->network->dofs);
    qsm->x = arena_take(&arena, unknowns), qsm->p = arena_take(&arena, unknowns);
    qsm->g = arena_take(&arena, unknowns), qsm->best = arena_take(&arena, unknowns);
    return arena.used;
}

static int qsm_begin(const struct network *network, const struct force_options *options, const double *f,
                     struct qsm *qsm)
{
    *qsm = (struct qsm){.network = network, .options = options};
    qsm->store = calloc(lay_out(qsm, NULL) + 1, sizeof(double));
    if (!qsm->store)
        return error_memory("quasi-static method");
    lay_out(qsm, qsm->store);
    memcpy(qsm->held, f, 2 * network->count * sizeof(double));
    fill_stiffness(qsm);
    return build_matrix(qsm);
}

/* Nearest statically admissible forces in the norm of the stiffness (thesis 2.48): K dU = b + A f, then
 * f - D A' dU. `unbalance` holds b + A f. */
static int project_static(struct qsm *qsm, const double *f, double *out)
{
    if (sparse_solve(qsm->matrix, qsm->unbalance, qsm->motion))
        return -1;
    network_motion(qsm->network, qsm->motion, qsm->relative);
    for (size_t k = 0; k < 2 * qsm->network->count; k++)
        out[k] = f[k] - qsm->stiffness[k] * qsm->relative[k];
    return 0;
}

/* The accelerated iteration with a way back: when it has made the imbalance ten times worse than the best, it restarts
 * from the best point without history. After some failures plain projections lead on from there for a while before they
 * are accelerated again. */
static int iterate(struct qsm *qsm, struct anderson *anderson, struct outcome *outcome)
{
    size_t size = 2 * qsm->network->count * sizeof(double);
    int limit = qsm->options->iterations > 0 ? qsm->options->iterations : QSM_ITERATIONS, pause = 0, failures = 0;
    double best = INFINITY;
    for (outcome->iterations = 0;; outcome->iterations++) {
        memcpy(qsm->p, qsm->x, size);
        admit(qsm->network, qsm->options, qsm->held, qsm->p);
        double imbalance = network_judge(qsm->network, qsm->p, qsm->unbalance);
        if (imbalance < best) {
            best = imbalance;
            memcpy(qsm->best, qsm->p, size);
        } else if (anderson->m > 0 && !(imbalance < WORSE * best)) {
            memcpy(qsm->p, qsm->best, size);
            memcpy(qsm->x, qsm->best, size);
            network_judge(qsm->network, qsm->p, qsm->unbalance);
            anderson_restart(anderson);
            if (++failures % FAILURES == 0)
                pause = PAUSE << (failures / FAILURES < 6 ? failures / FAILURES : 6);
        }
        if (best <= qsm->options->tolerance || outcome->iterations >= limit)
            break;
        if (project_static(qsm, qsm->p, qsm->g))
            return -1;
        if (pause > 0 && pause--)
            memcpy(qsm->x, qsm->g, size);
        else
            anderson_step(anderson, qsm->x, qsm->g, qsm->x);
    }
    outcome->imbalance = best;
    outcome->converged = best <= qsm->options->tolerance;
    return 0;
}

/* From the start in f to the best plastic projection, which takes its place. */
static int run(struct qsm *qsm, double *f, struct outcome *outcome)
{
    size_t n = 2 * qsm->network->count;
    struct anderson anderson;
    if (anderson_begin(&anderson, n, qsm->options->anderson))
        return -1;
    network_unbalance(qsm->network, f, qsm->unbalance);
    int status = project_static(qsm, f, qsm->x) || iterate(qsm, &anderson, outcome) ? -1 : 0;
    memcpy(f, qsm->best, n * sizeof *f);
    anderson_free(&anderson);
    return status;
}

static int solve(const struct problem *problem, double *f, struct outcome *outcome)
{
    struct qsm qsm;
    int status = qsm_begin(problem->network, problem->options, f, &qsm) || run(&qsm, f, outcome) ? -1 : 0;
    qsm_free(&qsm);
    return status;
}

const struct method QSM_METHOD = {.name = "qsm",
                                  .says = "projections onto equilibrium and friction",
                                  .needs = NEEDS_STIFFNESS,
                                  .starts = 1,
                                  .balances = 1,
                                  .walks = 1,
                                  .ranges = 1,
                                  .candidates = CANDIDATES_IF_ASKED, /* one contact too many costs next to nothing, it
                                                                        starts without force; but the thesis keeps to
                                                                        the decided ones */
                                  .margin = METHOD_MARGIN,
                                  .doubt = 0.01,
                                  .solve = solve};
