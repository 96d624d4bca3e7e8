/* Numbers and words are rows of one table; lists (grading, discs, steps), and what two keys tell together, are read and
 * checked by the functions before it. Everything is judged before the first time step: a simulation can take hours. */
#include "simulation/dem/simulate_scene.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/command/option_table.h"
#include "pipeline/speak/error.h"
#include "simulation/dem/loading.h"
#include "pipeline/files/json.h"

enum { MAX_GRAINS = 10000000, MAX_DISCS = 20000, MAX_STATES = 1000000 };

/* Rows [count, number] of the list `key`; 0 rows when it is absent. */
static int read_rows(const struct json *json, const cJSON *section, const char *key, double min, double max,
                     size_t *count, double (**rows)[2])
{
    const cJSON *list = NULL, *row;
    int there = json_array(json, section, key, &list);
    if (there <= 0)
        return there;
    size_t length = (size_t)cJSON_GetArraySize(list), k = 0;
    *rows = calloc(length + 1, sizeof **rows);
    if (!*rows)
        return error_memory(key);
    cJSON_ArrayForEach(row, list)
    {
        const cJSON *first = cJSON_GetArrayItem(row, 0), *second = cJSON_GetArrayItem(row, 1);
        if (!cJSON_IsArray(row) || cJSON_GetArraySize(row) != 2 || !cJSON_IsNumber(first) || !cJSON_IsNumber(second))
            return json_error(json, row, "'%s' lists pairs of numbers: write [[count, value], ...]", key);
        double number = first->valuedouble, value = second->valuedouble;
        if (number != floor(number) || number < 1 || number > MAX_GRAINS)
            return json_error(json, row, "a count of %g in '%s': give a whole number from 1 to %d", number, key,
                              MAX_GRAINS);
        if (!(value >= min && value <= max) || value == 0)
            return json_error(json, row, "%g in '%s': give a number from %g to %g, not 0", value, key, min, max);
        (*rows)[k][0] = number;
        (*rows)[k++][1] = value;
    }
    *count = k;
    return 1;
}

/* Rows [count, diameter in m]. */
static int read_grading(const struct scene *scene, const cJSON *section, struct simulation_plan *plan)
{
    double(*rows)[2] = NULL, total = 0;
    size_t count = 0;
    int there = read_rows(scene->json, section, "grading", 1e-6, 1e3, &count, &rows);
    if (there > 0 && !(plan->grading = calloc(count + 1, sizeof *plan->grading)))
        there = error_memory("grading");
    for (size_t k = 0; there > 0 && k < count; k++) {
        plan->grading[k] = (struct grade){(long)rows[k][0], rows[k][1]};
        total += rows[k][0];
    }
    if (there > 0 && total > MAX_GRAINS)
        there = json_error(scene->json, section, "%.0f grains: give %d or fewer", total, MAX_GRAINS);
    free(rows);
    plan->simulation.grading = plan->grading;
    plan->simulation.grade_count = count;
    return there < 0 ? -1 : 0;
}

/* One disc: {"x_m": 0, "y_m": 0, "radius_m": 0.01, "fixed": true, "load_N": [0, -10]}. */
static int read_disc(const struct json *json, const cJSON *item, struct placed_disc *disc)
{
    static const char *const keys[] = {"x_m", "y_m", "radius_m", "fixed", "load_N", "moment_N_m", NULL};
    double load[2] = {0};
    if (!cJSON_IsObject(item))
        return json_error(json, item, "a disc is an object: write {\"x_m\": 0, \"y_m\": 0, \"radius_m\": 0.01}");
    if (json_check_keys(json, item, keys))
        return -1;
    int x = json_number(json, item, "x_m", -1e6, 1e6, &disc->x);
    int y = x < 0 ? -1 : json_number(json, item, "y_m", -1e6, 1e6, &disc->y);
    int radius = y < 0 ? -1 : json_number(json, item, "radius_m", 1e-9, 1e6, &disc->radius);
    if (radius < 0 || json_boolean(json, item, "fixed", &disc->fixed) < 0 ||
        json_numbers(json, item, "load_N", 2, load) < 0 ||
        json_number(json, item, "moment_N_m", -1e12, 1e12, &disc->load_m) < 0)
        return -1;
    if (!x || !y || !radius)
        return json_error(json, item, "a disc needs x_m, y_m and radius_m");
    disc->load_x = load[0];
    disc->load_y = load[1];
    return 0;
}

