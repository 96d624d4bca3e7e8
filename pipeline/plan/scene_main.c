#include "pipeline/command/cli.h"
#include "pipeline/plan/scene_commands.h"
#include "pipeline/speak/error.h"

/* Whose part: the stages, and the sections of simulate and render. */
static const char *const parts[] = {"findgrains", "tracker",    "contacts", "forces",
                                    "report",     "simulation", "optics",   NULL};

struct arguments {
    struct cli cli;
    int command; /* -1: not yet given */
    struct scene_words words;
};

static const char *const formats[] = {"json", "make", NULL};

#define AT(field) .at = offsetof(struct arguments, field)
static const struct option_row rows[] = {{"method", NULL, OPTION_TEXT, AT(words.plan.method), "LIST",
                                          .help = "Methods of forces, or series; default: the scene's"},
                                         {"start", NULL, OPTION_TEXT, AT(words.plan.start), "START",
                                          .help = "What forces starts from; default: the scene's"},
                                         {"format", NULL, OPTION_CHOICE, AT(words.make), "FORMAT", .words = formats,
                                          .help = "plan: json, one object per line, or make, for the folder -o"},
                                         {"runner", NULL, OPTION_TEXT, AT(words.plan.runner), "FILE",
                                          .help = "plan: a program that runs every command (pipeline/stage)"},
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

static int choose(const char *what, const char *text, const char *const list[])
{
    int k = option_choice(text, list);
    return k < 0 ? error_context("%s %s", what, text) : k;
}

/* COMMAND SCENE.json, and STAGE where a part is wanted. */
static int check(void *options)
{
    struct arguments *arguments = options;
    const struct cli_inputs *inputs = &arguments->cli.inputs;
    if ((arguments->command = choose("command", inputs->paths[0], SCENE_COMMANDS)) < 0)
        return -1;
    int wanted = arguments->command == SCENE_PART ? 3 : 2;
    if (inputs->count != (size_t)wanted)
        return error_input("which scene%s? See --help", wanted == 3 ? ", and which stage" : "");
    int part = wanted == 3 ? choose("stage", inputs->paths[2], parts) : 0;
    if (part < 0)
        return -1;
    arguments->words.scene = inputs->paths[1];
    arguments->words.part = parts[part];
    return 0;
}

int main(int argc, char **argv)
{
    struct arguments arguments = {.cli = CLI_NEEDING(0), .command = -1, .words.plan = {"", "", "", "", "", 0}};
    const char usage[] = "COMMAND SCENE.json\npart SCENE.json STAGE", asks[] = "which scene? See --help";
    const struct program program = {usage, help, rows, &arguments, NULL, 2, 3, asks, check};
    cli_parse(&program, argc, argv);
    arguments.words.plan.allow_outside = arguments.cli.allow_outside;
    if (arguments.cli.output)
        arguments.words.plan.out = arguments.cli.output;
    return cli_finish(&arguments.cli, scene_run((enum scene_command)arguments.command, &arguments.words));
}
