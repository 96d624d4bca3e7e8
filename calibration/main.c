#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "calibration/commands/calibration_commands.h"
#include "pipeline/draw/canvas.h"
#include "pipeline/speak/version.h"
#include "pipeline/speak/error.h"
#include "pipeline/files/read_record.h"

static const struct command {
    const char *name, *full_name;
    int (*run)(int argc, char **argv);
    const char *what;
} commands[] = {
    {"lens", "calibration lens", command_lens, "distortion of the lens from photos of a moved plate"},
    {"scale", "calibration scale", command_scale, "metres per pixel from known lengths"},
    {"stiffness", "calibration stiffness", command_stiffness, "normal stiffness from a test on two rods"},
    {"rescale", "calibration rescale", command_rescale, "stiffness from the stresses of a whole series"},
    {"friction", "calibration friction", command_friction, "friction between grains from three-rod tests"},
    {"hertz", "calibration hertz", command_hertz, "grain moduli from packing moduli"},
    {"laws", "calibration laws", command_laws, "contact laws compared on a small-strain probe"},
    {"settlement", "calibration settlement", command_settlement, "long-term settlement under cycles"},
};

static void print_help(FILE *out)
{
    fputs("Usage: calibration COMMAND [OPTION...]\n"
          "What a scene must know about the grains and the camera, from experiments.\n\n",
          out);
    for (size_t k = 0; k < sizeof commands / sizeof *commands; k++)
        fprintf(out, "  %-10s %s\n", commands[k].name, commands[k].what);
    fputs("\n'calibration COMMAND --help' teaches one command.\n", out);
}

int main(int argc, char **argv)
{
    read_record_begin();
    if (argc > 1 && !strcmp(argv[1], "--help")) {
        print_help(stdout);
        return EXIT_DONE;
    }
    if (argc > 1 && !strcmp(argv[1], "--version")) {
        printf("calibration (film) %s\n", film_version);
        return EXIT_DONE;
    }
    for (size_t k = 0; argc > 1 && k < sizeof commands / sizeof *commands; k++)
        if (!strcmp(argv[1], commands[k].name)) {
            program_invocation_short_name = (char *)commands[k].full_name;
            int status = commands[k].run(argc - 1, argv + 1);
            canvas_forget_fonts();
            return status;
        }
    fprintf(stderr, "calibration: %s 'calibration --help' lists the commands\n",
            argc > 1 ? "there is no such command:" : "which command?");
    return EXIT_USAGE;
}
