/* calibration laws: contact laws compared on one small-strain probe (Tolomeo and McDowell 2022).
 *
 * Each law consolidates the same loose packing and is probed by itself (laws.h). The linear law has no parameter that
 * the others share: it gets the mean contact stiffness that Hertz's law has at the pressure, so that both start alike.
 *
 * Out: film.laws/1: per law and step the tangent modulus, the deviator, and how many contacts load, unload, reload. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "calibration/commands/law_chart.h"
#include "calibration/commands/calibration_commands.h"
#include "calibration/rods/laws.h"
#include "pipeline/command/cli.h"
#include "pipeline/speak/error.h"
#include "simulation/dem/simulate_scene.h"

enum { LAW_COUNT = 5 };

struct options {
    struct cli cli;
    const char *picture;
    struct law_probe probe;
};

static const struct {
    const char *name;
    enum contact_law_kind kind;
} laws[LAW_COUNT] = {{"hertz_pfc", LAW_HERTZ_PFC},
                     {"hertz_mindlin", LAW_HERTZ_MINDLIN},
                     {"pohrt_popov", LAW_POHRT_POPOV},
                     {"pohrt_popov_plastic", LAW_POHRT_POPOV_PLASTIC},
                     {"linear", LAW_LINEAR}};

static const char documentation[] =
    "Contact laws compared on one small-strain biaxial probe of the scene's packing (Tolomeo and McDowell 2022): how "
    "the modulus falls with the strain, and which contacts load, unload, reload, and how they lie.\v"
    "The scene's contact is pohrt_popov_plastic (or pohrt_popov), whose young_Pa, poisson, fractal_dimension and "
    "roughness_m serve all laws; the linear one gets the mean stiffness of Hertz's contacts at the pressure. Its "
    "simulation gives grading, pressure_Pa and friction_during_compression.\n\n"
    "Example: calibration laws --scene scene.json --picture laws.svg -o laws.json";

#define AT(field) .at = offsetof(struct options, field)
static const struct option_row rows[] = {
    {"picture", NULL, OPTION_OUTPUT, AT(picture), "P.svg", .help = "Curves as a picture"},
    {"first", NULL, OPTION_NUMBER, AT(probe.first), "EPS", .min = 1e-12, .max = 0.01,
     .help = "Strain of the first step"},
    {"last", NULL, OPTION_NUMBER, AT(probe.last), "EPS", .min = 1e-12, .max = 0.1, .help = "Largest strain"},
    {0}};

/* Stresses over the rods' length are Pa; angles in degrees from the horizontal. E0: of the first step. */
static cJSON *describe_curve(const char *name, const struct law_curve *curve, double length)
{
    cJSON *object = cJSON_CreateObject(), *steps = cJSON_CreateArray();
    cJSON_AddStringToObject(object, "law", name);
    calibration_add(object, "E0_Pa", curve->steps[0].young / length);
    calibration_add(object, "porosity", curve->fabric.porosity);
    calibration_add(object, "z", curve->fabric.z);
    calibration_add(object, "mean_contact_stiffness_N_per_m", curve->mean_stiffness);
    calibration_add(object, "mean_force_over_largest", curve->mobilised);
    for (size_t k = 0; k < curve->count; k++) {
        const struct law_step *step = &curve->steps[k];
        cJSON *item = cJSON_CreateObject();
        calibration_add(item, "strain", step->strain);
        calibration_add(item, "E_Pa", step->young / length);
        calibration_add(item, "deviator_Pa", step->deviator / length);
        for (int g = 0; g < GROUPS; g++) {
            char key[48];
            calibration_add(item, GROUP_NAMES[g], (double)step->count[g]);
            snprintf(key, sizeof key, "angle_%s_deg", GROUP_NAMES[g]);
            calibration_add(item, key, step->angle[g] * 57.29577951308232);
        }
        cJSON_AddBoolToObject(item, "rested", step->rested);
        cJSON_AddItemToArray(steps, item);
    }
    cJSON_AddItemToObject(object, "steps", steps);
    return object;
}