/* Discs placed one by one, m; box_m puts walls around them. */
static int read_discs(const struct scene *scene, const cJSON *section, struct simulation_plan *plan)
{
    const cJSON *list = NULL, *item;
    int there = json_array(scene->json, section, "discs", &list);
    if (there <= 0)
        return there;
    if (cJSON_GetArraySize(list) > MAX_DISCS)
        return json_error(scene->json, list, "more than %d discs: use a grading", MAX_DISCS);
    plan->discs = calloc((size_t)cJSON_GetArraySize(list) + 1, sizeof *plan->discs);
    if (!plan->discs)
        return error_memory("discs");
    size_t count = 0;
    cJSON_ArrayForEach(item, list) if (read_disc(scene->json, item, &plan->discs[count++])) return -1;
    plan->simulation.discs = plan->discs;
    plan->simulation.disc_count = count;
    int box = json_numbers(scene->json, section, "box_m", 2, plan->simulation.box);
    if (box > 0 && !(plan->simulation.box[0] > 0 && plan->simulation.box[1] > 0))
        return json_error(scene->json, section, "'box_m' is [width, height]: give two positive numbers");
    return box < 0 ? -1 : 0;
}

/* Discs by their grading or one by one. */
static int read_grains(const struct scene *scene, const cJSON *section, struct simulation_plan *plan)
{
    if (read_grading(scene, section, plan) || read_discs(scene, section, plan))
        return -1;
    if (!plan->simulation.grade_count == !plan->simulation.disc_count)
        return json_error(scene->json, section,
                          "which grains? Write \"grading\": [[count, diameter_m], ...] or \"discs\" (one of them)");
    return 0;
}

/* Walls only push: stress steps may not take the stress to nothing. */
static int check_stresses(const struct scene *scene, const cJSON *section, const struct simulation *simulation)
{
    double stress = 1;
    for (size_t k = 0; k < simulation->step_count; k++) {
        stress += (double)simulation->steps[k].count * simulation->steps[k].amount;
        if (stress < SIMULATION_STRESS_MIN)
            return json_error(scene->json, cJSON_GetObjectItemCaseSensitive(section, "stress_steps"),
                              "row %zu takes the stress to %g of the pressure: stay above %g", k, stress,
                              SIMULATION_STRESS_MIN);
    }
    return 0;
}

/* Strains, stresses or cycles, as the test goes; a row is [count, amount]. */
static int read_steps(const struct scene *scene, const cJSON *section, struct simulation_plan *plan)
{
    struct simulation *simulation = &plan->simulation;
    double(*rows)[2] = NULL, total = 0;
    size_t count = 0;
    int stress = cJSON_GetObjectItemCaseSensitive(section, "stress_steps") != NULL;
    int cycles = simulation->test == TEST_CYCLIC, needs_stress = simulation->test == TEST_ISOTROPIC;
    const char *key = stress ? "stress_steps" : cycles ? "cycles" : "steps";
    int there = read_rows(scene->json, section, key, stress ? -100 : -0.5, stress || cycles ? 100 : 0.5, &count, &rows);
    if (there > 0 && !(plan->steps = calloc(count + 1, sizeof *plan->steps)))
        there = error_memory("steps");
    for (size_t k = 0; there > 0 && k < count; k++) {
        plan->steps[k] = (struct loading_steps){(long)rows[k][0], rows[k][1]};
        total += rows[k][0];
    }
    if (there > 0 && total > MAX_STATES)
        there = json_error(scene->json, section, "%.0f states: give %d or fewer", total, MAX_STATES);
    free(rows);
    simulation->steps = plan->steps;
    simulation->step_count = count;
    simulation->by_stress = stress;
    if (there > 0 && stress != needs_stress && !(stress && simulation->test == TEST_OEDOMETER))
        return json_error(scene->json, section, "test '%s' goes by \"%s\": rename '%s'",
                          LOADING_TEST_NAMES[simulation->test],
                          needs_stress ? "stress_steps"
                          : cycles     ? "cycles"
                                       : "steps",
                          key);
    if (there > 0 && stress && check_stresses(scene, section, simulation))
        return -1;
    if (there > 0 && isnan(simulation->kappa) && isnan(simulation->pressure))
        return json_error(scene->json, section, "a loading test starts from a pressure: give kappa or pressure_Pa");
    if (there > 0 && simulation->disc_count && isnan(simulation->box[0]))
        return json_error(scene->json, section, "a loading test needs walls: give box_m");
    return there < 0 ? -1 : 0;
}

