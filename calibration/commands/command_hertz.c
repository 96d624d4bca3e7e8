/* calibration hertz: options, call, write. */
#include <math.h>
#include <string.h>

#include "calibration/commands/calibration_commands.h"
#include "calibration/hertz/hertz.h"
#include "calibration/hertz/hertz_probes.h"
#include "calibration/hertz/lammps_probes.h"
#include "pipeline/command/cli.h"
#include "pipeline/speak/error.h"
#include "simulation/dem/simulate_scene.h"

enum {
    KEY_YOUNG = 0x2000,
    KEY_POISSON,
    KEY_CONFINEMENT,
    KEY_POROSITY,
    KEY_COORDINATION,
    KEY_D50,
    KEY_DIMENSIONS,
    KEY_SEARCH,
    KEY_GRAIN_POISSON,
    KEY_RECORD,
    KEY_ANEW,
    KEY_RATE,
    KEY_MOST,
    KEY_STRAIN
};

struct options {
    struct cli cli;
    double young, poisson, confinement, porosity, coordination, d50;
    int dimensions;
    int search; /* -1: closed form; else enum hertz_method */
    double grain_poisson, rate, strain;
    const char *record;
    int anew, most;
};

static const struct argp_option option_table[] = {
    {"young", KEY_YOUNG, "E", 0, "Young's modulus of the packing (Pa; N/m in 2D without a length)", 0},
    {"poisson", KEY_POISSON, "NU", 0, "Poisson's ratio of the packing", 0},
    {"confinement", KEY_CONFINEMENT, "P", 0, "Confining stress, same unit as E", 0},
    {"porosity", KEY_POROSITY, "PHI", 0, "Voids over total, 0 to 1", 0},
    {"coordination", KEY_COORDINATION, "Z", 0, "Contacts per grain", 0},
    {"d50", KEY_D50, "M", 0, "Median diameter, m", 0},
    {"dimensions", KEY_DIMENSIONS, "2|3", 0, "Discs or spheres (default 2)", 0},
    {"search", KEY_SEARCH, "METHOD", 0, "Search with probes of the scene's packing: newton or adam", 1},
    {"grain-poisson", KEY_GRAIN_POISSON, "NU", 0, "Keep the grains' Poisson's ratio, seek E alone", 1},
    {"record", KEY_RECORD, "R.jsonl", 0, "Every probe, one line each; an interrupted search goes on from there", 1},
    {"anew", KEY_ANEW, NULL, 0, "Consolidate the packing anew for every probe", 1},
    {"rate", KEY_RATE, "R", 0, "Adam's learning rate (default: 0.8 of the way left; nu*: 0.1)", 1},
    {"most-probes", KEY_MOST, "N", 0, "Give up after so many (default 60)", 1},
    {"strain", KEY_STRAIN, "EPS", 0, "Of the probe (default 1e-5)", 1},
    {0}};