/* Four panels: E over strain, deviator, contacts of the plastic law by group, their directions. */
static int draw(const char *path, const struct law_curve curves[LAW_COUNT], double length)
{
    size_t n = curves[0].count, up = curves[0].loading;
    double *block = malloc((LAW_COUNT * 3 + 2 * GROUPS) * n * sizeof *block), *next = block;
    struct chart_curve moduli[LAW_COUNT], deviators[LAW_COUNT], counts[GROUPS], angles[GROUPS];
    if (!block)
        return error_memory("picture");
    for (int l = 0; l < LAW_COUNT; l++) {
        double *x = next, *y = x + n, *q = y + n;
        next = q + n;
        for (size_t k = 0; k < n; k++) {
            x[k] = curves[l].steps[k].strain;
            y[k] = 1e-6 * curves[l].steps[k].young / length;
            q[k] = 1e-3 * curves[l].steps[k].deviator / length;
        }
        moduli[l] = (struct chart_curve){laws[l].name, x, y, up, CHART_LINE};
        deviators[l] = (struct chart_curve){laws[l].name, x, q, n, CHART_LINE};
    }
    const struct law_curve *plastic = &curves[3];
    for (int g = 0; g < GROUPS; g++) {
        double *count = next, *angle = count + n;
        next = angle + n;
        for (size_t k = 0; k < n; k++) {
            count[k] = (double)plastic->steps[k].count[g];
            angle[k] = plastic->steps[k].angle[g] * 57.29577951308232;
        }
        counts[g] = (struct chart_curve){GROUP_NAMES[g], moduli[3].x, count, up, CHART_LINE};
        angles[g] = (struct chart_curve){GROUP_NAMES[g], moduli[3].x, angle, up, CHART_LINE};
    }
    struct chart_panel panels[] = {
        {"Tangent modulus", "axial strain", "E, MPa", 1, 0, moduli, LAW_COUNT},
        {"Loading and unloading", "axial strain", "q, kPa", 0, 0, deviators, LAW_COUNT},
        {"Contacts, pohrt_popov_plastic", "axial strain", "contacts", 1, 0, counts, GROUPS},
        {"Their direction from the horizontal", "axial strain", "degrees", 1, 0, angles, GROUPS}};
    int status = chart_write(path, panels, 4);
    free(block);
    return status;
}

/* All laws on one packing; the linear one as stiff as Hertz's contacts are on average. */
static int compare(const struct options *options, const struct simulation *simulation, struct law_curve *curves)
{
    double stiffness = 0;
    for (int l = 0; l < LAW_COUNT; l++) {
        struct contact_law law = simulation->law;
        law.kind = laws[l].kind;
        if (law.kind == LAW_LINEAR)
            law.kn = stiffness;
        if (law_compare(simulation, &law, &options->probe, &curves[l]))
            return error_context("%s", laws[l].name);
        if (l == 0)
            stiffness = curves[l].mean_stiffness;
    }
    return 0;
}

/* film.laws/1: one curve per law; states that still move are counted over all laws. */
static int write_all(const struct options *options, const struct law_curve *curves, double length)
{
    cJSON *object = cJSON_CreateObject(), *list = cJSON_CreateArray();
    size_t moving = 0, steps = 0;
    cJSON_AddStringToObject(object, "schema", "film.laws/1");
    for (int l = 0; l < LAW_COUNT; l++) {
        cJSON_AddItemToArray(list, describe_curve(laws[l].name, &curves[l], length));
        for (size_t k = 0; k < curves[l].count; k++, steps++)
            moving += !curves[l].steps[k].rested;
    }
    cJSON_AddItemToObject(object, "laws", list);
    int status = calibration_write(options->cli.output, object);
    if (!status && options->picture)
        status = draw(options->picture, curves, length);
    return status ? status : cli_flagged(&options->cli, moving, steps, "states did not come to rest");
}

/* Checks first what the comparison needs of the scene: roughness, grading, pressure. */
static int run(const struct options *options)
{
    struct scene scene = {0};
    struct simulation_plan plan = {0};
    struct law_curve curves[LAW_COUNT] = {{.count = 0}};
    int status = scene_read(options->cli.scene, &scene);
    if (!status)
        status = simulation_read(&scene, &plan);
    if (!status && isnan(plan.simulation.law.fractal))
        status = error_input("%s: contact.law: the comparison needs the roughness: make it pohrt_popov_plastic",
                             options->cli.scene);
    if (!status && (!plan.simulation.grade_count || !(plan.simulation.pressure > 0)))
        status = error_input("%s: simulation: the comparison needs a grading and pressure_Pa", options->cli.scene);
    if (!status)
        status = compare(options, &plan.simulation, curves);
    if (!status)
        status = write_all(options, curves, isnan(plan.simulation.length) ? 1 : plan.simulation.length);
    for (int l = 0; l < LAW_COUNT; l++)
        law_curve_free(&curves[l]);
    simulation_plan_free(&plan);
    scene_free(&scene);
    return status;
}

int command_laws(int argc, char **argv)
{
    struct options options = {.cli = CLI_DEFAULT, .probe = LAW_PROBE_DEFAULT};
    const struct program program = {NULL, documentation, rows, &options, NULL, 0, 0, NULL, NULL};
    cli_parse(&program, argc, argv);
    return cli_finish(&options.cli, run(&options));
}
