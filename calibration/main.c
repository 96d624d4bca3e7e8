/* calibration: one program of many commands; each is a row here and a file in calibration/commands. */
#include "calibration/commands/calibration_commands.h"
#include "pipeline/command/cli.h"
#include "pipeline/draw/canvas.h"
#include "pipeline/files/read_record.h"

static const struct subcommand commands[] = {
    {"lens", "calibration lens", command_lens, "distortion of the lens from photos of a moved plate"},
    {"scale", "calibration scale", command_scale, "metres per pixel from known lengths"},
    {"stiffness", "calibration stiffness", command_stiffness, "normal stiffness from a test on two rods"},
    {"rescale", "calibration rescale", command_rescale, "stiffness from the stresses of a whole series"},
    {"friction", "calibration friction", command_friction, "friction between grains from three-rod tests"},
    {"hertz", "calibration hertz", command_hertz, "grain moduli from packing moduli"},
    {"laws", "calibration laws", command_laws, "contact laws compared on a small-strain probe"},
    {"settlement", "calibration settlement", command_settlement, "long-term settlement under cycles"},
    {0}};

int main(int argc, char **argv)
{
    read_record_begin();
    int status = cli_command("calibration", "What a scene must know about the grains and the camera, from experiments.",
                             commands, argc, argv);
    canvas_forget_fonts();
    return status;
}