static const char documentation[] =
    "Young's modulus and Poisson's ratio of the grains from those of the packing: the closed forms of the static "
    "hypothesis; with --search, by small-strain probes of a packing by discrete elements that start there.\v"
    "Closed form: --young --poisson --confinement --porosity --coordination --d50. Search: --scene (its simulation: "
    "grading, pressure_Pa, friction_during_compression; its contact: law hertz_pfc or hertz_mindlin), --young, and "
    "--poisson or --grain-poisson.\n\n"
    "Example: calibration hertz --young 1e9 --poisson 0.1 --confinement 1e5 --porosity 0.17 --coordination 4.1 "
    "--d50 2e-3 -o hertz.json";

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    struct options *o = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &o->cli;
        return 0;
    case KEY_YOUNG:
        o->young = cli_number(state, "--young", argument, 1e-30, 1e30);
        return 0;
    case KEY_POISSON:
        o->poisson = cli_number(state, "--poisson", argument, -1, 0.5);
        return 0;
    case KEY_CONFINEMENT:
        o->confinement = cli_number(state, "--confinement", argument, 1e-30, 1e30);
        return 0;
    case KEY_POROSITY:
        o->porosity = cli_number(state, "--porosity", argument, 0, 0.999);
        return 0;
    case KEY_COORDINATION:
        o->coordination = cli_number(state, "--coordination", argument, 0.1, 20);
        return 0;
    case KEY_D50:
        o->d50 = cli_number(state, "--d50", argument, 1e-9, 1e3);
        return 0;
    case KEY_DIMENSIONS:
        o->dimensions = (int)cli_number(state, "--dimensions", argument, 2, 3) == 3 ? HERTZ_3D : HERTZ_2D;
        return 0;
    case KEY_SEARCH:
        o->search = cli_choice(state, "--search", argument, HERTZ_METHODS);
        o->cli.needs |= CLI_NEEDS_SCENE;
        return 0;
    case KEY_GRAIN_POISSON:
        o->grain_poisson = cli_number(state, "--grain-poisson", argument, 0, HERTZ_MOST_POISSON);
        return 0;
    case KEY_RECORD:
        o->record = argument;
        return 0;
    case KEY_ANEW:
        o->anew = 1;
        return 0;
    case KEY_RATE:
        o->rate = cli_number(state, "--rate", argument, 1e-4, 1);
        return 0;
    case KEY_MOST:
        o->most = (int)cli_number(state, "--most-probes", argument, 1, 100000);
        return 0;
    case KEY_STRAIN:
        o->strain = cli_number(state, "--strain", argument, 1e-8, 5e-4);
        return 0;
    case ARGP_KEY_END:
        if (o->search >= 0 && (isnan(o->young) || isnan(o->poisson) == isnan(o->grain_poisson)))
            argp_error(state, "--search needs --young and one of --poisson (both are sought) and --grain-poisson");
        if (o->search >= 0)
            return 0;
        if (isnan(o->young + o->poisson + o->confinement + o->porosity + o->coordination + o->d50))
            argp_error(state, "give all of --young --poisson --confinement --porosity --coordination --d50");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static void describe_goal(const struct options *o, const struct hertz_goal *goal, const struct hertz_probes *probes,
                          const struct hertz_found *found, double metres, cJSON *object)
{
    cJSON *rows = cJSON_CreateArray();
    cJSON_AddStringToObject(object, "schema", "film.hertz/1");
    cJSON_AddStringToObject(object, "method", HERTZ_METHODS[o->search]);
    calibration_add(object, "young_Pa", found->best.grain_young);
    calibration_add(object, "poisson", found->best.grain_poisson);
    cJSON_AddBoolToObject(object, "reached", found->reached);
    calibration_add(object, "cost", found->cost);
    calibration_add(object, "packing_young_Pa", found->best.young / metres);
    calibration_add(object, "packing_poisson", found->best.poisson);
    calibration_add(object, "start_young_Pa", goal->grain_young);
    calibration_add(object, "start_poisson", goal->grain_poisson);
    calibration_add(object, "iterations", found->iterations);
    calibration_add(object, "probes", found->probes);
    for (size_t k = 0; k < probes->record.count; k++) {
        const struct probe_row *row = &probes->record.rows[k];
        cJSON *item = cJSON_CreateObject();
        calibration_add(item, "young_Pa", row->grain_young);
        calibration_add(item, "poisson", row->grain_poisson);
        calibration_add(item, "packing_young_Pa", row->young / metres);
        calibration_add(item, "packing_poisson", row->poisson);
        calibration_add(item, "porosity", row->porosity);
        calibration_add(item, "z", row->z);
        calibration_add(item, "steps", (double)row->steps);
        cJSON_AddBoolToObject(item, "rested", row->rested);
        cJSON_AddItemToArray(rows, item);
    }
    cJSON_AddItemToObject(object, "record", rows);
}

/* Written whether or not the target was reached; then the reason is an error. */
static int write_found(const struct options *o, const struct hertz_goal *goal, const struct hertz_probes *probes,
                       const struct hertz_found *found, double metres)
{
    cJSON *object = cJSON_CreateObject();
    describe_goal(o, goal, probes, found, metres, object);
    if (calibration_write(o->cli.output, object))
        return -1;
    if (found->reached)
        return 0;
    double margin = 0.1 * fabs(goal->poisson); /* probes that are that far off never came near */
    int outside = goal->poisson < found->poisson_low - margin || goal->poisson > found->poisson_high + margin;
    if (goal->fit_poisson && (found->at_bound || outside))
        return error_input("nu = %g cannot be reached: with grains from 0 to 0.5 this packing gives %.3f to %.3f "
                           "(%d probes): calibrate E alone with --grain-poisson",
                           goal->poisson, found->poisson_low, found->poisson_high, found->probes);
    return error_input(
        "not reached after %d probes: the best is E = %.4g Pa, nu = %.3f: raise --most-probes, use newton, "
        "or take more grains",
        found->probes, found->best.young / metres, found->best.poisson);
}

