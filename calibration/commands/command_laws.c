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

#include "calibration/commands/calibration_commands.h"
#include "calibration/rods/laws.h"
#include "pipeline/command/cli.h"
#include "pipeline/draw/chart.h"
#include "pipeline/speak/error.h"
#include "simulation/dem/simulate_scene.h"
#include "pipeline/files/json.h"

enum { LAWS = 5, PLASTIC = 3 };

struct options {
    struct cli cli;
    const char *picture;
    struct law_probe probe;
};

/* Those of Tolomeo and McDowell; the first one says how stiff the linear one is, number PLASTIC is drawn by groups. */
static const struct law *const laws[LAWS] = {&hertz_pfc_law, &hertz_mindlin_law, &pohrt_popov_law,
                                             &pohrt_popov_plastic_law, &linear_law};

static const char documentation[] =
    "Contact laws compared on one small-strain biaxial probe of the scene's packing (Tolomeo and McDowell 2022): how "
    "the modulus falls with the strain, and which contacts load, unload, reload, and how they lie.\v"
    "The scene's contact is pohrt_popov_plastic (or pohrt_popov), whose young_Pa, poisson, fractal_dimension and "
    "roughness_m serve all laws; the linear one gets the mean stiffness of Hertz's contacts at the pressure. Its "
    "simulation gives grading, pressure_Pa and friction_during_compression.\n\n"
    "Example: calibration laws --scene scene.json --picture laws.svg -o laws.json";

#define AT(field) .at = offsetof(struct options, field)
static const struct option_row rows[] = {
    {"picture", NULL, OPTION_OUTPUT, AT(picture), "FILE", .help = "Curves as a picture (.svg, .pdf, .png)"},
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

/* A law's curves: E and q over the strain, with the contacts of each group and their directions where charts are given
 * for them. E and the groups belong to the loading alone. */
static int add_law(const char *name, const struct law_curve *curve, double length, struct chart charts[4], int grouped)
{
    size_t n = curve->count, up = curve->loading;
    struct chart_line *young = chart_add(&charts[0], name, up),
                      *deviator = young ? chart_add(&charts[1], name, n) : NULL;
    if (!deviator)
        return -1;
    for (size_t k = 0; k < n; k++) {
        const struct law_step *step = &curve->steps[k];
        chart_put(deviator, step->strain, 1e-3 * step->deviator / length);
        if (k < up)
            chart_put(young, step->strain, 1e-6 * step->young / length);
    }
    for (int g = 0; g < GROUPS && grouped; g++) {
        struct chart_line *count = chart_add(&charts[2], GROUP_NAMES[g], up);
        struct chart_line *angle = count ? chart_add(&charts[3], GROUP_NAMES[g], up) : NULL;
        if (!angle)
            return -1;
        for (size_t k = 0; k < up; k++) {
            chart_put(count, curve->steps[k].strain, (double)curve->steps[k].count[g]);
            chart_put(angle, curve->steps[k].strain, curve->steps[k].angle[g] * 57.29577951308232);
        }
    }
    return 0;
}

/* Four charts: E over strain, deviator, contacts of the plastic law by group, their directions. */
static int draw(const char *path, const struct law_curve curves[LAWS], double length)
{
    static const char strain[] = "axial strain";
    struct chart charts[4] = {
        {.title = "Tangent modulus", .x_label = strain, .y_label = "E, MPa", .log_x = 1},
        {.title = "Loading and unloading", .x_label = strain, .y_label = "q, kPa"},
        {.title = "Contacts, pohrt_popov_plastic", .x_label = strain, .y_label = "contacts", .log_x = 1},
        {.title = "Their direction from the horizontal", .x_label = strain, .y_label = "degrees", .log_x = 1}};
    int status = 0;
    for (int l = 0; l < LAWS && !status; l++)
        status = add_law(laws[l]->name, &curves[l], length, charts, l == PLASTIC);
    if (!status)
        status = chart_write(path, charts, 4, CALIBRATION_CHART_WIDTH, CALIBRATION_CHART_HEIGHT);
    for (int k = 0; k < 4; k++)
        chart_free(&charts[k]);
    return status;
}

/* All laws on one packing; the linear one as stiff as Hertz's contacts are on average. */
static int compare(const struct options *options, const struct simulation *simulation, struct law_curve *curves)
{
    double stiffness = 0;
    for (int l = 0; l < LAWS; l++) {
        struct contact_law law = simulation->law;
        law.row = laws[l];
        if (law.row->linear)
            law.kn = stiffness;
        if (law_compare(simulation, &law, &options->probe, &curves[l]))
            return error_context("%s", laws[l]->name);
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
    for (int l = 0; l < LAWS; l++) {
        cJSON_AddItemToArray(list, describe_curve(laws[l]->name, &curves[l], length));
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
    struct law_curve curves[LAWS] = {{.count = 0}};
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
    for (int l = 0; l < LAWS; l++)
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
    return cli_finish(&options.cli, canvas_check_path(options.picture) ? -1 : run(&options));
}
