/* render: the photo of a virtual packing, and what is exactly where in it. */
#include <stdlib.h>

#include "pipeline/command/cli.h"
#include "pipeline/files/read_record.h"
#include "pipeline/speak/error.h"
#include "pipeline/packing/packing_file.h"
#include "simulation/render/render.h"
#include "simulation/render/render_truth.h"

const char *argp_program_bug_address = NULL;

struct options {
    struct cli cli;
    const char *truth;
};

static int parse(int key, char *argument, struct argp_state *state)
{
    struct options *options = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->cli;
        return 0;
    case ARGP_KEY_ARG:
        if (options->truth)
            argp_error(state, "one packing at a time: give one N.truth.hdf");
        options->truth = argument;
        return 0;
    case ARGP_KEY_END:
        if (!options->truth)
            argp_error(state, "give the packing to photograph: N.truth.hdf");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static int run(const struct options *options)
{
    struct scene scene = {0};
    struct optics optics = {0};
    struct packing packing = {0};
    struct photo photo = {0};
    struct photo_truth truth = {0};
    char *truth_path = NULL;
    int status = -1;
    if (scene_read(options->cli.scene, &scene) || optics_read(&scene, &optics) ||
        packing_read(options->truth, &packing))
        goto done;
    long index = packing.info.index >= 0 ? (long)packing.info.index : 0;
    if (render(&packing, &optics, &scene, index, &photo, &truth) ||
        !(truth_path = photo_truth_path(options->cli.output)))
        goto done;
    if (photo_write(options->cli.output, &photo) == 0)
        status = photo_truth_write(truth_path, &truth, &scene, index, options->truth);
done:
    free(truth_path);
    photo_truth_free(&truth);
    photo_free(&photo);
    packing_free(&packing);
    optics_free(&optics);
    scene_free(&scene);
    return status;
}

static const struct argp_child children[] = {CLI_CHILD, {0}};
static const struct argp parser = {
    .parser = parse,
    .args_doc = "N.truth.hdf",
    .doc = "Take the photo of a virtual packing.\n\n"
           "Reads a packing that `simulate` wrote and the scene's size_px, scale_m_per_px, origin_px and \"optics\"; "
           "writes a 16-bit TIFF and, beside it, N.photo-truth.hdf: the exact centre, radius, rim shape and angle of "
           "every grain in that photo, corrected and as seen, and the contacts of the faces as drawn."
           "\vExample:\n  render --scene scene.json truth/0000.truth.hdf -o photos/0000.tif",
    .children = children};

int main(int argc, char **argv)
{
    struct options options = {.cli = CLI_DEFAULT};
    read_record_begin();
    cli_parse(&parser, argc, argv, &options);
    return cli_finish(&options.cli, run(&options));
}