/* kappa (linear law), or pressure_Pa with the rods' length; discs may also be held by gravity and loads alone. */
static int complete_pressure(const struct scene *scene, const cJSON *section, struct simulation *simulation)
{
    int kappa = !isnan(simulation->kappa), pascal = !isnan(simulation->pressure);
    if (kappa + pascal != 1 && (kappa || !simulation->disc_count))
        return json_error(scene->json, section,
                          "how strongly is the packing compressed? Write \"kappa\" or "
                          "\"pressure_Pa\" (one of them) in 'simulation'");
    if (kappa && !contact_law_row(&simulation->law)->linear)
        return json_error(scene->json, section, "kappa is kn / p and this law has no kn: write \"pressure_Pa\"");
    if (pascal && isnan(scene->grains.length))
        return scene_lacks(scene, "grains.length_m", "simulate needs it with pressure_Pa");
    if (pascal)
        simulation->pressure *= scene->grains.length;
    if (pascal && contact_law_row(&simulation->law)->linear && simulation->law.kn < simulation->pressure)
        return json_error(scene->json, section, "kappa = kn / p is %g: lower the pressure, discs would be crushed flat",
                          simulation->law.kn / simulation->pressure);
    return 0;
}

/* No default: half a swing of the stress is what the test is about. */
static int check_test(const struct scene *scene, const cJSON *section, const struct simulation *simulation)
{
    if (simulation->test == TEST_CYCLIC && !cJSON_GetObjectItemCaseSensitive(section, "stress_amplitude"))
        return json_error(scene->json, section, "test 'cyclic' needs \"stress_amplitude\" (over the pressure)");
    return 0;
}

/* What is left out is not modelled, but without these there is no motion. */
static int check_needs(const struct scene *scene, const cJSON *section)
{
    if (!section)
        return scene_lacks(scene, "simulation", "simulate needs to know what to simulate");
    if (!scene->contact_given || !contact_law_known(&scene->contact))
        return scene_lacks(scene, "contact.kn_N_per_m", "simulate needs it");
    if (isnan(scene->contact.mu))
        return scene_lacks(scene, "contact.mu", "simulate needs it");
    if (isnan(scene->grains.density))
        return scene_lacks(scene, "grains.density_kg_m3", "simulate needs it for the masses");
    return 0;
}

static const char *const rests[] = {"strain", "stress", NULL};
static const char *const laterals[] = {"pressure", "fixed", NULL};

