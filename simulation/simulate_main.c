/* simulate: a loading test on a virtual packing. */
#include <stdlib.h>

#include "pipeline/command/cli.h"
#include "pipeline/files/read_record.h"
#include "pipeline/speak/error.h"
#include "simulation/series_folder.h"
#include "simulation/dem/simulate_scene.h"

static const char doc[] =
    "Simulate a loading test on a packing of rods seen from their end: discs with springs, dashpots and Coulomb "
    "friction are compressed between four walls, relaxed to static equilibrium, and loaded step by step. Each saved "
    "state goes into OUT/N.truth.hdf: grains, walls, contacts and the exact contact forces (/forces/dem); the loads "
    "of the walls go into OUT/loads.csv, stresses, fabric and energies into OUT/states.csv."
    "\vThe scene says what to simulate:\n"
    "  \"grains\": {\"density_kg_m3\": 730, \"length_m\": 0.06},\n"
    "  \"contact\": {\"law\": \"linear\", \"kn_N_per_m\": 1.09e7, \"mu\": 0.53},\n"
    "  \"simulation\": {\"grading\": [[52, 0.008], [28, 0.012]], \"kappa\": 200,\n"
    "                 \"test\": \"biaxial_vertical\", \"steps\": [[4, 1e-3]]}\n"
    "Example:\n"
    "  simulate --scene scene.json -o truth\n"
    "Exit status 4: a state could not be relaxed; it was saved all the same.";

/* Each state is saved as soon as it is reached; those that did not come to rest are counted as flagged rows. */
static int run(const struct cli *cli)
{
    struct scene scene = {0};
    struct simulation_plan plan = {0};
    struct series_folder folder = {0};
    char *parameters = NULL;
    int status = scene_read(cli->scene, &scene);
    if (!status)
        status = simulation_read(&scene, &plan);
    if (!status && !(parameters = simulation_parameters(&scene)))
        status = -1;
    if (!status)
        status = series_folder_open(&folder, &scene, parameters, cli->output, simulation_states(&plan.simulation));
    if (!status && simulate(&plan.simulation, series_folder_save, &folder) < 0)
        status = -1;
    if (series_folder_close(&folder))
        status = -1;
    if (!status && folder.unrelaxed)
        status = cli_flagged(cli, folder.unrelaxed, folder.states, "states did not come to rest");
    if (!status)
        cli_summary(cli, "%s: %zu states, %zu not at rest", cli->output, folder.states, folder.unrelaxed);
    free(parameters);
    simulation_plan_free(&plan);
    scene_free(&scene);
    return status;
}

int main(int argc, char **argv)
{
    struct cli cli = CLI_DEFAULT;
    const struct program program = {NULL, doc, NULL, &cli, NULL, 0, 0, NULL, NULL};
    read_record_begin();
    cli_parse(&program, argc, argv);
    return cli_finish(&cli, run(&cli));
}
