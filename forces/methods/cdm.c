/* Contact dynamics (thesis 2.1.2; Moreau 1988, Jean 1999): nonlinear Gauss-Seidel over the contacts, each one stopped
 * by Signorini's and Coulomb's laws while the velocities of its bodies are kept up to date:
 *
 *     v = M^-1 (A f + b),   u = A' v,   fn >= 0, un >= 0, fn un = 0;   |ft| <= mu fn, ft against ut where it slides.
 *
 * The time step is 1, the bodies start at rest
 * (so restitution has no part in it), and a static state is one whose velocities vanish. */
#include "forces/methods/cdm.h"

#include <stdlib.h>
#include <string.h>

#include "forces/algebra/anderson.h"
#include "forces/methods/cdm_order.h"
#include "forces/methods/coulomb.h"
#include "forces/methods/method.h"
#include "pipeline/speak/error.h"

enum { CDM_W = 5 /* Wnn, Wnt, Wtt, 1 / Wnn, 1 / Wtt */ };
enum {
    CDM_WORSE = 10,      /* times what the block before left: acceleration begins anew */
    CDM_SWEEPS = 20000,  /* limit, when none is given */
    CDM_LOOK = 20,       /* sweeps between two looks at the imbalance */
    CDM_PATIENCE = 4000, /* sweeps without a better imbalance */
};

/* Stick: u = 0 solves 2 x 2 equations for the change of (fn, ft). Where that leaves the cone the contact slips: un = 0
 * with ft = +-mu fn, on the side where stick would have put it; where it pulls, the contact opens. */
void cdm_contact(const double w[3], double mu, double un, double ut, double relaxation, double *fn, double *ft)
{
    double determinant = w[0] * w[2] - w[1] * w[1], old_n = *fn, old_t = *ft;
    double n, t;
    if (mu > 0 && determinant > 0) {
        n = old_n - relaxation * (w[2] * un - w[1] * ut) / determinant;
        t = old_t - relaxation * (w[0] * ut - w[1] * un) / determinant;
    } else {
        n = w[0] > 0 ? old_n + (w[1] * old_t - relaxation * un) / w[0] : old_n;
        t = 0;
    }
    if (fabs(t) > mu * n && w[1] != 0 && w[0] > 0) { /* slip: the normal condition alone, ft on the cone */
        double side = t > 0 ? mu : -mu, stiff = w[0] + side * w[1];
        n = stiff > 0 ? (w[0] * old_n + w[1] * old_t - relaxation * un) / stiff : 0;
    }
    *fn = fmax(0, n);
    *ft = fmax(-mu * *fn, fmin(mu * *fn, t));
}

/* The inverse mass matrix of each contact (thesis 2.14), from the equations themselves. */
static void fill_w(const struct network *network, double (*w)[CDM_W])
{
    for (size_t c = 0; c < network->count; c++) {
        const struct network_contact *contact = &network->contact[c];
        w[c][0] = w[c][1] = w[c][2] = 0;
        for (int e = 0; e < NETWORK_WIDTH && contact->dof[e] >= 0; e++) {
            double inverse = network->inverse_mass[contact->dof[e]];
            w[c][0] += contact->n[e] * contact->n[e] * inverse;
            w[c][1] += contact->n[e] * contact->t[e] * inverse;
            w[c][2] += contact->t[e] * contact->t[e] * inverse;
        }
        if (fabs(w[c][1]) < 1e-12 * (w[c][0] + w[c][2]))
            w[c][1] = 0; /* discs: exactly diagonal (thesis 2.19) */
        w[c][3] = w[c][0] > 0 ? 1 / w[c][0] : 0;
        w[c][4] = w[c][2] > 0 ? 1 / w[c][2] : 0;
    }
}

/* Does the contact break its laws by more than the graph thickness (thesis 2.27, 2.28)? */
static int needs_correction(const struct network_contact *contact, const double *f, double un, double ut, double eps)
{
    if (un < -eps || (un > eps && f[0] > 0))
        return 1;
    if (f[0] <= 0 || contact->mu <= 0)
        return 0;
    int sliding = fabs(f[1]) >= contact->mu * f[0] && ut * f[1] < 0;
    return fabs(ut) > eps && !sliding;
}

