/* Contact dynamics (cdm) beside the nonlinear Gauss-Seidel solver of Siconos (fc2d_nsgs, Acary et al.), both from zero,
 * on the same contact problem (W, q, mu: what forces --fclib writes), in the same run (docs/forces.md):
 *
 *     bench_siconos [--kappa K,...] [--grains N] [--keep FOLDER]
 *
 * Both are judged by the same residual, the largest unbalanced component over <fn>. Siconos goes on in blocks of sweeps
 * from where it was; its error is looked at once a block, and the assembly of W is not counted against it. Without
 * Debian's libsiconos-numerics-dev at build time the program says so and leaves with 77. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "forces/questions/fclib.h"
#include "forces/methods/method.h"
#include "pipeline/speak/error.h"
#include "tests/bench/force_states.h"

#ifdef HAVE_SICONOS
#include <FrictionContactProblem.h>
#include <Friction_cst.h>
#include <NonSmoothDrivers.h>
#include <NumericsMatrix.h>
#include <SolverOptions.h>
#include <SparseBlockMatrix.h>
#include <NumericsSparseMatrix.h>
#include <CSparseMatrix.h>

enum { BLOCK = 500, SWEEPS = 40000 };
static const double WANTED[] = {1e-1, 1e-2, 1e-3, 1e-4};
enum { RESIDUAL_COUNT = sizeof WANTED / sizeof *WANTED };

struct reached {
    int sweeps;
    double cpu; /* NaN: not reached */
};

/* ---- Siconos ---- */

/* W as 2 x 2 blocks, as Siconos wants it. */
static FrictionContactProblem *to_siconos(const struct local_problem *local)
{
    NumericsMatrix *triplet = NM_create(NM_SPARSE, local->rows, local->rows);
    NumericsMatrix *blocks = NM_create(NM_SPARSE_BLOCK, local->rows, local->rows);
    NM_triplet_alloc(triplet, local->entries);
    for (int column = 0; column < local->rows; column++)
        for (int k = local->start[column]; k < local->start[column + 1]; k++)
            NM_entry(triplet, local->row[k], column, local->value[k]);
    SBM_from_csparse(2, NM_csc(triplet), blocks->matrix1);
    NM_clear(triplet);
    free(triplet);
    return frictionContactProblem_new_with_data(2, local->rows / 2, blocks, local->q, local->mu);
}

static int by_siconos(const struct network *network, const struct local_problem *local, struct reached *reached,
                      double *per_sweep, double *r)
{
    FrictionContactProblem *problem = to_siconos(local);
    SolverOptions *options = solver_options_create(SICONOS_FRICTION_2D_NSGS);
    double *u = calloc((size_t)local->rows + 1, sizeof *u), *work = calloc(network->dofs + 1, sizeof *work), cpu = 0;
    int sweeps = 0, target = 0;
    if (!u || !work)
        return error_memory("Siconos");
    options->iparam[SICONOS_IPARAM_MAX_ITER] = BLOCK;
    options->iparam[SICONOS_FRICTION_3D_IPARAM_ERROR_EVALUATION] = SICONOS_FRICTION_3D_NSGS_ERROR_EVALUATION_LIGHT;
    options->dparam[SICONOS_DPARAM_TOL] = 1e-14;
    while (sweeps < SWEEPS && target < RESIDUAL_COUNT) {
        double begin = states_cpu();
        fc2d_driver(problem, r, u, options);
        cpu += states_cpu() - begin;
        sweeps += BLOCK;
        for (double left = network_judge(network, r, work); target < RESIDUAL_COUNT && left <= WANTED[target]; target++)
            reached[target] = (struct reached){sweeps, cpu};
    }
    *per_sweep = cpu / sweeps;
    problem->q = problem->mu = NULL; /* ours */
    frictionContactProblem_free(problem);
    solver_options_delete(options);
    free(options), free(u), free(work);
    return 0;
}

/* ---- ours ---- */

