/* K = constitutive + geometric. A contact that carries (fn, ft), with relative motion (un, ut), gives
 *
 *     kn un un + kt ut ut                            its springs; kt = 0 where it slips
 *     -fn / d vt vt + ft / d vn vt                   the force turns with its normal, by vt / d
 *     ft / 2 r vn                                    the lever arms grow by vn / 2 when the grains part
 *
 * vn, vt: relative motion of the centres along n and t; d: their distance (a straight wall does not turn: no second
 * line); r: the sum of the rotations. Second-order work sees the symmetric part only. Units: mean kn of these contacts,
 * the network's radius. */
#include "forces/questions/buckling.h"

#include <stdlib.h>
#include <string.h>

#include "forces/network/elastic.h"
#include "forces/algebra/lanczos.h"
#include "forces/network/network.h"
#include "forces/algebra/sparse.h"
#include "pipeline/speak/error.h"

#define DEFECT 1e-9 /* of |K x - value x|, in the units of K */
#define LEAST_SHIFT 1e-9
#define CARRIES 1e-4 /* <fn>: 1e-6 to 1e-3 move the figure by 7 % at most (docs/forces_measured.md) */

enum { W = NETWORK_WIDTH };

struct stiffness {
    const struct packing *packing;
    const struct network *network;
    const struct force_options *options;
    const struct contact_forces *forces;
    struct sparse *matrix;
    double (*block)[W * W]; /* one per contact */
    double *diagonal;       /* of motions that meet no stiffness and are left out: 1 */
    unsigned char *turns;   /* per degree of freedom: a rotation */
    double unit;            /* N/m */
};

/* ---- which contacts carry ---- */

/* The packing with the contacts that carry nothing marked as candidates, so that a network leaves them out and peels
 * what hung on them. Caller frees the flags. */
static int carrying(const struct packing *packing, const struct contact_forces *forces, struct packing *out)
{
    size_t count = packing->contacts.count;
    double mean = forces_mean(forces->fn, count, 1, NULL), least = isnan(mean) ? 0 : CARRIES * mean;
    *out = *packing;
    out->contacts.flags = calloc(count + 1, sizeof *out->contacts.flags);
    if (!out->contacts.flags)
        return error_memory("stability");
    for (size_t c = 0; c < count; c++) {
        uint32_t flags = packing->contacts.flags ? packing->contacts.flags[c] & ~(uint32_t)CONTACT_CANDIDATE : 0;
        int carries = forces->fn[c] > least && forces->status[c] != STATUS_NOT_USED;
        out->contacts.flags[c] = carries ? flags : flags | CONTACT_CANDIDATE;
    }
    return 0;
}

/* N/m, along the law's tangent at this force. */
static double normal_stiffness(const struct stiffness *k, size_t row)
{
    struct contact_pair pair = elastic_pair(k->packing, &k->options->law, row);
    return contact_pair_stiffness(&k->options->law, &pair, k->forces->fn[row]);
}

/* N/m, over the contacts: the unit of the matrix. */
static double mean_stiffness(const struct stiffness *k)
{
    double sum = 0;
    for (size_t c = 0; c < k->network->count; c++)
        sum += normal_stiffness(k, k->network->contact[c].row);
    return sum > 0 ? sum / (double)k->network->count : 1;
}

/* ---- one contact ---- */

/* Motions of the contact and of the centres, per degree of freedom that it touches. */
struct lines {
    double n[W], t[W], vn[W], vt[W], r[W];
};

static void lines_of(const struct stiffness *k, const struct network_contact *contact, struct lines *lines)
{
    memset(lines, 0, sizeof *lines);
    for (int e = 0; e < W && contact->dof[e] >= 0; e++) {
        int turns = k->turns[contact->dof[e]];
        lines->n[e] = contact->n[e], lines->t[e] = contact->t[e];
        lines->vn[e] = turns ? 0 : contact->n[e], lines->vt[e] = turns ? 0 : contact->t[e];
        lines->r[e] = turns;
    }
}

