#include "tests/bench/force_states.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "pipeline/speak/error.h"
#include "pipeline/numbers/random.h"
#include "pipeline/packing/packing_file.h"
#include "simulation/dem/simulate.h"

int packing_copy(const struct packing *from, struct packing *to)
{
    memset(to, 0, sizeof *to);
    to->length_m = from->length_m;
    to->forces = calloc(from->force_count + 1, sizeof *to->forces);
    if (!to->forces || table_copy(&GRAINS, &to->grains, &from->grains) ||
        table_copy(&WALLS, &to->walls, &from->walls) || table_copy(&CONTACTS, &to->contacts, &from->contacts))
        return -1;
    for (size_t k = 0; k < from->force_count; k++) {
        struct forces *forces = &to->forces[to->force_count++];
        memcpy(forces->method, from->forces[k].method, sizeof forces->method);
        memcpy(forces->stress, from->forces[k].stress, sizeof forces->stress);
        forces->converged = from->forces[k].converged;
        forces->kn = from->forces[k].kn, forces->kt = from->forces[k].kt, forces->mu = from->forces[k].mu;
        if (table_copy(&CONTACT_FORCES, &forces->contact, &from->forces[k].contact))
            return -1;
    }
    return 0;
}

static int keep(const struct packing *packing, const struct simulation_state *state, void *user)
{
    struct states *states = user;
    (void)state;
    struct packing *grown = realloc(states->state, (states->count + 1) * sizeof *grown);
    if (!grown)
        return error_memory("states");
    states->state = grown;
    return packing_copy(packing, &grown[states->count++]);
}

int states_make(const struct states_test *test, struct states *states)
{
    struct simulation simulation = SIMULATION_DEFAULT;
    double share = test->grains / 1850;
    const struct grade grading[] = {{(long)(798 * share + 0.5), 8e-3},
                                    {(long)(426 * share + 0.5), 12e-3},
                                    {(long)(406 * share + 0.5), 14e-3},
                                    {(long)(220 * share + 0.5), 20e-3}};
    const struct loading_steps loading[] = {{test->steps, test->strain}};
    memset(states, 0, sizeof *states);
    simulation.seed = test->seed;
    simulation.grading = grading, simulation.grade_count = 4;
    simulation.law = (struct contact_law){.row = &linear_law, .kn = 1.09e7, .kt_over_kn = 1, .mu = 0.5};
    simulation.kappa = test->kappa;
    simulation.tolerance = test->tolerance;
    if (test->patience > 0)
        simulation.max_steps = test->patience;
    simulation.test = TEST_BIAXIAL_VERTICAL;
    simulation.steps = loading, simulation.step_count = test->steps > 0;
    return simulate(&simulation, keep, states);
}

/* ---- states in files ---- */

static void path_of(const char *folder, const struct states_test *test, long s, char path[1000])
{
    snprintf(path, 1000, "%s/states-%g-%g-%llu-%ldx%g-%g-%ld-%04ld.hdf", folder, test->grains, test->kappa,
             (unsigned long long)test->seed, test->steps, test->strain, test->tolerance, test->patience, s);
}

static int read_states(const char *folder, const struct states_test *test, struct states *states)
{
    memset(states, 0, sizeof *states);
    states->state = calloc((size_t)test->steps + 1, sizeof *states->state);
    if (!states->state)
        return error_memory("states");
    for (long s = 0; s <= test->steps; s++) {
        char path[1000];
        path_of(folder, test, s, path);
        if (packing_read(path, &states->state[s]))
            return -1;
        states->count++;
    }
    return 0;
}

static int write_states(const char *folder, const struct states_test *test, const struct states *states)
{
    struct provenance provenance = PROVENANCE_DEFAULT;
    provenance.stage = "bench", provenance.parameters = "{}", provenance.coordinates = "si";
    for (size_t s = 0; s < states->count; s++) {
        char path[1000];
        path_of(folder, test, (long)s, path);
        if (packing_write(path, &states->state[s], &provenance))
            return -1;
    }
    return 0;
}

int states_keep(const char *folder, const struct states_test *test, struct states *states)
{
    char last[1000];
    if (!folder)
        return states_make(test, states) < 0 ? -1 : 0;
    path_of(folder, test, test->steps, last); /* written last: all are there when it is */
    FILE *there = fopen(last, "rb");
    if (there) {
        fclose(there);
        return read_states(folder, test, states);
    }
    return states_make(test, states) < 0 || write_states(folder, test, states) ? -1 : 0;
}

int states_simulate(double grains, double kappa, uint64_t seed, long steps, double strain, struct states *states)
{
    const struct states_test test = {grains, kappa, seed, steps, strain, 1e-9, 0};
    return states_make(&test, states);
}

void states_free(struct states *states)
{
    for (size_t k = 0; k < states->count; k++)
        packing_free(&states->state[k]);
    free(states->state);
    memset(states, 0, sizeof *states);
}

double states_mean_force(const struct packing *truth)
{
    const struct contact_forces *forces = &packing_forces(truth, "dem")->contact;
    double sum = 0, count = 0;
    for (size_t c = 0; c < forces->count; c++)
        if (forces->fn[c] > 0)
            sum += forces->fn[c], count++;
    return count > 0 ? sum / count : 1;
}

/* ---- disturbed geometry ---- */