/* Spheres by LAMMPS: stresses and moduli are Pa throughout. */
static int search_spheres(const struct options *o, struct simulation *simulation, struct hertz_goal *goal)
{
    struct lammps_probes spheres;
    struct hertz_probes shown = {.record = {.path = NULL}};
    struct hertz_found found;
    double metres = isnan(simulation->length) ? 1 : simulation->length;
    simulation->pressure /= metres;
    goal->young = o->young;
    goal->dimensions = HERTZ_3D;
    if (!isnan(simulation->preparation_mu))
        simulation->law.mu = simulation->preparation_mu;
    if (lammps_probes_open(simulation, o->strain, PROBE_MU, o->record, goal, &spheres))
        return -1;
    int status = hertz_search(goal, lammps_probes_evaluate, &spheres, &found);
    shown.record = spheres.record; /* borrowed */
    if (!status)
        status = write_found(o, goal, &shown, &found, 1);
    lammps_probes_close(&spheres);
    return status;
}

/* Targets are Pa, stresses in the plane N/m: times the rods' length. The grains' modulus stays in Pa. */
static int search_plan(const struct options *o, struct simulation *simulation)
{
    double metres = isnan(simulation->length) ? 1 : simulation->length;
    struct hertz_goal goal = {.dimensions = HERTZ_2D,
                              .young = o->young * metres,
                              .poisson = o->poisson,
                              .fit_poisson = !isnan(o->poisson),
                              .grain_poisson = o->grain_poisson,
                              .method = (enum hertz_method)o->search,
                              .rate = o->rate,
                              .first_step = HERTZ_FIRST_STEP,
                              .cost = HERTZ_COST,
                              .most_probes = o->most};
    struct probe_options probe = {o->strain, PROBE_MU};
    struct hertz_probes probes;
    struct hertz_found found;
    if (o->dimensions == HERTZ_3D)
        return search_spheres(o, simulation, &goal);
    if (!contact_law_row(&simulation->law)->smooth)
        return error_input("%s: contact.law: a search seeks Hertz parameters: make it hertz_pfc or hertz_mindlin",
                           o->cli.scene);
    if (hertz_probes_open(simulation, &probe, o->anew, o->record, &goal, &probes))
        return -1;
    int status = hertz_search(&goal, hertz_probes_evaluate, &probes, &found);
    if (!status)
        status = write_found(o, &goal, &probes, &found, metres);
    hertz_probes_close(&probes);
    return status;
}

static int run_search(const struct options *o)
{
    struct scene scene = {0};
    struct simulation_plan plan = {0};
    int status = scene_read(o->cli.scene, &scene);
    if (!status)
        status = simulation_read(&scene, &plan);
    if (!status)
        status = search_plan(o, &plan.simulation);
    simulation_plan_free(&plan);
    scene_free(&scene);
    return status;
}

static int run_closed(const struct options *o)
{
    struct hertz_packing packing = {.dimensions = o->dimensions, .radius = o->d50 / 2, .confinement = o->confinement};
    double young, poisson;
    packing.volume_per_contact = hertz_volume_per_contact(o->dimensions, packing.radius, o->porosity, o->coordination);
    if (hertz_start(&packing, o->young, o->poisson, &young, &poisson))
        return -1;
    cJSON *object = cJSON_CreateObject();
    cJSON_AddStringToObject(object, "schema", "film.hertz/1");
    cJSON_AddStringToObject(object, "method", "closed form");
    cJSON_AddNumberToObject(object, "young_Pa", young);
    cJSON_AddNumberToObject(object, "poisson", poisson);
    return calibration_write(o->cli.output, object);
}

int command_hertz(int argc, char **argv)
{
    const struct argp_child children[] = {CLI_CHILD, {0}};
    const struct argp parser = {option_table, parse_option, NULL, documentation, children, NULL, NULL};
    struct options options = {.cli = {.max_flagged = CLI_MAX_FLAGGED, .needs = CLI_NEEDS_OUTPUT},
                              .young = NAN,
                              .poisson = NAN,
                              .confinement = NAN,
                              .porosity = NAN,
                              .coordination = NAN,
                              .d50 = NAN,
                              .dimensions = HERTZ_2D,
                              .search = -1,
                              .grain_poisson = NAN,
                              .rate = HERTZ_RATE,
                              .strain = PROBE_STRAIN,
                              .most = HERTZ_MOST_PROBES};
    cli_parse(&parser, argc, argv, &options);
    return cli_finish(&options.cli, options.search >= 0 ? run_search(&options) : run_closed(&options));
}
