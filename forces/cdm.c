/* Contact dynamics (thesis 2.1.2): nonlinear Gauss-Seidel over the contacts, each one stopped by Signorini's and
 * Coulomb's laws while the velocities of its bodies are kept up to date. The time step is 1, the bodies start at rest
 * (so restitution has no part in it), and a static state is one whose velocities vanish. */
#include "forces/method.h"

#include <stdlib.h>
#include <string.h>

#include "pipeline/error.h"

enum { CDM_W = 5 /* Wnn, Wnt, Wtt, 1 / Wnn, 1 / Wtt */ };
enum { CDM_SWEEPS = 20000, CDM_LOOK = 20 /* sweeps between two looks at the imbalance */, CDM_PATIENCE = 4000 };

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

/* One sweep over all contacts; returns how many were corrected. unbalance: resultant on each degree of freedom. */
static size_t sweep(const struct network *network, const struct force_options *options, const double (*w)[CDM_W],
                    const double *held, double *f, double *unbalance)
{
    size_t corrected = 0;
    for (size_t c = 0; c < network->count; c++) {
        const struct network_contact *contact = &network->contact[c];
        double un = 0, ut = 0, fn = f[2 * c], ft = f[2 * c + 1];
        for (int e = 0; e < NETWORK_WIDTH && contact->dof[e] >= 0; e++) {
            double v = unbalance[contact->dof[e]] * network->inverse_mass[contact->dof[e]];
            un += contact->n[e] * v;
            ut += contact->t[e] * v;
        }
        if (!needs_correction(contact, &f[2 * c], un, ut, options->thickness))
            continue;
        if (w[c][1] == 0)
            diagonal_contact(w[c] + 3, contact->mu, un, ut, options->relaxation, &fn, &ft);
        else
            cdm_contact(w[c], contact->mu, un, ut, options->relaxation, &fn, &ft);
        if (options->fix == FIX_NORMAL) {
            fn = held[2 * c];
            ft = fmax(-contact->mu * fn, fmin(contact->mu * fn, ft));
        } else if (options->fix == FIX_TANGENTIAL) {
            ft = held[2 * c + 1];
            fn = fmax(fn, contact->mu > 0 ? fabs(ft) / contact->mu : 0);
        }
        double dn = fn - f[2 * c], dt = ft - f[2 * c + 1];
        if (dn == 0 && dt == 0)
            continue;
        corrected++;
        for (int e = 0; e < NETWORK_WIDTH && contact->dof[e] >= 0; e++)
            unbalance[contact->dof[e]] += contact->n[e] * dn + contact->t[e] * dt;
        f[2 * c] = fn;
        f[2 * c + 1] = ft;
    }
    return corrected;
}

/* The best forces so far: near a limit state the iteration can pass by equilibrium and drift off to forces under which
 * the packing moves, which also obey both laws. */
struct best {
    double *f, imbalance;
    int sweep; /* when it was found */
};

static void look(const struct network *network, const double *f, double *unbalance, int sweep_number, struct best *best)
{
    double imbalance = network_judge(network, f, unbalance);
    if (imbalance >= best->imbalance)
        return;
    best->imbalance = imbalance;
    best->sweep = sweep_number;
    memcpy(best->f, f, 2 * network->count * sizeof *f);
}

/* Sweeps until the imbalance is below the tolerance, two sweeps in a row corrected nothing (thesis 2.33), it has not
 * improved for CDM_PATIENCE sweeps, or the limit is reached. The resultants are recomputed at every look, so that
 * rounding does not add up. */
static void iterate(const struct network *network, const struct force_options *options, const double (*w)[CDM_W],
                    const double *held, double *f, double *unbalance, struct best *best, struct outcome *outcome)
{
    int limit = options->iterations > 0 ? options->iterations : CDM_SWEEPS, quiet = 0, done = 0;
    look(network, f, unbalance, 0, best);
    while (done < limit && quiet < 2 && best->imbalance > options->tolerance && done - best->sweep < CDM_PATIENCE) {
        quiet = sweep(network, options, w, held, f, unbalance) == 0 ? quiet + 1 : 0;
        if (++done % CDM_LOOK == 0)
            look(network, f, unbalance, done, best);
    }
    look(network, f, unbalance, done, best);
    memcpy(f, best->f, 2 * network->count * sizeof *f);
    outcome->iterations = done;
    outcome->imbalance = best->imbalance;
    outcome->converged = best->imbalance <= options->tolerance;
}

int cdm_solve(const struct network *network, const struct force_options *options, double *f, struct outcome *outcome)
{
    double(*w)[CDM_W] = malloc((network->count + 1) * sizeof *w);
    double *unbalance = malloc((network->dofs + 1) * sizeof *unbalance);
    double *held = malloc((2 * network->count + 1) * sizeof *held);
    struct best best = {malloc((2 * network->count + 1) * sizeof *best.f), INFINITY, 0};
    int status = 0;
    if (!w || !unbalance || !held || !best.f) {
        status = error_memory("contact dynamics");
    } else {
        memcpy(held, f, 2 * network->count * sizeof *held);
        admit(network, options, held, f);
        memcpy(held, f, 2 * network->count * sizeof *held);
        fill_w(network, w);
        iterate(network, options, (const double(*)[CDM_W])w, held, f, unbalance, &best, outcome);
    }
    free(w), free(unbalance), free(held), free(best.f);
    return status;
}