/* cdm_contact() for a diagonal W, with its inverse at hand: a division costs as much as the rest of a contact. */
static void diagonal_contact(const double inverse[2], double mu, double un, double ut, double relaxation, double *fn,
                             double *ft)
{
    double n = *fn - relaxation * un * inverse[0], t = mu > 0 ? *ft - relaxation * ut * inverse[1] : 0;
    *fn = n > 0 ? n : 0;
    double most = mu * *fn;
    *ft = t > most ? most : t < -most ? -most : t;
}

struct cdm {
    const struct network *network;
    const struct force_options *options;
    struct cdm_order order;
    double (*w)[CDM_W];           /* per contact */
    double *f, *held, *unbalance; /* unbalance: resultant on each degree of freedom */
};

/* Returns whether anything changed. */
static inline size_t correct(const struct cdm *cdm, size_t c)
{
    const struct network *network = cdm->network;
    const struct network_contact *contact = &network->contact[c];
    const struct force_options *options = cdm->options;
    const double *w = cdm->w[c];
    double *f = cdm->f, un = 0, ut = 0, fn = f[2 * c], ft = f[2 * c + 1];
    for (int e = 0; e < NETWORK_WIDTH && contact->dof[e] >= 0; e++) {
        double v = cdm->unbalance[contact->dof[e]] * network->inverse_mass[contact->dof[e]];
        un += contact->n[e] * v;
        ut += contact->t[e] * v;
    }
    if (!needs_correction(contact, &f[2 * c], un, ut, options->thickness))
        return 0;
    if (w[1] == 0)
        diagonal_contact(w + 3, contact->mu, un, ut, options->relaxation, &fn, &ft);
    else
        cdm_contact(w, contact->mu, un, ut, options->relaxation, &fn, &ft);
    if (options->fix == FIX_NORMAL) {
        fn = cdm->held[2 * c];
        ft = fmax(-contact->mu * fn, fmin(contact->mu * fn, ft));
    } else if (options->fix == FIX_TANGENTIAL) {
        ft = cdm->held[2 * c + 1];
        fn = fmax(fn, contact->mu > 0 ? fabs(ft) / contact->mu : 0);
    }
    double dn = fn - f[2 * c], dt = ft - f[2 * c + 1];
    if (dn == 0 && dt == 0)
        return 0;
    contact_push(contact, dn, dt, cdm->unbalance);
    f[2 * c] = fn;
    f[2 * c + 1] = ft;
    return 1;
}

/* One sweep over all contacts; returns how many were corrected. Contacts of one colour share nothing, so that the
 * result does not depend on who visits them when. */
static size_t sweep(const struct cdm *cdm)
{
    const struct cdm_order *order = &cdm->order;
    size_t corrected = 0;
    if (order->colours > 0) {
#pragma omp parallel reduction(+ : corrected)
        for (int colour = 0; colour < order->colours; colour++) {
#pragma omp for schedule(static)
            for (size_t k = order->start[colour]; k < order->start[colour + 1]; k++)
                corrected += correct(cdm, (size_t)order->contact[k]);
        }
    }
    for (size_t k = order->start[order->colours]; k < order->start[order->colours + 1]; k++)
        corrected += correct(cdm, (size_t)order->contact[k]);
    return corrected;
}

/* The best forces so far: near a limit state the iteration can pass by equilibrium and drift off to forces under which
 * the packing moves, which also obey both laws. */
struct best {
    double *f, imbalance;
    int sweep; /* when it was found */
};

/* The imbalance; the resultants are recomputed, so that rounding does not add up. */
static double look(const struct cdm *cdm, int sweep_number, struct best *best)
{
    double imbalance = network_judge(cdm->network, cdm->f, cdm->unbalance);
    if (imbalance < best->imbalance) {
        best->imbalance = imbalance;
        best->sweep = sweep_number;
        memcpy(best->f, cdm->f, 2 * cdm->network->count * sizeof *cdm->f);
    }
    return imbalance;
}

/* Anderson's acceleration of a block of sweeps, which has just led from x to the forces of this imbalance. When that
 * is `CDM_WORSE` times what the block before left, sweeps lead on without it and without history. */
