/* calibration hertz: options, call, write. */
#include <math.h>
#include <string.h>

#include "calibration/commands.h"
#include "calibration/hertz.h"
#include "pipeline/cli.h"

enum { KEY_YOUNG = 0x2000, KEY_POISSON, KEY_CONFINEMENT, KEY_POROSITY, KEY_COORDINATION, KEY_D50, KEY_DIMENSIONS };

struct options {
    struct cli cli;
    double young, poisson, confinement, porosity, coordination, d50;
    int dimensions;
};

static const struct argp_option option_table[] = {
    {"young", KEY_YOUNG, "E", 0, "Young's modulus of the packing (Pa; N/m in 2D without a length)", 0},
    {"poisson", KEY_POISSON, "NU", 0, "Poisson's ratio of the packing", 0},
    {"confinement", KEY_CONFINEMENT, "P", 0, "Confining stress, same unit as E", 0},
    {"porosity", KEY_POROSITY, "PHI", 0, "Voids over total, 0 to 1", 0},
    {"coordination", KEY_COORDINATION, "Z", 0, "Contacts per grain", 0},
    {"d50", KEY_D50, "M", 0, "Median diameter, m", 0},
    {"dimensions", KEY_DIMENSIONS, "2|3", 0, "Discs or spheres (default 2)", 0},
    {0}};

static const char documentation[] =
    "Young's modulus and Poisson's ratio of the grains from those of the packing: the closed forms of the static "
    "hypothesis. A start for a calibration by discrete elements, from which it may be 10 to 20 % away.\v"
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
    case ARGP_KEY_END:
        if (isnan(o->young + o->poisson + o->confinement + o->porosity + o->coordination + o->d50))
            argp_error(state, "give all of --young --poisson --confinement --porosity --coordination --d50");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static int run(const struct options *o)
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
                              .dimensions = HERTZ_2D};
    cli_parse(&parser, argc, argv, &options);
    return cli_finish(&options.cli, run(&options));
}
