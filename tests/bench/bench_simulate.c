/* Isotropic states of simulate beside Table 3.1 of the thesis (1853 discs): solid fraction, coordination number, degree
 * of force indeterminacy, rattlers, the influence of the preparation, and what they cost. */
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include "pipeline/speak/error.h"
#include "pipeline/numbers/random.h"
#include "simulation/dem/dem_motion.h"
#include "simulation/dem/simulate.h"

struct row {
    double kappa, mu, restitution; /* of the preparation */
    double solid, z, h, rattlers, slipping, unbalanced, weber, cpu;
    long steps;
    size_t contacts;
};

static int judge(const struct packing *packing, const struct simulation_state *state, void *user)
{
    struct row *row = user;
    row->solid = state->solid;
    row->z = state->z;
    row->h = state->indeterminacy;
    row->contacts = packing->contacts.count;
    row->rattlers = state->rattlers;
    row->slipping = state->sliding;
    row->unbalanced = state->unbalanced;
    row->weber = 0;
    for (int a = 0; a < 2; a++)
        row->weber = fmax(row->weber, fabs(state->stress[a][a] / state->applied[a][a] - 1));
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
    simulation.law = (struct contact_law){.row = &linear_law, .kn = 5e7, .kt_over_kn = 1, .mu = 0.5};
    simulation.kappa = row->kappa;
    simulation.preparation_mu = row->mu;
    simulation.restitution = row->restitution;
    simulation.inertial = inertial;
    clock_t begin = clock();
    int status = simulate(&simulation, judge, row);
    row->cpu = (double)(clock() - begin) / CLOCKS_PER_SEC;
    return status;
}

static void print_row(const struct row *row, FILE *json, int first)
{
    printf("%7.0f %5.2f %5.2f | %6.4f %5.3f %6.0f %7.1f %% | %8zu %6.2f %% %9.1e %9.1e | %8ld %7.2f\n", row->kappa,
           row->mu, row->restitution, row->solid, row->z, row->h, 100 * row->rattlers, row->contacts,
           100 * row->slipping, row->unbalanced, row->weber, row->steps, row->cpu);
    fflush(stdout);
    if (json)
        fprintf(json,
                "%s{\"kappa\": %g, \"mu\": %g, \"restitution\": %g, \"solid\": %.6f, \"z\": %.4f, \"h\": %.0f, "
                "\"rattlers\": %.5f, \"unbalanced\": %.3e, \"weber\": %.3e, \"steps\": %ld, \"cpu_s\": %.3f}",
                first ? "" : ",\n", row->kappa, row->mu, row->restitution, row->solid, row->z, row->h, row->rattlers,
                row->unbalanced, row->weber, row->steps, row->cpu);
}

static int isotropic_states(double share, double inertial, FILE *json)
{
    static const struct {
        double kappa, mu, restitution;
    } rows[] = {{100, 0.5, 0.3},  {1000, 0.5, 0.3},  {10000, 0.5, 0.3}, {100, 0.2, 0.3},
                {1000, 0.2, 0.3}, {10000, 0.2, 0.3}, {100, 0.1, 0.3},   {1000, 0.1, 0.3},
                {100, 0, 0.3},    {1000, 0, 0.3},    {100, 0.5, 0.9},   {1000, 0.5, 0.9}};
    printf("%.0f discs, mu = 0.5, inertial number %g; mu_c and e: friction and restitution during the compression.\n"
           "Thesis, Table 3.1: solid 0.848 / 0.828 / 0.825, z 3.78 / 2.81 / 2.56, h 1601 / 409 / 196,\n"
           "rattlers 4.2 / 15.5 / 19.7 %% at kappa 100 / 1000 / 10000.\n\n",
           1850 * share, inertial);
    printf(
        "  kappa  mu_c     e |  solid     z      h  rattlers | contacts    slip  unbalanced    Weber |    steps   CPU "
        "s\n");
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        struct row row = {.kappa = rows[k].kappa, .mu = rows[k].mu, .restitution = rows[k].restitution};
        if (measure(&row, share, inertial) < 0)
            return -1;
        print_row(&row, json, k == 0);
    }
    return 0;
}

