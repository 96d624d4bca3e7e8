/* calibration hertz: Young's modulus and Poisson's ratio of the grains from those of the packing.
 *
 * Closed form: the static hypothesis, each contact deflects as the mean strain says; grains E and nu follow at once.
 * Search: from there, probes of a packing of the scene by discrete elements (discs, or spheres by LAMMPS) until the
 * packing has the wanted moduli. In the plane stresses are N/m: Pa times the rods' length.
 *
 * Out: film.hertz/1: young_Pa and poisson of the grains; of a search also what it reached and every probe. */
#include <math.h>
#include <string.h>

#include "calibration/commands/calibration_commands.h"
#include "calibration/hertz/hertz.h"
#include "calibration/hertz/hertz_probes.h"
#include "calibration/hertz/lammps_probes.h"
#include "pipeline/command/cli.h"
#include "pipeline/speak/error.h"
#include "simulation/dem/simulate_scene.h"
#include "pipeline/files/json.h"

struct options {
    struct cli cli;
    double young, poisson, confinement, porosity, coordination, d50;
    int dimensions;
    int search; /* -1: closed form; else enum hertz_method */
    double grain_poisson, rate, strain;
    const char *record;
    int anew, most;
};

#define AT(field) .at = offsetof(struct options, field)
static const struct option_row rows[] = {
    {"young", NULL, OPTION_NUMBER, AT(young), "E", .min = 1e-30, .max = 1e30,
     .help = "Young's modulus of the packing (Pa; N/m in 2D without a length)"},
    {"poisson", NULL, OPTION_NUMBER, AT(poisson), "NU", .min = -1, .max = 0.5,
     .help = "Poisson's ratio of the packing"},
    {"confinement", NULL, OPTION_NUMBER, AT(confinement), "P", .min = 1e-30, .max = 1e30,
     .help = "Confining stress, same unit as E"},
    {"porosity", NULL, OPTION_NUMBER, AT(porosity), "PHI", .max = 0.999, .help = "Voids over total"},
    {"coordination", NULL, OPTION_NUMBER, AT(coordination), "Z", .min = 0.1, .max = 20, .help = "Contacts per grain"},
    {"d50", NULL, OPTION_NUMBER, AT(d50), "M", .min = 1e-9, .max = 1e3, .help = "Median diameter, m"},
    {"dimensions", NULL, OPTION_WHOLE, AT(dimensions), "2|3", .min = 2, .max = 3, .help = "Discs or spheres"},
    {"search", NULL, OPTION_CHOICE, AT(search), "METHOD", .words = HERTZ_METHODS, .group = 1,
     .help = "Search with probes of the scene's packing"},
    {"grain-poisson", NULL, OPTION_NUMBER, AT(grain_poisson), "NU", .max = HERTZ_MOST_POISSON, .group = 1,
     .help = "Keep the grains' Poisson's ratio, seek E alone"},
    {"record", NULL, OPTION_TEXT, AT(record), "R.jsonl", .group = 1,
     .help = "Every probe, one line each; an interrupted search goes on from there"},
    {"anew", NULL, OPTION_SWITCH, AT(anew), .group = 1, .help = "Consolidate the packing anew for every probe"},
    {"rate", NULL, OPTION_NUMBER, AT(rate), "R", .min = 1e-4, .max = 1, .group = 1,
     .help = "Adam's learning rate; default: 0.8 of the way left; nu*: 0.1"},
    {"most-probes", NULL, OPTION_WHOLE, AT(most), "N", .min = 1, .max = 100000, .group = 1,
     .help = "Give up after so many"},
    {"strain", NULL, OPTION_NUMBER, AT(strain), "EPS", .min = 1e-8, .max = 5e-4, .group = 1, .help = "Of the probe"},
    {0}};

static const char documentation[] =
    "Young's modulus and Poisson's ratio of the grains from those of the packing: the closed forms of the static "
    "hypothesis; with --search, by small-strain probes of a packing by discrete elements that start there.\v"
    "Closed form: --young --poisson --confinement --porosity --coordination --d50. Search: --scene (its simulation: "
    "grading, pressure_Pa, friction_during_compression; its contact: law hertz_pfc or hertz_mindlin), --young, and "
    "--poisson or --grain-poisson.\n\n"
    "Example: calibration hertz --young 1e9 --poisson 0.1 --confinement 1e5 --porosity 0.17 --coordination 4.1 --d50 "
    "2e-3 -o hertz.json";

/* Two uses of one command: the closed form needs all six numbers, the search a scene, E, and exactly one Poisson's
 * ratio: the packing's, when both are sought, or the grains'. */
static int check(void *input)
{
    struct options *o = input;
    if (o->search < 0)
        return isnan(o->young + o->poisson + o->confinement + o->porosity + o->coordination + o->d50)
                   ? error_input("give all of --young --poisson --confinement --porosity --coordination --d50")
                   : 0;
    o->cli.needs |= CLI_NEEDS_SCENE;
    if (isnan(o->young) || isnan(o->poisson) == isnan(o->grain_poisson))
        return error_input("--search needs --young and one of --poisson (both are sought) and --grain-poisson");
    return 0;
}

/* film.hertz/1 of a search: what was sought, found, and every probe. Moduli of the packing in Pa: `metres` is the rods'
 * length, by which stresses in the plane are divided. */
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
        "not reached after %d probes: the best is E = %.4g Pa, nu = %.3f: raise --most-probes, use newton, or take "
        "more grains",
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

/* The packing, its pressure and its law are the scene's. */
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

/* Static hypothesis (hertz.h): the volume per contact from porosity, coordination and d50, then both moduli at once. */
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
    struct options options = {.cli = CLI_NEEDING(CLI_NEEDS_OUTPUT),
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
    const struct program program = {NULL, documentation, rows, &options, NULL, 0, 0, NULL, check};
    cli_parse(&program, argc, argv);
    return cli_finish(&options.cli, options.search >= 0 ? run_search(&options) : run_closed(&options));
}