#define AT(field) .at = offsetof(struct simulation, field)
/* pressure_Pa goes into `pressure` as it is; complete_pressure() makes it N/m, the unit of stresses in the plane. */
static const struct option_row rows[] = {
    {NULL, "seed", OPTION_LONG, AT(seed), .max = 0x1p53},
    {NULL, "max_steps", OPTION_LONG, AT(max_steps), .min = 1, .max = 1e9},
    {NULL, "aspect", OPTION_NUMBER, AT(aspect), .min = 0.05, .max = 20},
    {NULL, "kappa", OPTION_NUMBER, AT(kappa), .min = 1, .max = 1e9},
    {NULL, "pressure_Pa", OPTION_NUMBER, AT(pressure), .min = DBL_MIN, .max = 1e15},
    {NULL, "friction_during_compression", OPTION_NUMBER, AT(preparation_mu), .max = 10},
    {NULL, "restitution", OPTION_NUMBER, AT(restitution), .min = SIMULATION_RESTITUTION_MIN, .max = 1},
    {NULL, "inertial_number", OPTION_NUMBER, AT(inertial), .min = 1e-8, .max = 0.1},
    {NULL, "time_step", OPTION_NUMBER, AT(time_step), .min = 1e-4, .max = SIMULATION_TIME_STEP_MAX},
    {NULL, "tolerance", OPTION_NUMBER, AT(tolerance), .min = 1e-12, .max = 1e-6},
    {NULL, "corner_radius_m", OPTION_NUMBER, AT(corner_radius), .min = 1e-9, .max = 1e6},
    {NULL, "test", OPTION_CHOICE, AT(test), .words = LOADING_TEST_NAMES},
    {NULL, "relax_at", OPTION_CHOICE, AT(relax_at_stress), .words = rests},
    {NULL, "lateral", OPTION_CHOICE, AT(lateral_fixed), .words = laterals},
    {NULL, "stress_amplitude", OPTION_NUMBER, AT(amplitude), .max = 0.999},
    {NULL, "grading", .type = OPTION_ELSE},
    {NULL, "discs", .type = OPTION_ELSE},
    {NULL, "box_m", .type = OPTION_ELSE},
    {NULL, "steps", .type = OPTION_ELSE},
    {NULL, "stress_steps", .type = OPTION_ELSE},
    {NULL, "cycles", .type = OPTION_ELSE},
    {0}};

/* All keys of the section, then what several of them tell together. */
static int read_section(const struct scene *scene, const cJSON *section, struct simulation_plan *plan)
{
    struct simulation *simulation = &plan->simulation;
    if (options_read(rows, scene, "simulation", 0, simulation) || read_grains(scene, section, plan) ||
        complete_pressure(scene, section, simulation) || check_test(scene, section, simulation) ||
        read_steps(scene, section, plan))
        return -1;
    if (simulation->preparation_mu > simulation->law.mu)
        return json_error(scene->json, section, "friction_during_compression %g is above contact.mu %g: lower it",
                          simulation->preparation_mu, simulation->law.mu);
    return 0;
}

int simulation_read(const struct scene *scene, struct simulation_plan *plan)
{
    const cJSON *section = scene_section(scene, "simulation");
    memset(plan, 0, sizeof *plan);
    plan->simulation = (struct simulation)SIMULATION_DEFAULT;
    if (check_needs(scene, section))
        return -1;
    plan->simulation.law = scene->contact;
    plan->simulation.density = scene->grains.density;
    plan->simulation.length = scene->grains.length;
    plan->simulation.gravity = scene->gravity;
    if (read_section(scene, section, plan)) {
        simulation_plan_free(plan);
        return -1;
    }
    return 0;
}

void simulation_plan_free(struct simulation_plan *plan)
{
    free(plan->grading);
    free(plan->discs);
    free(plan->steps);
    memset(plan, 0, sizeof *plan);
}

char *simulation_parameters(const struct scene *scene)
{
    static const char *const keys[] = {"simulation", "contact", "grains", "gravity_m_per_s2"};
    const cJSON *root = json_root(scene->json);
    cJSON *parameters = cJSON_CreateObject();
    char *text = NULL;
    for (int k = 0; parameters && k < 4; k++) {
        const cJSON *item = cJSON_GetObjectItemCaseSensitive(root, keys[k]);
        if (item && !cJSON_AddItemReferenceToObject(parameters, keys[k], (cJSON *)item)) {
            cJSON_Delete(parameters);
            parameters = NULL;
        }
    }
    text = parameters ? json_print(parameters) : NULL;
    cJSON_Delete(parameters);
    if (!text)
        error_set(EXIT_FAILED, "out of memory: parameters: use a machine with more memory");
    return text;
}
