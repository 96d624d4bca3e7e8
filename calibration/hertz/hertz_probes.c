/* Warm probes start from copies of one consolidated packing, whose law is replaced: they differ by their grains alone,
 * not by the chance of a new packing, and cost a relaxation instead of a compression. Cold ones repeat the paper. */
#include "calibration/hertz/hertz_probes.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "calibration/hertz/hertz.h"
#include "pipeline/speak/version.h"
#include "pipeline/command/cli.h"
#include "pipeline/speak/error.h"

static struct contact_law law_of(const struct simulation *simulation, double young, double poisson)
{
    struct contact_law law = simulation->law;
    contact_law_set_grains(&law, young, poisson);
    return law;
}

/* Everything that decides what a probe answers. */
static void describe(const struct hertz_probes *probes, double base_young, double base_poisson, char *text, size_t size)
{
    const struct simulation *s = probes->simulation;
    int n =
        snprintf(text, size,
                 "{\"schema\":\"film.probes/1\",\"version\":\"%s\",\"cold\":%d,\"seed\":%llu,\"pressure\":%.17g,"
                 "\"preparation_mu\":%.17g,\"inertial\":%.17g,\"tolerance\":%.17g,\"restitution\":%.17g,"
                 "\"aspect\":%.17g,\"time_step\":%.17g,\"density\":%.17g,\"law\":\"%s\",\"strain\":%.17g,\"mu\":%.17g,"
                 "\"base\":[%.17g,%.17g],\"grading\":[",
                 film_version, probes->cold, (unsigned long long)s->seed, s->pressure, s->law.mu, s->inertial,
                 s->tolerance, s->restitution, s->aspect, s->time_step, s->density, contact_law_row(&s->law)->name,
                 probes->probe.strain, probes->probe.mu, base_young, base_poisson);
    for (size_t g = 0; g < s->grade_count && (size_t)n < size; g++)
        n += snprintf(text + n, size - (size_t)n, "%s[%ld,%.17g]", g ? "," : "", s->grading[g].count,
                      s->grading[g].diameter);
    if ((size_t)n < size)
        snprintf(text + n, size - (size_t)n, "]}");
}

/* E*, nu* of the closed forms for the fabric that is there. */
static int closed_start(const struct hertz_goal *goal, double pressure, const struct probe_fabric *fabric,
                        double *young, double *poisson)
{
    struct hertz_packing packing = {HERTZ_2D, 0.5 * fabric->d50, fabric->volume_per_contact, pressure};
    double target = isnan(goal->grain_poisson) ? goal->poisson : hertz_poisson(HERTZ_2D, goal->grain_poisson);
    /* The closed form's nu* may lie outside its range where the packing's own answer does not: begin inside. */
    target = fmin(fmax(target, hertz_poisson(HERTZ_2D, 0.05)), hertz_poisson(HERTZ_2D, 0.45));
    return hertz_start(&packing, goal->young, target, young, poisson);
}

int hertz_probes_open(const struct simulation *simulation, const struct probe_options *probe, int cold,
                      const char *record_path, struct hertz_goal *goal, struct hertz_probes *probes)
{
    char what[4096];
    struct probe_fabric guess = {.porosity = 0.19, .z = 3.6};
    double young, poisson, radius = 0;
    memset(probes, 0, sizeof *probes);
    probes->simulation = simulation;
    probes->probe = *probe;
    probes->cold = cold;
    for (size_t g = 0; g < simulation->grade_count; g++)
        radius = fmax(radius, 0.5 * simulation->grading[g].diameter);
    guess.d50 = 2 * radius;
    guess.volume_per_contact = hertz_volume_per_contact(HERTZ_2D, radius, guess.porosity, guess.z);
    if (!(simulation->pressure > 0) || !simulation->grade_count)
        return error_input("a calibration needs a packing by its grading and a pressure: give both in 'simulation'");
    if (closed_start(goal, simulation->pressure, &guess, &young, &poisson))
        return -1;
    struct simulation base = *simulation;
    base.law = law_of(simulation, young, poisson);
    if (probe_consolidate(&base, &probes->base))
        return -1;
    struct probe_fabric fabric;
    probe_fabric(&probes->base, &fabric);
    describe(probes, young, poisson, what, sizeof what);
    int status = closed_start(goal, simulation->pressure, &fabric, &goal->grain_young, &goal->grain_poisson);
    if (!status)
        status = probe_record_open(record_path, what, &probes->record);
    log_event("consolidated", "porosity", fabric.porosity, "z", fabric.z, "steps", (double)probes->base.loading.steps,
              "grain_young", goal->grain_young, "grain_poisson", goal->grain_poisson, NULL);
    if (status)
        hertz_probes_close(probes);
    return status;
}

void hertz_probes_close(struct hertz_probes *probes)
{
    probe_packing_free(&probes->base);
    probe_record_close(&probes->record);
}

/* One probe from the beginning. */
static int probe_once(const void *user, const struct hertz_trial *trial, size_t k, struct probe_row *row)
{
    const struct hertz_probes *probes = user;
    (void)k;
    struct contact_law law = law_of(probes->simulation, trial->grain_young, trial->grain_poisson);
    struct simulation anew = *probes->simulation;
    struct probe_packing packing;
    struct probe_result result;
    anew.law = law;
    if (probes->cold ? probe_consolidate(&anew, &packing) : probe_adapt(&probes->base, &law, &packing))
        return -1;
    int status = probe_run(&packing, &probes->probe, &result);
    probe_packing_free(&packing);
    *row = (struct probe_row){.grain_young = trial->grain_young,
                              .grain_poisson = trial->grain_poisson,
                              .young = result.young,
                              .poisson = result.poisson,
                              .porosity = result.fabric.porosity,
                              .z = result.fabric.z,
                              .steps = result.steps,
                              .rested = result.rested};
    return status;
}

int hertz_probes_evaluate(struct hertz_trial *trials, size_t count, void *user)
{
    struct hertz_probes *probes = user;
    return probe_record_answer(&probes->record, probe_once, probes, trials, count);
}