/* A triangular lattice of unequal discs, pressed together, in a box that holds it. */
static int lattice(struct dem *dem, size_t columns, size_t rows)
{
    const double radius = 0.005, pitch = 1.98 * radius, rise = pitch * 0.8660254037844386;
    if (dem_alloc(dem, columns * rows))
        return -1;
    dem->law = (struct contact_law){.row = &linear_law, .kn = 1e7, .kt_over_kn = 1, .mu = 0.5};
    dem->mu = dem->mu_wall = 0.5;
    dem->damping_ratio = 0; /* LAMMPS lets its dashpots pull, we do not: without them the two must agree */
    dem->skin = 0.4 * radius;
    for (size_t k = 0; k < dem->count; k++) {
        struct dem_grain *g = &dem->grains[k];
        size_t row = k / columns;
        g->radius = radius * (1 - 0.02 * random_uniform(7, k));
        g->mass = 44 * 3.141592653589793 * g->radius * g->radius;
        g->inertia = 0.5 * g->mass * g->radius * g->radius;
        g->x = pitch * ((double)(k % columns) + 0.5 + 0.5 * (double)(row & 1));
        g->y = radius + rise * (double)row;
    }
    dem->box.given = 1;
    dem->box.size[BOX_WIDTH] = pitch * ((double)columns + 0.5);
    dem->box.size[BOX_HEIGHT] = 2 * radius + rise * (double)(rows - 1);
    return 0;
}

/* CPU seconds of `steps` time steps, pairs found before; the kinetic energy (translation) at the end. */
static int time_steps(struct dem *dem, double dt, long steps, double *cpu, double *kinetic)
{
    struct servo held = {0};
    struct stepping stepping = {.dt = dt};
    int status = dem_step(dem, &held, &stepping);
    clock_t begin = clock();
    for (long k = 1; k < steps && !status; k++)
        status = dem_step(dem, &held, &stepping);
    *cpu = (double)(clock() - begin) / CLOCKS_PER_SEC;
    *kinetic = 0;
    for (size_t k = 0; k < dem->count; k++)
        *kinetic += 0.5 * dem->grains[k].mass * (pow(dem->grains[k].vx, 2) + pow(dem->grains[k].vy, 2));
    return status;
}

/* The same lattice, forces and time step for LAMMPS: hooke/history, discs, the same skin. */
static int lammps_write(const struct dem *dem, double dt, long steps, const char *folder)
{
    char path[300];
    snprintf(path, sizeof path, "%s/data", folder);
    FILE *data = fopen(path, "w");
    snprintf(path, sizeof path, "%s/input", folder);
    FILE *input = fopen(path, "w");
    if (!data || !input)
        return error_failed("%s: cannot be written", path);
    double width = dem->box.size[BOX_WIDTH], height = dem->box.size[BOX_HEIGHT], mass = dem->grains[0].mass;
    fprintf(data, "discs\n\n%zu atoms\n1 atom types\n-0.1 %g xlo xhi\n-0.1 %g ylo yhi\n-0.5 0.5 zlo zhi\n\n",
            dem->count, width + 0.1, height + 0.1);
    fprintf(data, "Atoms # sphere\n\n");
    for (size_t k = 0; k < dem->count; k++) {
        const struct dem_grain *g = &dem->grains[k]; /* LAMMPS makes the mass of a sphere from the density */
        fprintf(data, "%zu 1 %.17g %.17g %.17g %.17g 0\n", k + 1, 2 * g->radius,
                g->mass / (4.0 / 3 * 3.141592653589793 * pow(g->radius, 3)), g->x, g->y);
    }
    double kn = dem->law.kn, damping = 2 * dem->damping_ratio * sqrt(kn / (0.5 * mass));
    char law[200];
    snprintf(law, sizeof law, "%g %g %g 0 %g 0", kn, kn * dem->law.kt_over_kn, damping, dem->mu);
    fprintf(
        input,
        "units si\ndimension 2\nboundary f f p\natom_style sphere\nnewton off\ncomm_modify vel yes\n"
        "read_data %s/data\nneighbor %g bin\npair_style gran/hooke/history %s\npair_coeff * *\n"
        "fix 1 all nve/sphere disc\nfix 2 all enforce2d\n"
        "fix 3 all wall/gran hooke/history %s xplane 0 %.17g\nfix 4 all wall/gran hooke/history %s yplane 0 %.17g\n"
        "timestep %.17g\nthermo %ld\nthermo_style custom step ke\nthermo_modify norm no lost ignore\nrun ${steps}\n",
        folder, dem->skin, law, law, width, law, height, dt, steps);
    return fclose(data) | fclose(input) ? error_failed("%s: cannot be written", folder) : 0;
}

