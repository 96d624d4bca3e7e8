/* report budget: the error of contact forces to expect, before anyone goes to the lab.
 *
 * The formulas are in report/compare/budget.h. What the command line leaves open is taken from the scene where there is
 * one; all of scale, diameter, length and k_n have to be known in the end. */
#include <math.h>
#include <stdio.h>

#include "pipeline/command/cli.h"
#include "pipeline/speak/error.h"
#include "pipeline/scene/scene.h"
#include "report/compare/budget.h"
#include "report/commands/report_commands.h"

/* The budget's numbers begin as NaN, which is "not given". */
struct options {
    struct cli cli;
    struct budget budget;
    const char *json;
};

#define AT(field) .at = offsetof(struct options, field)
static const struct option_row rows[] = {
    {"pressure", NULL, OPTION_NUMBER, AT(budget.pressure), "PA", .min = 1e-6, .max = 1e12,
     .help = "Mean stress of the test (needed)"},
    {"scale", NULL, OPTION_NUMBER, AT(budget.scale), "M_PER_PX", .min = 1e-12, .max = 1,
     .help = "Scale; default: the scene's"},
    {"diameter", NULL, OPTION_NUMBER, AT(budget.diameter), "M", .min = 1e-9, .max = 100,
     .help = "Mean diameter of the grains; default: middle of the scene's radius_px"},
    {"length", NULL, OPTION_NUMBER, AT(budget.length), "M", .min = 1e-9, .max = 1000,
     .help = "Length of the rods; default: the scene's"},
    {"kn", NULL, OPTION_NUMBER, AT(budget.kn), "N_PER_M", .min = 1e-6, .max = 1e15,
     .help = "Normal stiffness; default: the scene's"},
    {"s-centre", NULL, OPTION_NUMBER, AT(budget.s_centre), "PX", .max = 100,
     .help = "Standard error of a centre, per axis"},
    {"s-radius", NULL, OPTION_NUMBER, AT(budget.s_radius), "PX", .max = 100, .help = "Standard error of a radius"},
    {"s-motion", NULL, OPTION_NUMBER, AT(budget.s_motion), "PX", .max = 100,
     .help = "Standard error of a tracked motion, per axis"},
    {"coordination", NULL, OPTION_NUMBER, AT(budget.z), "Z", .min = 0.1, .max = 20, .help = "Contacts per grain"},
    {"solid", NULL, OPTION_NUMBER, AT(budget.solid), "PHI", .min = 0.01, .max = 1,
     .help = "Share of the area that grains cover"},
    {"json", NULL, OPTION_OUTPUT, AT(json), "OUT.json", .help = "Write the numbers here too"},
    {0}};

static const char documentation[] =
    "What error of the contact forces to expect, from the scale, the stiffness, the load and the errors of positions "
    "and radii: before anyone goes to the lab. Methods that use equilibrium (qsm, cdm, map) do better than these "
    "numbers, which hold for each contact by itself; forces --method series does up to ten times better, when the "
    "photos are taken for it: photograph the packing nearly unloaded first (about 1 % of the load), then at several "
    "levels of load, then during the test every 1e-3 of strain or closer, over at least 5e-3 of strain. Photos "
    "between which no contact opens, closes or slips tell nothing new.\v"
    "Example:\n"
    "  report budget --scene scene.json --pressure 100e3 --diameter 0.012";

/* For struct program: what no scene tells has to be given. */
static int check(void *options)
{
    if (isnan(((struct options *)options)->budget.pressure))
        return error_input("at which mean stress? Give --pressure PA");
    return 0;
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

/* A table for people on stdout; the same numbers as JSON with --json. */
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
    struct options options = {.cli = CLI_NEEDING(0), .budget = BUDGET_DEFAULT};
    const struct program program = {NULL, documentation, rows, &options, NULL, 0, 0, NULL, check};
    cli_parse(&program, argc, argv);
    return cli_finish(&options.cli, run(&options));
}
