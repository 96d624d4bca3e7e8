/* Two scripts for LAMMPS, kept in a temporary folder with what they write. The program is told its numbers by letters:
 *     E V grains' Young's modulus (Pa) and Poisson's ratio   M F friction of the compression and of the probe
 *     P pressure (Pa)     K assumed bulk modulus (Pa)        D time constant of the barostat (s)
 *     L edge of the box   W largest diameter (m)             T U time steps (s): of Hertz, of the soft repulsion
 *     G R drags (kg/s)    O soft repulsion's largest push    Q strain of the probe
 *     A B C time steps of resting, straining, compressing
 * Results come back in the line RESULT of the output. */
#include "calibration/hertz/lammps_probes.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "calibration/hertz/hertz.h"
#include "pipeline/command/cli.h"
#include "pipeline/speak/error.h"

extern char **environ;
enum { MOST_ARGUMENTS = 64 };

/* Spheres thrown at random at half the volume, pushed apart, then compressed isotropically; the part that names the
 * grains is written in between. */
static const char PACK_BEGIN[] = "units si\ndimension 3\natom_style sphere\nboundary p p p\nnewton off\n"
                                 "comm_modify vel yes\nregion box block 0 $L 0 $L 0 $L\ncreate_box 1 box\n";
static const char PACK_END[] =
    "pair_style soft $W\npair_coeff 1 1 1e3 $W\nvariable push equal ramp($O*1e-4,$O)\n"
    "fix adapt all adapt 1 pair soft a * * v_push\nneighbor $(0.1*v_W) bin\nneigh_modify delay 0 every 1 check yes\n"
    "fix move all nve/limit $(0.025*v_W)\nfix drag all viscous $R\ntimestep $U\nrun 2000\nunfix adapt\nunfix move\n"
    "unfix drag\nvelocity all set 0 0 0\npair_style granular\n"
    "pair_coeff * * hertz/material $E 0 $V tangential mindlin NULL 0.5 $M damping mass_velocity\n"
    "compute stress all pressure NULL virial\ncompute number all contact/atom\ncompute mean all reduce ave c_number\n"
    "fix move all nve/sphere\nfix drag all viscous $G\nfix squeeze all press/berendsen iso $P $P $D modulus $K\n"
    "fix_modify squeeze press stress\nthermo_style custom step c_stress[1] c_stress[3] lx ke c_mean\nthermo 5000\n"
    "timestep $T\nrun $C\nunfix squeeze\nfix squeeze all press/berendsen iso $P $P $D modulus $(10*v_K)\n"
    "fix_modify squeeze press stress\nrun $A\nprint \"RESULT $(vol:%.15g) $(c_mean:%.15g)\"\n"
    "write_restart packed.restart\n";
static const char PROBE[] =
    "read_restart packed.restart\nneighbor $(0.1*v_W) bin\nneigh_modify delay 0 every 1 check yes\n"
    "pair_style granular\npair_coeff * * hertz/material $E 0 $V tangential mindlin NULL 0.5 $M damping mass_velocity\n"
    "compute stress all pressure NULL virial\ncompute number all contact/atom\ncompute mean all reduce ave c_number\n"
    "fix move all nve/sphere\nfix drag all viscous $G\nfix squeeze all press/berendsen iso $P $P $D modulus $(10*v_K)\n"
    "fix_modify squeeze press stress\nthermo_style custom step c_stress[1] c_stress[2] c_stress[3] lx lz ke c_mean\n"
    "thermo 5000\ntimestep $T\nrun $A\nunfix squeeze\n"
    "pair_coeff * * hertz/material $E 0 $V tangential mindlin NULL 0.5 $F damping mass_velocity\nrun $A\n"
    "variable x equal $(c_stress[1])\nvariable y equal $(c_stress[2])\nvariable z equal $(c_stress[3])\n"
    "variable l equal $(lz)\nfix pull all deform 1 z scale $(1-v_Q) remap x\nrun $B\nunfix pull\nrun $A\n"
    "print \"RESULT $(c_stress[1]-v_x:%.15g) $(c_stress[2]-v_y:%.15g) $(c_stress[3]-v_z:%.15g) $(1-lz/v_l:%.15g) "
    "$(vol:%.15g) $(c_mean:%.15g) $(step)\"\n";