static void accelerate(const struct cdm *cdm, struct anderson *anderson, double imbalance, double before, double *x)
{
    size_t size = 2 * cdm->network->count * sizeof *x;
    if (imbalance > CDM_WORSE * before) {
        anderson_restart(anderson);
    } else {
        anderson_step(anderson, x, cdm->f, cdm->f);
        admit(cdm->network, cdm->options, cdm->held, cdm->f);
    }
    network_unbalance(cdm->network, cdm->f, cdm->unbalance);
    memcpy(x, cdm->f, size);
}

/* Sweeps until the imbalance is below the tolerance, two sweeps in a row corrected nothing (thesis 2.33), it has not
 * improved for CDM_PATIENCE sweeps, or the limit is reached. */
static void iterate(const struct cdm *cdm, struct anderson *anderson, double *x, struct best *best,
                    struct outcome *outcome)
{
    const struct force_options *options = cdm->options;
    int limit = options->iterations > 0 ? options->iterations : CDM_SWEEPS, quiet = 0, done = 0;
    int block = options->block > 0 ? options->block : CDM_LOOK;
    double before = INFINITY;
    look(cdm, 0, best);
    while (done < limit && quiet < 2 && best->imbalance > options->tolerance && done - best->sweep < CDM_PATIENCE) {
        quiet = sweep(cdm) == 0 ? quiet + 1 : 0;
        if (++done % block != 0)
            continue;
        double imbalance = look(cdm, done, best);
        if (options->block > 0 && best->imbalance > options->tolerance)
            accelerate(cdm, anderson, imbalance, before, x);
        before = imbalance;
    }
    look(cdm, done, best);
    memcpy(cdm->f, best->f, 2 * cdm->network->count * sizeof *cdm->f);
    outcome->iterations = done;
    outcome->imbalance = best->imbalance;
    outcome->converged = best->imbalance <= options->tolerance;
}

/* The start is brought into the cones first: what is held is held there. */
static int begin(struct cdm *cdm)
{
    const struct network *network = cdm->network;
    size_t size = 2 * network->count * sizeof(double);
    cdm->w = malloc((network->count + 1) * sizeof *cdm->w);
    cdm->unbalance = malloc((network->dofs + 1) * sizeof(double));
    cdm->held = malloc(size + sizeof(double));
    if (!cdm->w || !cdm->unbalance || !cdm->held)
        return error_memory("contact dynamics");
    memcpy(cdm->held, cdm->f, size);
    admit(network, cdm->options, cdm->held, cdm->f);
    memcpy(cdm->held, cdm->f, size);
    fill_w(network, cdm->w);
    return cdm_order_build(network, cdm->options->colours, &cdm->order);
}

static int solve(const struct problem *problem, double *f, struct outcome *outcome)
{
    const struct network *network = problem->network;
    const struct force_options *options = problem->options;
    struct cdm cdm = {.network = network, .options = options, .f = f};
    struct anderson anderson = {0};
    size_t unknowns = 2 * network->count;
    struct best best = {malloc((unknowns + 1) * sizeof *best.f), INFINITY, 0};
    double *x = malloc((unknowns + 1) * sizeof *x);
    int status = best.f && x ? begin(&cdm) : error_memory("contact dynamics");
    if (!status)
        status = anderson_begin(&anderson, options->block > 0 ? unknowns : 0, options->anderson);
    if (!status) {
        memcpy(x, f, unknowns * sizeof *x);
        iterate(&cdm, &anderson, x, &best, outcome);
    }
    anderson_free(&anderson);
    cdm_order_free(&cdm.order);
    free(cdm.w), free(cdm.unbalance), free(cdm.held), free(best.f), free(x);
    return status;
}

const struct method CDM_METHOD = {.name = "cdm",
                                  .says =
                                      "contact dynamics, rigid grains (forces.block 10 in the scene accelerates it, "
                                      "forces.colours uses all threads)",
                                  .starts = 1,
                                  .balances = 1,
                                  .walks = 1,
                                  .ranges = 1,
                                  .margin = METHOD_MARGIN,
                                  .doubt = 0.01,
                                  .solve = solve};