/* 1 / distance of the centres; 0 at a straight wall. */
static double curvature(const struct packing *packing, size_t row)
{
    size_t wall;
    if (packing_is_wall(packing, row, &wall) && !wall_is_disc(&packing->walls, wall))
        return 0;
    double d = vec_norm(packing_branch(packing, row));
    return d > 0 ? 1 / d : 0;
}

/* block += factor (a b' + b a') / 2. */
static void add_product(double factor, const double *a, const double *b, double *block)
{
    for (int i = 0; i < W; i++)
        for (int j = 0; j < W; j++)
            block[i * W + j] += factor / 2 * (a[i] * b[j] + a[j] * b[i]);
}

/* The second and third line of the head, without the springs: what can make K indefinite. */
static void geometric_block(const struct stiffness *k, const struct network_contact *contact, const struct lines *lines,
                            double *block)
{
    double fn = k->forces->fn[contact->row] / k->unit, ft = k->forces->ft[contact->row] / k->unit;
    double curve = curvature(k->packing, contact->row);
    memset(block, 0, W * W * sizeof *block);
    add_product(-fn * curve, lines->vt, lines->vt, block);
    add_product(ft * curve, lines->vn, lines->vt, block);
    add_product(ft / (2 * k->network->radius), lines->r, lines->vn, block);
}

/* In units of the mean; 0 for a contact without friction, or one that slips where slipping contacts may slide. */
static double tangential_stiffness(const struct stiffness *k, const struct network_contact *contact, int slips)
{
    int free = contact->mu == 0 || (slips && k->forces->status[contact->row] == STATUS_SLIP);
    return free ? 0 : k->options->law.kt_over_kn * normal_stiffness(k, contact->row) / k->unit;
}

/* ---- all of it ---- */

/* Spinning where no contact has tangential stiffness is no failure: these rotations are left out. */
static void find_spins(struct stiffness *k, int slips)
{
    for (size_t d = 0; d < k->network->dofs; d++)
        k->diagonal[d] = k->turns[d];
    for (size_t c = 0; c < k->network->count; c++) {
        const struct network_contact *contact = &k->network->contact[c];
        double kt = tangential_stiffness(k, contact, slips);
        for (int e = 0; e < W && contact->dof[e] >= 0; e++)
            if (kt > 0 || fabs(contact->n[e]) > 1e-9) /* a normal force beside the centre also holds */
                k->diagonal[contact->dof[e]] = 0;
    }
}

/* Fills K; *bound: how far below zero its eigenvalues can lie (Gershgorin, of the geometric part). */
static int fill(struct stiffness *k, int slips, double *bound)
{
    double *row_sum = calloc(k->network->dofs + 1, sizeof *row_sum);
    if (!row_sum)
        return error_memory("stability");
    *bound = 0;
    find_spins(k, slips);
    sparse_clear(k->matrix);
    for (size_t c = 0; c < k->network->count; c++) {
        const struct network_contact *contact = &k->network->contact[c];
        struct lines lines;
        double *block = k->block[c];
        lines_of(k, contact, &lines);
        geometric_block(k, contact, &lines, block);
        for (int i = 0; i < W && contact->dof[i] >= 0; i++)
            for (int j = 0; j < W; j++)
                row_sum[contact->dof[i]] += fabs(block[i * W + j]);
        add_product(normal_stiffness(k, contact->row) / k->unit, lines.n, lines.n, block);
        add_product(tangential_stiffness(k, contact, slips), lines.t, lines.t, block);
        for (int i = 0; i < W && contact->dof[i] >= 0; i++)
            for (int j = 0; j < W && k->diagonal[contact->dof[i]] > 0; j++)
                block[i * W + j] = block[j * W + i] = 0;
        sparse_add(k->matrix, c, block);
    }
    for (size_t d = 0; d < k->network->dofs; d++)
        *bound = fmax(*bound, row_sum[d]);
    free(row_sum);
    return 0;
}