static int by_cdm(const struct network *network, struct reached *reached, double *per_sweep, double *f)
{
    for (int t = 0; t < RESIDUAL_COUNT; t++) {
        struct force_options options = FORCE_OPTIONS_DEFAULT;
        struct outcome outcome;
        options.law.mu = 0.5;
        options.tolerance = WANTED[t], options.iterations = SWEEPS;
        memset(f, 0, 2 * network->count * sizeof *f);
        double begin = states_cpu();
        if (CDM_METHOD.solve(&(struct problem){.network = network, .options = &options}, f, &outcome))
            return -1;
        double cpu = states_cpu() - begin;
        *per_sweep = cpu / outcome.iterations;
        if (!outcome.converged)
            break;
        reached[t] = (struct reached){outcome.iterations, cpu};
    }
    return 0;
}

/* Pearson r of the normal forces of two solutions. */
static double r_between(size_t count, const double *a, const double *b)
{
    double ma = 0, mb = 0, aa = 0, bb = 0, ab = 0;
    for (size_t c = 0; c < count; c++)
        ma += a[2 * c] / (double)count, mb += b[2 * c] / (double)count;
    for (size_t c = 0; c < count; c++) {
        double x = a[2 * c] - ma, y = b[2 * c] - mb;
        aa += x * x, bb += y * y, ab += x * y;
    }
    return ab / sqrt(aa * bb);
}

static int compare(const struct packing *packing, const char *label)
{
    struct force_options options = FORCE_OPTIONS_DEFAULT;
    struct network_options network_options = {.wall_mass = FORCE_WALL_MASS};
    struct network network;
    struct local_problem local;
    struct reached ours[RESIDUAL_COUNT], theirs[RESIDUAL_COUNT];
    double sweep_ours, sweep_theirs;
    options.law.mu = 0.5;
    if (network_build(packing, &options.law, &network_options, &network) || local_problem_build(&network, &local))
        return -1;
    double *f = calloc(2 * network.count + 1, sizeof *f), *r = calloc(2 * network.count + 1, sizeof *r);
    for (int t = 0; t < RESIDUAL_COUNT; t++)
        ours[t] = theirs[t] = (struct reached){0, NAN};
    if (!f || !r || by_cdm(&network, ours, &sweep_ours, f) || by_siconos(&network, &local, theirs, &sweep_theirs, r))
        return -1;
    for (int t = 0; t < RESIDUAL_COUNT; t++)
        printf("%-24s residual %.0e: cdm %6d sweeps %8.3f s, siconos %6d sweeps %8.3f s, ratio %.1f\n", label,
               WANTED[t], ours[t].sweeps, ours[t].cpu, theirs[t].sweeps, theirs[t].cpu, theirs[t].cpu / ours[t].cpu);
    printf("%-24s CPU a sweep: cdm %.1f us, siconos %.1f us, ratio %.1f; r(fn) of the two solutions %.4f\n", label,
           1e6 * sweep_ours, 1e6 * sweep_theirs, sweep_theirs / sweep_ours, r_between(network.count, f, r));
    fflush(stdout);
    free(f), free(r);
    local_problem_free(&local);
    network_free(&network);
    return 0;
}

int main(int argc, char **argv)
{
    double kappas[8] = {100, 1000}, grains = 600;
    const char *folder = NULL;
    int count = 2;
    for (int k = 1; k + 1 < argc; k += 2) {
        char *value = argv[k + 1];
        if (!strcmp(argv[k], "--kappa"))
            for (count = 0; *value && count < 8; value += *value == ',')
                kappas[count++] = strtod(value, &value);
        if (!strcmp(argv[k], "--keep"))
            folder = value;
        if (!strcmp(argv[k], "--grains"))
            grains = strtod(value, NULL);
    }
    for (int k = 0; k < count; k++) {
        struct states states;
        char label[60];
        const struct states_test test = {grains, kappas[k], 1, 0, 0, 1e-9, 0};
        snprintf(label, sizeof label, "kappa %g, %g grains", kappas[k], grains);
        if (states_keep(folder, &test, &states) || compare(&states.state[0], label)) {
            fprintf(stderr, "bench_siconos: %s\n", error_message());
            return EXIT_FAILED;
        }
        states_free(&states);
    }
    return EXIT_DONE;
}

#else

int main(void)
{
    printf("bench_siconos: skipped: built without Siconos (Debian: libsiconos-numerics-dev)\n");
    return 77;
}

#endif
