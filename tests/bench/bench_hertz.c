/* The hybrid calibration of Hertz parameters in the plane (Qu et al.): what each method needs, on the paper's packings.
 *
 *     bench_hertz case1 [GRAINS]    E = 10 GPa, grains alike: 1787 (Newton, and Adam at its own rate), or so many (all
 *     bench_hertz case3 [GRAINS]    methods, and probes whose packing is made anew); case3: 1655 graded
 *     bench_hertz both [GRAINS]     E and nu together: what a packing of discs can answer, and whether it is found
 *     bench_hertz spheres [GRAINS]  E, then E and nu of a packing of spheres by LAMMPS (1000)
 *     bench_hertz porosity [GRAINS] closed forms against discrete elements over the porosity (the paper's Figs 8, 9),
 * for stiff and for soft grains, and what an affine motion of the grains would give
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "calibration/hertz/hertz.h"
#include "calibration/hertz/hertz_probes.h"
#include "calibration/hertz/lammps_probes.h"
#include "pipeline/speak/error.h"

static const double TARGET = 1e10, PRESSURE = 1e6; /* N/m: per metre of rod */

static int failed(void)
{
    fprintf(stderr, "bench_hertz: %s\n", error_message());
    return 1;
}

static double seconds(void)
{
    return (double)clock() / CLOCKS_PER_SEC;
}

/* Radius 0.1 m: all alike, or evenly spread over 0.07 to 0.13 in seven sizes. */
static size_t grading_of(int graded, long count, struct grade grading[7])
{
    if (!graded) {
        grading[0] = (struct grade){count, 0.2};
        return 1;
    }
    for (int g = 0; g < 7; g++)
        grading[g] = (struct grade){count / 7 + (g < count % 7), 0.14 + 0.02 * g};
    return 7;
}

static struct simulation packing_of(const struct grade *grading, size_t grades, double mu, uint64_t seed)
{
    struct simulation simulation = SIMULATION_DEFAULT;
    simulation.seed = seed;
    simulation.grading = grading;
    simulation.grade_count = grades;
    simulation.density = 2600;
    simulation.length = NAN;
    simulation.pressure = PRESSURE;
    simulation.preparation_mu = mu;
    simulation.tolerance = 1e-6;
    simulation.law = (struct contact_law){.row = &hertz_pfc_law, .kt_over_kn = 1, .mu = mu};
    return simulation;
}

struct variant {
    const char *name;
    enum hertz_method method;
    int vary_poisson;
    double rate;
};

static int run_variant(const char *name, const struct variant *variant, struct hertz_goal *goal,
                       struct hertz_probes *probes)
{
    struct hertz_found found;
    double begin = seconds(), first;
    goal->method = variant->method;
    goal->rate = variant->rate;
    goal->vary_poisson = variant->vary_poisson;
    if (hertz_search(goal, hertz_probes_evaluate, probes, &found))
        return failed();
    first = probes->record.rows[0].young;
    printf("| %s | %s | %s | %+.1f %% | %d | %d | %+.2f %% | %.3f | %.4g | %.1f |\n", name, variant->name,
           probes->cold ? "anew" : "warm", 100 * (first / TARGET - 1), found.iterations, found.probes,
           100 * (found.best.young / TARGET - 1), found.best.poisson, found.best.grain_young, seconds() - begin);
    fflush(stdout);
    return 0;
}

/* Methods on one consolidated packing; the first probe is the same for all and made once. */
static int run_case(const char *name, const struct simulation *simulation, int cold, size_t methods)
{
    static const struct variant variants[] = {{"Newton", HERTZ_NEWTON, 0, 0},
                                              {"Adam, E*, rate by the way left", HERTZ_ADAM, 0, 0},
                                              {"Adam, E*, rate 0.2", HERTZ_ADAM, 0, 0.2},
                                              {"Adam, E*, rate 0.1", HERTZ_ADAM, 0, 0.1},
                                              {"Adam, E* and nu*, rate 0.1", HERTZ_ADAM, 1, 0.1}};
    struct hertz_goal goal = {.dimensions = HERTZ_2D,
                              .young = TARGET,
                              .grain_poisson = 0.2,
                              .first_step = HERTZ_FIRST_STEP,
                              .cost = HERTZ_COST,
                              .most_probes = cold ? 16 : 48};
    struct probe_options probe = PROBE_DEFAULT;
    struct hertz_probes probes;
    double begin = seconds();
    if (hertz_probes_open(simulation, &probe, cold, NULL, &goal, &probes))
        return failed();
    if (!cold)
        printf("| %s | consolidation | | | | | | | | %.1f |\n", name, seconds() - begin);
    for (size_t v = 0; v < methods && v < sizeof variants / sizeof *variants; v++)
        if (run_variant(name, &variants[v], &goal, &probes))
            return 1;
    hertz_probes_close(&probes);
    return 0;
}

