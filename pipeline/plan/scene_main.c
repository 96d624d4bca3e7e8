#include "pipeline/command/cli.h"
#include "pipeline/plan/scene_commands.h"

/* Whose part: the stages, and the sections of simulate and render. */
static const char *const parts[] = {"findgrains", "tracker",    "contacts", "forces",
                                    "report",     "simulation", "optics",   NULL};

struct arguments {
    struct cli cli;
    int command; /* -1: not yet given */
    struct scene_words words;
};

enum { METHOD = 256, START, FORMAT, RUNNER };
static const struct argp_option option_list[] = {
    {"method", METHOD, "LIST", 0, "Methods of forces, or series (default: the scene's)", 0},
    {"start", START, "START", 0, "What forces starts from (default: the scene's)", 0},
    {"format", FORMAT, "FORMAT", 0, "plan: json, one object per line (default), or make, for the folder -o", 0},
    {"runner", RUNNER, "FILE", 0, "plan: a program that runs every command (pipeline/stage)", 0},
    {0}};

static const char help[] =
    "Read a scene and say what is in it, what has to be made from it, and what is.\v"
    "check: is every key known, every number in its range, every file that the scene names there? Prints nothing when "
    "all is well.\n"
    "photos: index and path of every photo, one per line, separated by a tabulator.\n"
    "series: first, last and reference photo, photos per block, lens and loads: key and value, separated by a "
    "tabulator.\n"
    "part: the part of the scene that a stage's numbers depend on, as JSON; STAGE: findgrains, tracker, contacts, "
    "forces, report, simulation or optics.\n"
    "plan: every result of the series, its command, what it is made from. Results lie in the folder -o (default: "
    "`results` beside the scene), where the commands are to run.\n"
    "begin: make the folder -o ready for a run: forget what was cut off, note what the scene says.\n"
    "status: a table of what is done, flagged, failed, begun or missing.\n"
    "results: the same, one result per line: name, state, there or absent, separated by tabulators.\n\n"
    "Examples:\n  scene check my-test/scene.json\n  scene plan my-test/scene.json | grep 0004.forces.hdf";

static error_t parse(int key, char *text, struct argp_state *state)
{
    static const char *const formats[] = {"json", "make", NULL};
    struct arguments *arguments = state->input;
    struct scene_words *words = &arguments->words;
    if (key == ARGP_KEY_INIT)
        state->child_inputs[0] = &arguments->cli;
    else if (key == METHOD)
        words->plan.method = text;
    else if (key == START)
        words->plan.start = text;
    else if (key == FORMAT)
        words->make = cli_choice(state, "--format", text, formats);
    else if (key == RUNNER)
        words->plan.runner = text;
    else if (key == ARGP_KEY_ARG && state->arg_num == 0)
        arguments->command = cli_choice(state, "command", text, SCENE_COMMANDS);
    else if (key == ARGP_KEY_ARG && state->arg_num == 1)
        words->scene = text;
    else if (key == ARGP_KEY_ARG && state->arg_num == 2 && arguments->command == SCENE_PART)
        words->part = parts[cli_choice(state, "stage", text, parts)];
    else if (key == ARGP_KEY_ARG)
        argp_error(state, "%s: one word too many", text);
    else if (key == ARGP_KEY_END && (!words->scene || (arguments->command == SCENE_PART && !words->part)))
        argp_error(state, "which scene%s? See --help", arguments->command == SCENE_PART ? ", and which stage" : "");
    else if (key != ARGP_KEY_END)
        return ARGP_ERR_UNKNOWN;
    return 0;
}

int main(int argc, char **argv)
{
    const struct argp_child children[] = {CLI_CHILD, {0}};
    const struct argp parser = {option_list, parse, "COMMAND SCENE.json\npart SCENE.json STAGE", help, children,
                                NULL,        NULL};
    struct arguments arguments = {.cli = CLI_DEFAULT, .command = -1, .words.plan = {"", "", "", "", "", 0}};
    arguments.cli.needs = 0;
    cli_parse(&parser, argc, argv, &arguments);
    arguments.words.plan.allow_outside = arguments.cli.allow_outside;
    if (arguments.cli.output)
        arguments.words.plan.out = arguments.cli.output;
    return cli_finish(&arguments.cli, scene_run((enum scene_command)arguments.command, &arguments.words));
}
