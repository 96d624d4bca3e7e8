/* report budget: options, read, call, print. */
#include <math.h>
#include <stdio.h>

#include "pipeline/command/cli.h"
#include "pipeline/speak/error.h"
#include "pipeline/scene/scene.h"
#include "report/compare/budget.h"
#include "report/commands/report_commands.h"

struct options {
    struct cli cli;
    struct budget budget;
    const char *json;
};

enum {
    KEY_PRESSURE = 0x2000,
    KEY_DIAMETER,
    KEY_CENTRE,
    KEY_RADIUS,
    KEY_MOTION,
    KEY_Z,
    KEY_SOLID,
    KEY_SCALE,
    KEY_KN,
    KEY_LENGTH,
    KEY_JSON
};

static const struct argp_option option_list[] = {
    {"pressure", KEY_PRESSURE, "PA", 0, "Mean stress of the test (needed)", 0},
    {"scale", KEY_SCALE, "M_PER_PX", 0, "Scale (default: the scene's)", 0},
    {"diameter", KEY_DIAMETER, "M", 0, "Mean diameter of the grains (default: middle of the scene's radius_px)", 0},
    {"length", KEY_LENGTH, "M", 0, "Length of the rods (default: the scene's)", 0},
    {"kn", KEY_KN, "N_PER_M", 0, "Normal stiffness (default: the scene's)", 0},
    {"s-centre", KEY_CENTRE, "PX", 0, "Standard error of a centre, per axis (default 0.05)", 0},
    {"s-radius", KEY_RADIUS, "PX", 0, "Standard error of a radius (default 0.05)", 0},
    {"s-motion", KEY_MOTION, "PX", 0, "Standard error of a tracked motion, per axis (default 0.005)", 0},
    {"coordination", KEY_Z, "Z", 0, "Contacts per grain (default 3.6)", 0},
    {"solid", KEY_SOLID, "PHI", 0, "Share of the area that grains cover (default 0.84)", 0},
    {"json", KEY_JSON, "OUT.json", 0, "Write the numbers here too", 0},
    {0}};

static const char documentation[] =
    "What error of the contact forces to expect, from the scale, the stiffness, the load and the errors of positions "
    "and radii: before anyone goes to the lab. Methods that use equilibrium (qsm, cdm, map) do better than these "
    "numbers, which hold for each contact by itself; forces --method series does up to ten times better, when the "
    "photos "
    "are taken for it: photograph the packing nearly unloaded first (about 1 % of the load), then at several levels of "
    "load, then during the test every 1e-3 of strain or closer, over at least 5e-3 of strain. Photos between which no "
    "contact opens, closes or slips tell nothing new.\v"
    "Example:\n"
    "  report budget --scene scene.json --pressure 100e3 --diameter 0.012";

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    struct options *options = state->input;
    struct budget *b = &options->budget;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->cli;
        return 0;
    case KEY_PRESSURE:
        b->pressure = cli_number(state, "--pressure", argument, 1e-6, 1e12);
        return 0;
    case KEY_SCALE:
        b->scale = cli_number(state, "--scale", argument, 1e-12, 1);
        return 0;
    case KEY_DIAMETER:
        b->diameter = cli_number(state, "--diameter", argument, 1e-9, 100);
        return 0;
    case KEY_LENGTH:
        b->length = cli_number(state, "--length", argument, 1e-9, 1000);
        return 0;
    case KEY_KN:
        b->kn = cli_number(state, "--kn", argument, 1e-6, 1e15);
        return 0;
    case KEY_CENTRE:
        b->s_centre = cli_number(state, "--s-centre", argument, 0, 100);
        return 0;
    case KEY_RADIUS:
        b->s_radius = cli_number(state, "--s-radius", argument, 0, 100);
        return 0;
    case KEY_MOTION:
        b->s_motion = cli_number(state, "--s-motion", argument, 0, 100);
        return 0;
    case KEY_Z:
        b->z = cli_number(state, "--coordination", argument, 0.1, 20);
        return 0;
    case KEY_SOLID:
        b->solid = cli_number(state, "--solid", argument, 0.01, 1);
        return 0;
    case KEY_JSON:
        options->json = argument;
        return 0;
    case ARGP_KEY_ARG:
        argp_error(state, "'%s': this command takes no files", argument);
        return 0;
    case ARGP_KEY_END:
        if (isnan(b->pressure))
            argp_error(state, "at which mean stress? Give --pressure PA");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

/* What the options leave open comes from the scene. */
static int complete(const char *scene_path, struct budget *b)
{
    struct scene scene = {0};
    if (scene_path && scene_read(scene_path, &scene))
        return -1;
    if (scene_path) {
        if (isnan(b->scale))
            b->scale = scene.scale;
        if (isnan(b->diameter))
            b->diameter = b->scale * (scene.grains.radius_min_px + scene.grains.radius_max_px);
        if (isnan(b->length))
            b->length = scene.grains.length;
        if (isnan(b->kn) && scene.contact_given)
            b->kn = scene.contact.kn;
    }
    scene_free(&scene);
    const double needed[] = {b->scale, b->diameter, b->length, b->kn};
    static const char *const names[] = {"--scale", "--diameter", "--length", "--kn"};
    for (int k = 0; k < 4; k++)
        if (isnan(needed[k]))
            return error_input("%s is not known: give it, or a scene that says it", names[k]);
    return 0;
}

static int run(struct options *options)
{
    struct figures figures = {.count = 0};
    if (complete(options->cli.scene, &options->budget))
        return -1;
    budget_figures(&options->budget, &figures);
    if (figures_print(&figures, stdout))
        return -1;
    return options->json ? figures_write_json(&figures, options->json) : 0;
}

int command_budget(int argc, char **argv)
{
    const struct argp_child children[] = {CLI_CHILD, {0}};
    const struct argp parser = {option_list, parse_option, NULL, documentation, children, NULL, NULL};
    struct options options = {.cli = CLI_DEFAULT, .budget = BUDGET_DEFAULT};
    options.cli.needs = 0;
    cli_parse(&parser, argc, argv, &options);
    return cli_finish(&options.cli, run(&options));
}