static int write_file(const struct lammps_probes *probes, const char *name, const char *begin, const char *middle,
                      const char *end)
{
    char path[256];
    snprintf(path, sizeof path, "%s/%s", probes->folder, name);
    FILE *file = fopen(path, "w");
    int failed = !file || fprintf(file, "%s%s%s", begin, middle, end) < 0;
    if (file)
        failed |= fclose(file) != 0;
    return failed ? error_failed("%s: %s: is the disk full?", path, strerror(errno)) : 0;
}

/* Run `lmp ARGUMENTS` inside the folder, its output in the file `output`. */
static int run(const char *folder, const char *output, char *const arguments[])
{
    posix_spawn_file_actions_t actions;
    pid_t child;
    int status = 0;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addchdir_np(&actions, folder);
    posix_spawn_file_actions_addopen(&actions, 1, output, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    posix_spawn_file_actions_adddup2(&actions, 1, 2);
    int failed = posix_spawnp(&child, "lmp", &actions, NULL, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    if (failed)
        return error_input("LAMMPS does not start (lmp: %s): install the package lammps", strerror(failed));
    while (waitpid(child, &status, 0) < 0 && errno == EINTR)
        ;
    return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? 0 : 1;
}

int lammps_is_installed(void)
{
    char *const arguments[] = {"lmp", "-h", NULL};
    return run("/", "/dev/null", arguments) == 0;
}

/* The numbers after RESULT; the last ERROR line otherwise. */
static int read_result(const char *folder, const char *output, double *numbers, int count)
{
    char path[256], line[1024], why[200] = "no result";
    int found = 0;
    snprintf(path, sizeof path, "%s/%s", folder, output);
    FILE *file = fopen(path, "r");
    while (file && fgets(line, sizeof line, file)) {
        char *at = line + 6;
        if (!strncmp(line, "ERROR", 5))
            snprintf(why, sizeof why, "%.*s", (int)strcspn(line, "\n"), line);
        if (strncmp(line, "RESULT", 6))
            continue;
        for (found = 0; found < count; found++) {
            char *end;
            numbers[found] = strtod(at, &end);
            if (end == at)
                break;
            at = end;
        }
    }
    if (file)
        fclose(file);
    return found == count ? 0 : error_failed("LAMMPS: %s: see its manual, or take another packing", why);
}

/* -var NAME VALUE for each pair of a letter and a number. */
struct variables {
    char text[2 * MOST_ARGUMENTS][40];
    char *arguments[MOST_ARGUMENTS];
    int count, texts;
};

static void add(struct variables *v, const char *word)
{
    snprintf(v->text[v->texts], sizeof v->text[0], "%s", word);
    v->arguments[v->count++] = v->text[v->texts++];
    v->arguments[v->count] = NULL;
}

static void set(struct variables *v, const char *name, double value)
{
    char number[40];
    snprintf(number, sizeof number, "%.15g", value);
    add(v, "-var");
    add(v, name);
    add(v, number);
}

/* Scales of a packing of such grains: contact stiffness at the pressure, mass, diameters. */
static double largest_diameter(const struct simulation *simulation)
{
    double most = 0;
    for (size_t g = 0; g < simulation->grade_count; g++)
        most = fmax(most, simulation->grading[g].diameter);
    return most;
}

static double volume_of(const struct simulation *simulation)
{
    double volume = 0;
    for (size_t g = 0; g < simulation->grade_count; g++)
        volume += (double)simulation->grading[g].count * M_PI / 6 * pow(simulation->grading[g].diameter, 3);
    return volume;
}

static long grains_of(const struct simulation *simulation)
{
    long count = 0;
    for (size_t g = 0; g < simulation->grade_count; g++)
        count += simulation->grading[g].count;
    return count;
}

/* What both scripts share, for grains with E*, nu*; returns time steps per d sqrt(density / pressure). Time steps are a
 * share of sqrt(m/k) at the pressure. */
static double common(const struct lammps_probes *probes, const char *script, double young, double poisson,
                     struct variables *v)
{
    const struct simulation *s = probes->simulation;
    double d = largest_diameter(s), mean = cbrt(volume_of(s) / (double)grains_of(s) * 6 / M_PI), least = d;
    for (size_t g = 0; g < s->grade_count; g++)
        least = fmin(least, s->grading[g].diameter);
    double light = s->density * M_PI / 6 * pow(least, 3), mass = s->density * M_PI / 6 * pow(mean, 3), kn, ks;
    hertz_stiffness(0.5 * mean, young / (2 * (1 + poisson)), poisson, s->pressure * mean * mean, &kn, &ks);
    *v = (struct variables){.count = 0};
    const char *words[] = {"lmp", "-in", script, "-log", "none"};
    for (int w = 0; w < 5; w++)
        add(v, words[w]);
    double dt = 0.12 * sqrt(light / kn), unit = mean * sqrt(s->density / s->pressure);
    set(v, "E", young), set(v, "V", poisson), set(v, "M", s->law.mu), set(v, "P", s->pressure);
    set(v, "W", d), set(v, "T", dt), set(v, "G", 0.1 * sqrt(mass * kn));
    set(v, "D", 2 * unit), set(v, "K", 100 * s->pressure);
    set(v, "R", 0.3 * sqrt(mass * s->pressure * mean)), set(v, "O", s->pressure * mean * mean * 25);
    set(v, "U", 0.01 * unit);
    return unit / dt;
}

static void probe_variables(const struct lammps_probes *probes, double young, double poisson, struct variables *v)
{
    common(probes, "in.probe", young, poisson, v);
    set(v, "F", probes->mu), set(v, "Q", probes->strain), set(v, "A", 8000), set(v, "B", 2000);
}

static int pack(struct lammps_probes *probes, double young, double poisson)
{
    const struct simulation *s = probes->simulation;
    char grains[4096] = "";
    struct variables v;
    double numbers[2];
    long first = 1;
    size_t n = 0;
    for (size_t g = 0; g < s->grade_count && n < sizeof grains - 200; g++) {
        long last = first + s->grading[g].count - 1;
        n += (size_t)snprintf(grains + n, sizeof grains - n,
                              "create_atoms 1 random %ld %llu NULL\ngroup g%zu id %ld:%ld\n"
                              "set group g%zu diameter %.15g density %.15g\n",
                              s->grading[g].count, 1000 + ((unsigned long long)s->seed * 977 + g * 131) % 800000000, g,
                              first, last, g, s->grading[g].diameter, s->density);
        first = last + 1;
    }
    if (write_file(probes, "in.pack", PACK_BEGIN, grains, PACK_END) || write_file(probes, "in.probe", PROBE, "", ""))
        return -1;
    double steps = common(probes, "in.pack", young, poisson, &v);
    set(&v, "L", cbrt(volume_of(s) / 0.5)), set(&v, "A", ceil(20 * steps)), set(&v, "C", ceil(70 * steps));
    int status = run(probes->folder, "pack.out", v.arguments);
    if (status < 0 || read_result(probes->folder, "pack.out", numbers, 2))
        return -1;
    probes->young = young;
    probes->porosity = 1 - volume_of(s) / numbers[0];
    probes->z = numbers[1];
    probes->volume_per_contact = numbers[0] / (0.5 * numbers[1] * (double)grains_of(s));
    return 0;
}

static double median_diameter(const struct simulation *s)
{
    long half = grains_of(s) / 2, passed = 0;
    for (size_t g = 0; g < s->grade_count; g++) /* gradings are listed from small to large */
        if ((passed += s->grading[g].count) > half)
            return s->grading[g].diameter;
    return largest_diameter(s);
}

/* E*, nu* of the closed forms, nu* kept inside its range. */
static int closed_start(const struct lammps_probes *probes, double volume_per_contact, const struct hertz_goal *goal,
                        double *young, double *poisson)
{
    struct hertz_packing packing = {HERTZ_3D, 0.5 * probes->d50, volume_per_contact, probes->simulation->pressure};
    double target = isnan(goal->grain_poisson) ? goal->poisson : hertz_poisson(HERTZ_3D, goal->grain_poisson);
    target = fmin(fmax(target, hertz_poisson(HERTZ_3D, 0.05)), hertz_poisson(HERTZ_3D, 0.45));
    return hertz_start(&packing, goal->young, target, young, poisson);
}

int lammps_probes_open(const struct simulation *simulation, double strain, double mu, const char *record_path,
                       struct hertz_goal *goal, struct lammps_probes *probes)
{
    char what[512];
    double young, poisson;
    *probes = (struct lammps_probes){.simulation = simulation, .strain = strain, .mu = mu};
    if (!(simulation->pressure > 0) || !simulation->grade_count)
        return error_input("a calibration needs a packing by its grading and a pressure: give both in 'simulation'");
    if (!lammps_is_installed())
        return error_input("probes of spheres need LAMMPS: install the package lammps");
    probes->d50 = median_diameter(simulation);
    const char *temporary = getenv("TMPDIR");
    temporary = temporary ? temporary : "/tmp";
    if (strlen(temporary) > 100)
        return error_input("%s: has more than 100 characters: set TMPDIR to a shorter path", temporary);
    snprintf(probes->folder, sizeof probes->folder, "%s/film_lammps_XXXXXX", temporary);
    if (!mkdtemp(probes->folder))
        return error_failed("%s: %s", probes->folder, strerror(errno));
    double guess = hertz_volume_per_contact(HERTZ_3D, 0.5 * probes->d50, 0.38, 5);
    int status =
        closed_start(probes, guess, goal, &young, &poisson) || pack(probes, young, poisson) ||
                closed_start(probes, probes->volume_per_contact, goal, &goal->grain_young, &goal->grain_poisson)
            ? -1
            : 0;
    snprintf(what, sizeof what,
             "{\"schema\":\"film.probes/1\",\"engine\":\"lammps\",\"grains\":%ld,\"d50\":%.17g,\"seed\":%llu,"
             "\"pressure\":%.17g,\"mu\":[%.17g,%.17g],\"strain\":%.17g,\"base\":%.17g,\"porosity\":%.9g}",
             grains_of(simulation), probes->d50, (unsigned long long)simulation->seed, simulation->pressure,
             simulation->law.mu, mu, strain, young, probes->porosity);
    if (!status)
        status = probe_record_open(record_path, what, &probes->record);
    if (status)
        lammps_probes_close(probes);
    return status;
}

void lammps_probes_close(struct lammps_probes *probes)
{
    static const char *const names[] = {"in.pack", "in.probe", "packed.restart", "pack.out"};
    char path[256];
    for (int k = 0; k < 4 + PROBES_AT_ONCE && *probes->folder; k++) {
        if (k < 4)
            snprintf(path, sizeof path, "%s/%s", probes->folder, names[k]);
        else
            snprintf(path, sizeof path, "%s/probe%d.out", probes->folder, k - 4);
        unlink(path);
    }
    if (*probes->folder)
        rmdir(probes->folder);
    probe_record_close(&probes->record);
    memset(probes, 0, sizeof *probes);
}

static int probe_once(const void *user, const struct hertz_trial *trial, size_t k, struct probe_row *row)
{
    const struct lammps_probes *probes = user;
    struct variables v;
    char output[32];
    double n[7];
    snprintf(output, sizeof output, "probe%zu.out", k);
    probe_variables(probes, trial->grain_young, trial->grain_poisson, &v);
    if (run(probes->folder, output, v.arguments) < 0 || read_result(probes->folder, output, n, 7))
        return -1;
    double share = 0.5 * (n[0] + n[1]) / n[2], nu = share / (1 + share);
    *row = (struct probe_row){.grain_young = trial->grain_young,
                              .grain_poisson = trial->grain_poisson,
                              .young = n[2] / n[3] * (1 + nu) * (1 - 2 * nu) / (1 - nu),
                              .poisson = nu,
                              .porosity = 1 - volume_of(probes->simulation) / n[4],
                              .z = n[5],
                              .steps = (long)n[6],
                              .rested = 1};
    return row->young > 0 ? 0 : error_input("the probe found E = %g Pa: the packing carries nothing", row->young);
}

int lammps_probes_evaluate(struct hertz_trial *trials, size_t count, void *user)
{
    struct lammps_probes *probes = user;
    return probe_record_answer(&probes->record, probe_once, probes, trials, count);
}