static int put_contact(struct packing *packing, size_t c, size_t i, size_t j)
{
    const struct grains *g = &packing->grains;
    struct contacts *contacts = &packing->contacts;
    struct vec a = vec(g->x[i], g->y[i]), n;
    double overlap;
    if (j >= g->count) {
        size_t w = j - g->count;
        struct vec in = wall_inward(&packing->walls, w);
        n = vec_scale(-1, in);
        overlap = g->radius[i] - vec_dot(vec_sub(a, vec(packing->walls.x0[w], packing->walls.y0[w])), in);
    } else {
        struct vec l = vec_sub(vec(g->x[j], g->y[j]), a);
        n = vec_unit(l);
        overlap = g->radius[i] + g->radius[j] - vec_norm(l);
    }
    struct vec at = vec_add(a, vec_scale(g->radius[i] - overlap / 2, n));
    double share = j >= g->count ? 1 : 2;
    double s = sqrt(share * (pow(g->s_x_ref[i], 2) + pow(g->s_radius[i], 2)));
    contacts->i[c] = (int64_t)i, contacts->j[c] = (int64_t)j;
    contacts->nx[c] = n.x, contacts->ny[c] = n.y;
    contacts->x[c] = at.x, contacts->y[c] = at.y;
    contacts->overlap[c] = overlap;
    contacts->s_overlap[c] = s;
    contacts->flags[c] = overlap < 0 ? CONTACT_CANDIDATE : 0;
    return overlap > -4 * s;
}

static int touching(const struct packing *packing, size_t i, size_t j)
{
    const struct grains *g = &packing->grains;
    double s = sqrt(2 * (pow(g->s_x_ref[i], 2) + pow(g->s_radius[i], 2)));
    return g->radius[i] + g->radius[j] - hypot(g->x[i] - g->x[j], g->y[i] - g->y[j]) > -4 * s;
}

/* Every pair within four standard errors of touching; those that do not touch as measured are candidates. */
static int find_again(struct packing *packing)
{
    static const char *const columns[] = {"i", "j", "nx", "ny", "x", "y", "overlap", "s_overlap", "flags", NULL};
    size_t grains = packing->grains.count, most = 20 * grains + 100, found = 0;
    struct contacts wide = {0}, narrow = {0};
    if (table_alloc(&CONTACTS, &wide, most, columns))
        return -1;
    table_free(&CONTACTS, &packing->contacts);
    packing->contacts = wide;
    for (size_t i = 0; i < grains; i++)
        for (size_t j = i + 1; j < grains + packing->walls.count && found < most; j++)
            if ((j >= grains || touching(packing, i, j)) && put_contact(packing, found, i, j))
                found++;
    if (table_alloc(&CONTACTS, &narrow, found, columns))
        return -1;
    for (size_t k = 0; k < CONTACTS.column_count; k++) {
        void **from = table_array(&CONTACTS.columns[k], &packing->contacts);
        void **to = table_array(&CONTACTS.columns[k], &narrow);
        if (*from && *to)
            memcpy(*to, *from, found * column_size(CONTACTS.columns[k].type));
    }
    table_free(&CONTACTS, &packing->contacts);
    packing->contacts = narrow;
    return 0;
}

int states_disturb(const struct packing *truth, const struct disturbance *disturbance, struct packing *measured)
{
    double unit = states_mean_force(truth) / 1.09e7;
    static const char *const errors[] = {"s_x_ref", "s_y_ref", "s_radius", NULL};
    if (packing_copy(truth, measured) || table_add(&CONTACTS, &measured->contacts, "s_overlap"))
        return -1;
    for (int k = 0; errors[k]; k++)
        if (table_add(&GRAINS, &measured->grains, errors[k]))
            return -1;
    struct grains *g = &measured->grains;
    for (size_t k = 0; k < g->count; k++) {
        g->x[k] += unit * disturbance->place * random_normal(disturbance->seed, 3 * k);
        g->y[k] += unit * disturbance->place * random_normal(disturbance->seed, 3 * k + 1);
        g->radius[k] += unit * disturbance->radius * random_normal(disturbance->seed, 3 * k + 2);
        g->radius[k] *= 1 + disturbance->scale;
        g->s_x_ref[k] = g->s_y_ref[k] = unit * disturbance->place;
        g->s_radius[k] = unit * disturbance->radius;
    }
    if (disturbance->network)
        return find_again(measured);
    for (size_t c = 0; c < measured->contacts.count; c++) {
        put_contact(measured, c, (size_t)measured->contacts.i[c], (size_t)measured->contacts.j[c]);
        measured->contacts.flags[c] = 0;
    }
    return 0;
}

/* ---- comparison ---- */

double states_force_at(const struct contacts *contacts, const double *force, int64_t i, int64_t j, size_t near)
{
    size_t n = contacts->count; /* rows of both tables are sorted alike: look near the last hit first */
    for (size_t k = 0; k < n; k++) {
        size_t c = (near + k) % n;
        if (contacts->i[c] == i && contacts->j[c] == j)
            return force[c];
    }
    return 0;
}

double states_r(const struct packing *truth, const struct packing *packing, const double *true_force,
                const double *force, int walls)
{
    const struct contacts *contacts = &truth->contacts;
    int64_t grains = (int64_t)truth->grains.count;
    double n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;
    for (size_t c = 0; c < contacts->count; c++) {
        if (!walls && contacts->j[c] >= grains)
            continue;
        double p = true_force[c], q = states_force_at(&packing->contacts, force, contacts->i[c], contacts->j[c], c);
        n++, a += p, b += q, aa += p * p, bb += q * q, ab += p * q;
    }
    return (ab - a * b / n) / sqrt((aa - a * a / n) * (bb - b * b / n));
}

double states_cpu(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}