/* Probes made anew, packing and all, only where a size is asked for: they take the consolidation each. */
static int one_case(int graded, long grains)
{
    struct grade grading[7];
    char name[64];
    long count = grains ? grains : graded ? 1655 : 1787;
    size_t grades = grading_of(graded, count, grading);
    struct simulation simulation = packing_of(grading, grades, 0.1, 1);
    snprintf(name, sizeof name, "case %d: %ld %s", graded ? 3 : 1, count, graded ? "graded" : "alike");
    printf("| packing | method | probes made | E of the closed form | iterations | probes | E reached | nu | E*, N/m | "
           "CPU "
           "s |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
    if (run_case(name, &simulation, 0, grains ? 5 : 2))
        return 1;
    return grains ? run_case(name, &simulation, 1, 1) : 0;
}

/* nu over nu* at the E that is asked: the whole range that a packing can answer; then both methods on a target inside
 * and on the paper's 0.2. */
static int both(long grains)
{
    struct grade grading[7];
    long count = grains ? grains : 1787;
    size_t grades = grading_of(0, count, grading);
    struct simulation simulation = packing_of(grading, grades, 0.1, 1);
    struct probe_options probe = PROBE_DEFAULT;
    struct hertz_goal goal = {.dimensions = HERTZ_2D, .young = TARGET, .grain_poisson = 0.2};
    struct hertz_probes probes;
    if (hertz_probes_open(&simulation, &probe, 0, NULL, &goal, &probes))
        return failed();
    printf("| nu* | E | nu |\n| --- | --- | --- |\n");
    double low = INFINITY, high = -INFINITY;
    for (int k = 0; k <= 5; k++) {
        struct hertz_trial trial = {.grain_young = goal.grain_young, .grain_poisson = 0.1 * k};
        if (hertz_probes_evaluate(&trial, 1, &probes))
            return failed();
        printf("| %.1f | %.4g | %.4f |\n", trial.grain_poisson, trial.young, trial.poisson);
        low = fmin(low, trial.poisson), high = fmax(high, trial.poisson);
    }
    printf("\n| target nu | method | probes | iterations | E | nu | nu* | reached |\n"
           "| --- | --- | --- | --- | --- | --- | --- | --- |\n");
    for (int t = 0; t < 2; t++)
        for (int method = HERTZ_NEWTON; method <= HERTZ_ADAM; method++) {
            struct hertz_found found;
            goal.poisson = t ? 0.2 : low + 0.6 * (high - low);
            goal.fit_poisson = 1;
            goal.method = (enum hertz_method)method;
            goal.rate = 0.1, goal.first_step = HERTZ_FIRST_STEP, goal.cost = HERTZ_COST, goal.most_probes = 45;
            if (hertz_search(&goal, hertz_probes_evaluate, &probes, &found))
                return failed();
            printf("| %.4f | %s | %d | %d | %+.2f %% | %.4f | %.3f | %s |\n", goal.poisson, HERTZ_METHODS[method],
                   found.probes, found.iterations, 100 * (found.best.young / TARGET - 1), found.best.poisson,
                   found.best.grain_poisson, found.reached ? "yes" : "no");
            fflush(stdout);
        }
    hertz_probes_close(&probes);
    return 0;
}

/* E if every grain followed the strain (no grain finds its own equilibrium: a bound from above), from each contact's
 * own stiffness and branch: C1111 = sum l^2 (3 kn + ks) / 8 S, C1122 = sum l^2 (kn - ks) / 8 S. */
static double affine_young(const struct dem *dem, double ks_over_kn)
{
    double sum = 0, box = dem->box.size[BOX_WIDTH] * dem->box.size[BOX_HEIGHT];
    for (size_t p = 0; p < dem->pair_count; p++) {
        const struct dem_pair *pair = &dem->pairs[p];
        double branch = dem->grains[pair->i].radius;
        if ((size_t)pair->j < dem->count)
            branch += dem->grains[pair->j].radius;
        if (pair->touching)
            sum += branch * branch * pair->spring.stiffness / box;
    }
    double c11 = sum * (3 + ks_over_kn) / 8, c12 = sum * (1 - ks_over_kn) / 8;
    return c11 - c12 * c12 / c11;
}

static int porosity_of(const struct simulation *simulation)
{
    struct probe_options small = PROBE_DEFAULT, large = PROBE_DEFAULT;
    struct probe_packing packing;
    struct probe_result result, further;
    const struct contact_law *law = &simulation->law;
    double kn, ks, closed, closed_nu;
    large.strain = 5e-4; /* the paper's */
    if (probe_consolidate(simulation, &packing) || probe_run(&packing, &small, &result) ||
        probe_run(&packing, &large, &further))
        return failed();
    struct hertz_packing equal = {HERTZ_2D, 0.5 * result.fabric.d50, result.fabric.volume_per_contact, PRESSURE};
    hertz_stiffness(equal.radius, law->young / (2 * (1 + law->poisson)), law->poisson, hertz_mean_force(&equal), &kn,
                    &ks);
    hertz_moduli(&equal, kn, ks, &closed, &closed_nu);
    double affine = affine_young(&packing.loading.dem, law->kt_over_kn);
    printf("| %.2g | %.2f | %.4f | %.3f | %.4g | %+.1f %% | %+.1f %% | %+.1f %% | %.3f | %.3f |\n", law->young,
           simulation->preparation_mu, result.fabric.porosity, result.fabric.z, result.young,
           100 * (further.young / result.young - 1), 100 * (closed / result.young - 1),
           100 * (affine / result.young - 1), result.poisson, closed_nu);
    fflush(stdout);
    probe_packing_free(&packing);
    return 0;
}

static int porosity(long grains)
{
    static const double mus[] = {0, 0.05, 0.1, 0.2, 0.3, 0.5}, youngs[] = {5e12, 5e10, 3e9}, nu = 0.2;
    struct grade grading[7];
    size_t grades = grading_of(1, grains ? grains : 1655, grading);
    printf(
        "| E*, N/m | friction of the compression | porosity | z | E, discrete | E at a strain of 5e-4 | closed form | "
        "affine motion | nu, discrete | nu, closed form |\n"
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
    for (int y = 0; y < 3; y++)
        for (int m = 0; m < 6; m++) {
            struct simulation simulation = packing_of(grading, grades, mus[m], 1);
            simulation.law.young = youngs[y], simulation.law.poisson = nu;
            simulation.law.kt_over_kn = 2 * (1 - nu) / (2 - nu);
            if (porosity_of(&simulation))
                return 1;
        }
    return 0;
}

/* The paper's case 2, smaller: spheres alike, 1 MPa, E = 10 GPa; then E and nu, the latter in the middle of what the
 * packing can answer, and the paper's 0.2. */
static int spheres(long grains)
{
    struct grade grading = {grains ? grains : 1000, 0.2};
    struct simulation simulation = packing_of(&grading, 1, 0.2, 1);
    struct hertz_goal goal = {.dimensions = HERTZ_3D,
                              .young = TARGET,
                              .grain_poisson = 0.2,
                              .rate = 0.1,
                              .first_step = HERTZ_FIRST_STEP,
                              .cost = HERTZ_COST,
                              .most_probes = 20};
    struct lammps_probes probes;
    struct hertz_found found;
    if (!lammps_is_installed()) {
        puts("skipped: LAMMPS is not installed (apt-get install lammps)");
        return 0;
    }
    if (lammps_probes_open(&simulation, LAMMPS_PROBE_STRAIN, PROBE_MU, NULL, &goal, &probes))
        return failed();
    printf(
        "%ld spheres, porosity %.4f, z %.3f\n\n| sought | probes | iterations | E of the closed form | E | nu | nu* | "
        "reached |\n| --- | --- | --- | --- | --- | --- | --- | --- |\n",
        grading.count, probes.porosity, probes.z);
    double targets[3] = {NAN, NAN, 0.2};
    for (int t = 0; t < (grading.count > 500 ? 1 : 3); t++) { /* large ones: E only, the others take many probes */
        goal.fit_poisson = t > 0;
        goal.poisson = targets[t];
        if (hertz_search(&goal, lammps_probes_evaluate, &probes, &found))
            return failed();
        printf("| E%s%.3g | %d | %d | %+.1f %% | %+.2f %% | %.4f | %.3f | %s |\n", t ? ", nu = " : " ",
               t ? targets[t] : TARGET, found.probes, found.iterations,
               100 * (probes.record.rows[0].young / TARGET - 1), 100 * (found.best.young / TARGET - 1),
               found.best.poisson, found.best.grain_poisson, found.reached ? "yes" : "no");
        fflush(stdout);
        if (t == 0) { /* the answers at the ends of the range of nu* */
            struct hertz_trial ends[2] = {{.grain_young = found.best.grain_young, .grain_poisson = 0},
                                          {.grain_young = found.best.grain_young, .grain_poisson = 0.5}};
            if (lammps_probes_evaluate(ends, 2, &probes))
                return failed();
            printf("| nu* = 0 and 0.5 | | | | | %.4f and %.4f | | |\n", ends[0].poisson, ends[1].poisson);
            targets[1] = 0.5 * (ends[0].poisson + ends[1].poisson);
        }
    }
    lammps_probes_close(&probes);
    return 0;
}

int main(int argc, char **argv)
{
    long grains = argc > 2 ? atol(argv[2]) : 0;
    if (argc > 1 && (!strcmp(argv[1], "case1") || !strcmp(argv[1], "case3")))
        return one_case(argv[1][4] == '3', grains);
    if (argc > 1 && !strcmp(argv[1], "both"))
        return both(grains);
    if (argc > 1 && !strcmp(argv[1], "porosity"))
        return porosity(grains);
    if (argc > 1 && !strcmp(argv[1], "spheres"))
        return spheres(grains);
    fputs("bench_hertz case1|case3|both|spheres|porosity [GRAINS]\n", stderr);
    return 2;
}
