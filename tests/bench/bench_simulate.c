/* Isotropic states of simulate beside Table 3.1 of the thesis (1853 discs): solid fraction, coordination number, degree
 * of force indeterminacy, rattlers, the influence of the preparation, and what they cost. */
#include <argp.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "pipeline/error.h"
#include "pipeline/stress.h"
#include "simulation/simulate.h"

struct row {
    double kappa, mu, restitution; /* of the preparation */
    double solid, z, h, rattlers, slipping, unbalanced, weber, cpu;
    long steps;
    size_t contacts;
};

/* h = unknowns - equations of the carrying contacts: 2 per grain contact, 1 per frictionless wall contact; 3 per grain
 * that carries, 2 for the loaded walls. */
static double indeterminacy(const struct packing *packing)
{
    const struct contacts *contacts = &packing->contacts;
    const struct grains *grains = &packing->grains;
    double unknowns = 0, equations = 2;
    for (size_t c = 0; c < contacts->count; c++) {
        size_t i = (size_t)contacts->i[c], j = (size_t)contacts->j[c], wall;
        int at_wall = packing_is_wall(packing, c, &wall);
        if (!(grains->flags[i] & GRAIN_RATTLER) && (at_wall || !(grains->flags[j] & GRAIN_RATTLER)))
            unknowns += at_wall ? 1 : 2;
    }
    for (size_t k = 0; k < grains->count; k++)
        equations += grains->flags[k] & GRAIN_RATTLER ? 0 : 3;
    return unknowns - equations;
}

static int judge(const struct packing *packing, const struct simulation_state *state, void *user)
{
    struct row *row = user;
    struct fabric fabric;
    double applied[2][2];
    packing_fabric(packing, &fabric);
    stress_applied(packing, packing_area(packing), applied);
    row->solid = fabric.solid;
    row->z = fabric.z;
    row->h = indeterminacy(packing);
    row->contacts = packing->contacts.count;
    row->rattlers = (double)fabric.rattlers / (double)packing->grains.count;
    row->unbalanced = packing->forces->imbalance;
    row->weber = 0;
    for (int a = 0; a < 2; a++)
        row->weber = fmax(row->weber, fabs(packing->forces->stress[a][a] / applied[a][a] - 1));
    row->slipping = 0;
    for (size_t c = 0; c < packing->contacts.count; c++)
        row->slipping +=
            packing->forces->contact.status[c] == STATUS_SLIP && !(packing->contacts.flags[c] & CONTACT_WALL);
    row->slipping /= (double)packing->contacts.count;
    row->steps = state->steps;
    return 0;
}

static int measure(struct row *row, double share, double inertial)
{
    struct grade grading[] = {{lround(798 * share), 8e-3},
                              {lround(426 * share), 12e-3},
                              {lround(406 * share), 14e-3},
                              {lround(220 * share), 20e-3}};
    struct simulation simulation = SIMULATION_DEFAULT;
    simulation.grading = grading;
    simulation.grade_count = 4;
    simulation.law = (struct contact_law){.kind = LAW_LINEAR, .kn = 5e7, .kt_over_kn = 1, .mu = 0.5};
    simulation.kappa = row->kappa;
    simulation.preparation_mu = row->mu;
    simulation.restitution = row->restitution;
    simulation.inertial = inertial;
    clock_t begin = clock();
    int status = simulate(&simulation, judge, row);
    row->cpu = (double)(clock() - begin) / CLOCKS_PER_SEC;
    return status;
}

static void print_row(const struct row *row)
{
    printf("%7.0f %5.2f %5.2f | %6.4f %5.3f %6.0f %7.1f %% | %8zu %6.2f %% %9.1e %9.1e | %8ld %7.2f\n", row->kappa,
           row->mu, row->restitution, row->solid, row->z, row->h, 100 * row->rattlers, row->contacts,
           100 * row->slipping, row->unbalanced, row->weber, row->steps, row->cpu);
}

int main(int argc, char **argv)
{
    static const double kappa[] = {100, 1000, 10000};
    static const struct {
        double mu, restitution;
    } preparation[] = {{0.5, 0.3}, {0.2, 0.3}, {0.1, 0.3}, {0, 0.3}, {0.2, 0.9}};
    double share = argc > 1 ? atof(argv[1]) : 1, inertial = argc > 2 ? atof(argv[2]) : 1e-3;
    printf("%.0f discs, mu = 0.5, inertial number %g. Thesis, Table 3.1: solid 0.848 / 0.828 / 0.825,\n"
           "z 3.78 / 2.81 / 2.56, h 1601 / 409 / 196, rattlers 4.2 / 15.5 / 19.7 %% at kappa 100 / 1000 / 10000\n\n",
           1850 * share, inertial);
    printf("  kappa  mu_c     e |  solid     z      h  rattlers | contacts  slip    unbalanced  Weber    |    steps  "
           "CPU s\n");
    for (size_t p = 0; p < sizeof preparation / sizeof *preparation; p++)
        for (size_t k = 0; k < 3; k++) {
            struct row row = {.kappa = kappa[k], .mu = preparation[p].mu, .restitution = preparation[p].restitution};
            int status = measure(&row, share, inertial);
            if (status < 0) {
                fprintf(stderr, "bench_simulate: %s\n", error_message());
                return error_status();
            }
            print_row(&row);
            fflush(stdout);
        }
    return 0;
}
