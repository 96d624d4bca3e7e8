/* render: the photo of a virtual packing, and what is exactly where in it. */
#include <stdlib.h>

#include "pipeline/command/cli.h"
#include "pipeline/files/read_record.h"
#include "pipeline/speak/error.h"
#include "pipeline/packing/packing_file.h"
#include "simulation/render/render.h"
#include "simulation/render/render_truth.h"

/* The photo, then what is in it, beside it. Each exit frees everything: all structs accept being freed when empty. */
static int run(const struct cli *cli)
{
    struct scene scene = {0};
    struct optics optics = {0};
    struct packing packing = {0};
    struct photo photo = {0};
    struct photo_truth truth = {0};
    char *truth_path = NULL;
    int status = -1;
    if (scene_read(cli->scene, &scene) || optics_read(&scene, &optics) || packing_read(cli->inputs.paths[0], &packing))
        goto done;
    long index = packing.info.index >= 0 ? (long)packing.info.index : 0;
    if (render(&packing, &optics, &scene, index, &photo, &truth) || !(truth_path = photo_truth_path(cli->output)))
        goto done;
    if (photo_write(cli->output, &photo) == 0)
        status = photo_truth_write(truth_path, &truth, &scene, index, cli->inputs.paths[0]);
    if (status == 0)
        cli_summary(cli, "%s: %d x %d px, %zu grains", cli->output, photo.width, photo.height, packing.grains.count);
done:
    free(truth_path);
    photo_truth_free(&truth);
    photo_free(&photo);
    packing_free(&packing);
    optics_free(&optics);
    scene_free(&scene);
    return status;
}

static const char help[] =
    "Take the photo of a virtual packing.\n\n"
    "Reads a packing that `simulate` wrote and the scene's size_px, scale_m_per_px, origin_px and \"optics\"; writes a "
    "16-bit TIFF and, beside it, N.photo-truth.hdf: the exact centre, radius, rim shape and angle of every grain in "
    "that photo, corrected and as seen, and the contacts of the faces as drawn."
    "\vExample:\n  render --scene scene.json truth/0000.truth.hdf -o photos/0000.tif";

int main(int argc, char **argv)
{
    struct cli cli = CLI_DEFAULT;
    const struct program program = {
        "N.truth.hdf", help, NULL, &cli, NULL, 1, 1, "give the packing to photograph: one N.truth.hdf", NULL};
    read_record_begin();
    cli_parse(&program, argc, argv);
    return cli_finish(&cli, run(&cli));
}