/* For Lanczos: out = K x. */
static int multiply(void *user, const double *x, double *out)
{
    const struct stiffness *k = user;
    for (size_t d = 0; d < k->network->dofs; d++)
        out[d] = k->diagonal[d] * x[d];
    for (size_t c = 0; c < k->network->count; c++) {
        const int *dof = k->network->contact[c].dof;
        for (int i = 0; i < W && dof[i] >= 0; i++)
            for (int j = 0; j < W && dof[j] >= 0; j++)
                out[dof[i]] += k->block[c][i * W + j] * x[dof[j]];
    }
    return 0;
}

/* For Lanczos: out = K^-1 x. */
static int solve(void *user, const double *x, double *out)
{
    return sparse_solve(((struct stiffness *)user)->matrix, x, out);
}

/* The smallest eigenvalue with its motion: K is shifted by the bound, so that the factor is that of a definite matrix
 * and inverse iteration finds the lowest end. */
static int smallest(struct stiffness *k, int slips, double *value, double *motion)
{
    double bound, defect;
    struct lanczos problem = {k->network->dofs, multiply, solve, k, DEFECT};
    if (fill(k, slips, &bound))
        return -1;
    sparse_add_diagonal(k->matrix, k->diagonal, 1.001 * bound + LEAST_SHIFT * fmax(1, sparse_largest(k->matrix)));
    return sparse_factorise(k->matrix) < 0 ? -1 : lanczos_smallest(&problem, value, motion, &defect);
}

/* 0 or -1; the caller frees in any case. */
static int begin(struct stiffness *k)
{
    const struct network *network = k->network;
    k->block = calloc(network->count + 1, sizeof *k->block);
    k->diagonal = calloc(network->dofs + 1, sizeof *k->diagonal);
    k->turns = calloc(network->dofs + 1, 1);
    if (!k->block || !k->diagonal || !k->turns)
        return error_memory("stability");
    for (size_t g = 0; g < network->grains; g++)
        if (network->grain_dof[g] >= 0)
            k->turns[network->grain_dof[g] + 2] = 1;
    k->unit = mean_stiffness(k);
    k->matrix = network_matrix(network);
    return k->matrix ? 0 : -1;
}

/* Grains that carry nothing do not move with the others: 0. */
static int store_motion(const struct network *network, const double *motion, struct softest *out)
{
    if (table_alloc(&SOFTEST, out, network->grains, NULL))
        return -1;
    for (size_t g = 0; g < network->grains; g++) {
        long dof = network->grain_dof[g];
        out->soft_x[g] = dof >= 0 ? motion[dof] : 0;
        out->soft_y[g] = dof >= 0 ? motion[dof + 1] : 0;
        out->soft_m[g] = dof >= 0 ? motion[dof + 2] : 0;
    }
    return 0;
}

static int with_network(const struct packing *packing, const struct network *network,
                        const struct force_options *options, struct forces *forces)
{
    struct stiffness k = {packing, network, options, &forces->contact, NULL, NULL, NULL, NULL, 1};
    double *motion = calloc(network->dofs + 1, sizeof *motion);
    int status = motion ? begin(&k) : error_memory("stability");
    for (int slips = 0; slips < 2 && !status; slips++)
        status = smallest(&k, slips, &forces->stability[slips], motion);
    if (!status)
        status = store_motion(network, motion, &forces->softest);
    sparse_free(k.matrix);
    free(k.block), free(k.diagonal), free(k.turns), free(motion);
    return status;
}

int stability_of_forces(const struct packing *packing, const struct force_options *options, struct forces *forces)
{
    struct packing loaded;
    struct network network = {0};
    struct network_options network_options = {.wall_mass = options->wall_mass};
    if (!contact_law_known(&options->law))
        return error_input("no contact stiffness: --stability needs the scene's contact.kn_N_per_m or young_Pa");
    if (carrying(packing, &forces->contact, &loaded))
        return -1;
    int status = network_build(&loaded, &options->law, &network_options, &network) ||
                         with_network(&loaded, &network, options, forces)
                     ? -1
                     : 0;
    network_free(&network);
    free(loaded.contacts.flags);
    return status;
}