static double cpu_of_children(void)
{
    struct rusage usage;
    getrusage(RUSAGE_CHILDREN, &usage);
    return (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
           1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

/* CPU seconds of a run of LAMMPS; the kinetic energy that it prints last. */
static double lammps_run(const char *folder, long steps, double *kinetic)
{
    char command[800], line[300];
    snprintf(command, sizeof command, "cd %s && OMP_NUM_THREADS=1 lmp -var steps %ld -in input -log none 2>&1", folder,
             steps);
    double before = cpu_of_children();
    FILE *output = popen(command, "r");
    while (output && fgets(line, sizeof line, output)) {
        long step;
        double energy;
        if (sscanf(line, "%ld %lf", &step, &energy) == 2 && step == steps)
            *kinetic = energy;
    }
    if (!output || pclose(output))
        return NAN;
    return cpu_of_children() - before;
}

static int beside_lammps(struct dem *dem, double dt, long steps)
{
    char folder[] = "lammps_XXXXXX", command[100];
    double kinetic = NAN, none;
    char *whole = mkdtemp(folder) ? realpath(folder, NULL) : NULL;
    if (!whole)
        return error_failed("%s: cannot be made: run in a folder that can be written", folder);
    if (lammps_write(dem, dt, steps, whole)) {
        free(whole);
        return -1;
    }
    double setup = lammps_run(whole, 0, &none), all = lammps_run(whole, steps, &kinetic);
    if (isfinite(all))
        printf("%8s LAMMPS gran/hooke/history:        %6.1f ns CPU per disc and step, kinetic energy %.6g J\n", "",
               1e9 * (all - setup) / ((double)steps * (double)dem->count), kinetic);
    else
        printf("%8s LAMMPS (lmp) is not installed, or does not run this\n", "");
    free(whole);
    snprintf(command, sizeof command, "rm -r %s", folder);
    return system(command) ? error_failed("%s: cannot be removed", folder) : 0;
}

static int scale(size_t columns, size_t rows, long steps, FILE *json, int first)
{
    struct dem dem;
    double cpu, kinetic;
    if (lattice(&dem, columns, rows))
        return -1;
    double dt = 0.1 * dem_time_unit(&dem, dem.law.kn);
    int status = beside_lammps(&dem, dt, steps);
    if (!status)
        status = time_steps(&dem, dt, steps, &cpu, &kinetic);
    if (!status) {
        size_t touching = 0;
        for (size_t p = 0; p < dem.pair_count; p++)
            touching += (size_t)dem.pairs[p].touching;
        double each = 1e9 * cpu / ((double)steps * (double)dem.count);
        printf(
            "%8zu discs, %4.2f contacts per disc, %2d threads: %6.1f ns CPU per disc and step, kinetic energy %.6g J\n",
            dem.count, (double)touching / (double)dem.count, dem.count < dem.parallel_from ? 1 : omp_get_max_threads(),
            each, kinetic);
        if (json)
            fprintf(json, "%s{\"discs\": %zu, \"contacts\": %zu, \"ns_per_disc_and_step\": %.2f}", first ? "" : ",\n",
                    dem.count, touching, each);
    }
    dem_free(&dem);
    return status;
}

static int scaling(FILE *json)
{
    return scale(32, 32, 1000, json, 1) || scale(100, 100, 200, json, 0) || scale(316, 317, 40, json, 0) ? -1 : 0;
}

/* bench_simulate [--scaling (beside LAMMPS, where `lmp` is installed) | SHARE [INERTIAL]] [--json FILE]; SHARE: of the
 * 1850 discs. */
int main(int argc, char **argv)
{
    double number[2] = {1, 1e-3};
    int only_scaling = 0, numbers = 0;
    FILE *json = NULL;
    for (int k = 1; k < argc; k++)
        if (!strcmp(argv[k], "--json") && k + 1 < argc)
            json = fopen(argv[++k], "w");
        else if (!strcmp(argv[k], "--scaling"))
            only_scaling = 1;
        else if (numbers < 2)
            number[numbers++] = atof(argv[k]);
    if (json)
        fputs("[", json);
    int status = only_scaling ? scaling(json) : isotropic_states(number[0], number[1], json);
    if (json) {
        fputs("]\n", json);
        fclose(json);
    }
    if (status)
        fprintf(stderr, "bench_simulate: %s\n", error_message());
    return status ? error_status() : 0;
}
