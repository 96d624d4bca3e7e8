#include "simulation/simulate_scene.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/error.h"

enum { MAX_GRAINS = 10000000, MAX_STATES = 1000000 };

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

static int read_grading(const struct scene *scene, const cJSON *section, struct simulation_plan *plan)
{
    double(*rows)[2] = NULL, total = 0;
    size_t count = 0;
    int there = read_rows(scene->json, section, "grading", 1e-6, 1e3, &count, &rows);
    if (there >= 0 && count == 0)
        there = json_error(scene->json, section,
                           "no grains: write \"grading\": [[count, diameter_m], ...] in 'simulation'");
    if (there > 0 && !(plan->grading = calloc(count, sizeof *plan->grading)))
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

static int read_steps(const struct scene *scene, const cJSON *section, struct simulation_plan *plan)
{
    double(*rows)[2] = NULL, total = 0;
    size_t count = 0;
    int there = read_rows(scene->json, section, "steps", -0.5, 0.5, &count, &rows);
    if (there > 0 && !(plan->steps = calloc(count + 1, sizeof *plan->steps)))
        there = error_memory("steps");
    for (size_t k = 0; there > 0 && k < count; k++) {
        plan->steps[k] = (struct strain_steps){(long)rows[k][0], rows[k][1]};
        total += rows[k][0];
    }
    if (there > 0 && total > MAX_STATES)
        there = json_error(scene->json, section, "%.0f states: give %d or fewer", total, MAX_STATES);
    free(rows);
    plan->simulation.steps = plan->steps;
    plan->simulation.step_count = count;
    return there < 0 ? -1 : 0;
}

/* kappa, or pressure_Pa with the rods' length. */
static int read_pressure(const struct scene *scene, const cJSON *section, struct simulation *simulation)
{
    double pressure = NAN;
    int kappa = json_number(scene->json, section, "kappa", 1, 1e9, &simulation->kappa);
    int pascal = kappa < 0 ? -1 : json_number(scene->json, section, "pressure_Pa", DBL_MIN, 1e15, &pressure);
    if (pascal < 0)
        return -1;
    if (kappa + pascal != 1)
        return json_error(scene->json, section,
                          "how strongly is the packing compressed? Write \"kappa\" or "
                          "\"pressure_Pa\" (one of them) in 'simulation'");
    if (pascal && isnan(scene->grains.length))
        return scene_lacks(scene, "grains.length_m", "simulate needs it with pressure_Pa");
    if (pascal)
        simulation->kappa = simulation->law.kn / (pressure * scene->grains.length);
    if (simulation->kappa < 1)
        return json_error(scene->json, section, "kappa = kn / p is %g: lower the pressure, discs would be crushed flat",
                          simulation->kappa);
    return 0;
}

static int read_numbers(const struct scene *scene, const cJSON *section, struct simulation *simulation)
{
    static const char *const tests[] = {"isotropic", "biaxial_vertical", NULL};
    const struct json *json = scene->json;
    long seed = SIMULATION_SEED, max_steps = SIMULATION_MAX_STEPS;
    int test = TEST_ISOTROPIC;
    if (json_integer(json, section, "seed", 0, 1L << 53, &seed) < 0 ||
        json_integer(json, section, "max_steps", 1, 1000000000, &max_steps) < 0 ||
        json_number(json, section, "aspect", 0.05, 20, &simulation->aspect) < 0 ||
        json_number(json, section, "friction_during_compression", 0, 10, &simulation->preparation_mu) < 0 ||
        json_number(json, section, "restitution", SIMULATION_RESTITUTION_MIN, 1, &simulation->restitution) < 0 ||
        json_number(json, section, "inertial_number", 1e-8, 0.1, &simulation->inertial) < 0 ||
        json_number(json, section, "tolerance", 1e-12, 1e-6, &simulation->tolerance) < 0 ||
        json_choice(json, section, "test", tests, &test) < 0)
        return -1;
    simulation->seed = (uint64_t)seed;
    simulation->max_steps = max_steps;
    simulation->test = (enum loading_test)test;
    return 0;
}

static int check_needs(const struct scene *scene, const cJSON *section)
{
    if (!section)
        return scene_lacks(scene, "simulation", "simulate needs to know what to simulate");
    if (isnan(scene->contact.kn))
        return scene_lacks(scene, "contact.kn_N_per_m", "simulate needs it");
    if (isnan(scene->contact.mu))
        return scene_lacks(scene, "contact.mu", "simulate needs it");
    if (isnan(scene->grains.density))
        return scene_lacks(scene, "grains.density_kg_m3", "simulate needs it for the masses");
    return 0;
}

static int read_section(const struct scene *scene, const cJSON *section, struct simulation_plan *plan)
{
    static const char *const keys[] = {
        "seed",        "grading",         "aspect",    "kappa",     "pressure_Pa", "friction_during_compression",
        "restitution", "inertial_number", "tolerance", "max_steps", "test",        "steps",
        NULL};
    struct simulation *simulation = &plan->simulation;
    if (json_check_keys(scene->json, section, keys) || read_numbers(scene, section, simulation) ||
        read_pressure(scene, section, simulation) || read_grading(scene, section, plan) ||
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
    if (read_section(scene, section, plan)) {
        simulation_plan_free(plan);
        return -1;
    }
    return 0;
}

void simulation_plan_free(struct simulation_plan *plan)
{
    free(plan->grading);
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
