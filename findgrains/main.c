#include <math.h>
#include <stdlib.h>

#include "pipeline/command/cli.h"
#include "pipeline/files/read_record.h"
#include "pipeline/draw/canvas.h"
#include "pipeline/speak/error.h"
#include "pipeline/state/state.h"
#include "findgrains/picture/overlay.h"
#include "findgrains/settings.h"

static const char doc[] =
    "Find the grains of one photo: centre, radius and (where the rims ask for it) elliptic shape, in pixels, with "
    "standard errors.\n\nNothing has to be tuned: grey levels, blur and noise are taken from the photo. From the scene "
    "it uses photos.size_px and photos.channel, frame (where grains can be; left out: found from the grains that lean "
    "against it, if there is one), grains.radius_px (left out: found from the photo, largest grains first; give it "
    "when "
    "grains differ in size by more than two octaves and the small ones are few) and findgrains.shape (auto, circle or "
    "ellipse).\v"
    "Example: findgrains --scene scene.json --picture 0000.png photos/0000.tif -o 0000.grains.hdf";

struct arguments {
    struct cli cli;
    const char *photo, *picture, *refine, *added, *removed;
};

static const struct argp_option option_table[] = {
    {"picture", 'p', "P.png", 0,
     "Also draw the circles over the photo, flagged ones dashed in vermillion, with row numbers where there is room. "
     "Small photos are magnified up to 4 times, large ones shrunk to 1/2, 1/3 ...: the caption says how much. Ticks "
     "are "
     "in px of the photo: read places and radii (--add, --remove) by them",
     0},
    {"refine", 'r', "N.tracks.hdf", 0,
     "Do not search: measure the grains of this file again, on a later photo; row k stays grain k. Radii of many "
     "photos "
     "can be averaged (contacts --radii)",
     0},
    {"add", 'a', "LIST.txt", 0,
     "Grains that were missed, one \"x y radius\" (px of the photo) per line; they are measured like others", 0},
    {"remove", 'd', "LIST.txt", 0, "False circles, one \"x y\" (px of the photo, anywhere inside) per line", 0},
    {0}};

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct arguments *arguments = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &arguments->cli;
        return 0;
    case 'p':
        arguments->picture = text;
        return 0;
    case 'r':
        arguments->refine = text;
        return 0;
    case 'a':
        arguments->added = text;
        return 0;
    case 'd':
        arguments->removed = text;
        return 0;
    case ARGP_KEY_END:
        if (arguments->refine && (arguments->added || arguments->removed))
            argp_error(state, "--refine keeps the rows of its file: correct the list where the grains were found");
        return 0;
    case ARGP_KEY_ARG:
        if (arguments->photo)
            argp_error(state, "one photo at a time: '%s' is one too many", text);
        arguments->photo = text;
        return 0;
    case ARGP_KEY_NO_ARGS:
        argp_error(state, "which photo? Give one TIFF file");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static int write_file(const struct arguments *arguments, const struct scene *scene, const struct find_options *options,
                      const struct photo_grains *grains, const struct find_notes *notes)
{
    const char *const inputs[] = {arguments->photo, arguments->refine};
    struct provenance provenance = PROVENANCE_DEFAULT;
    char *parameters = settings_print(options), *found = settings_print_notes(notes);
    int status = -1;
    provenance.stage = "findgrains";
    provenance.coordinates = "seen";
    provenance.parameters = parameters;
    provenance.scene = scene;
    provenance.input_paths = inputs;
    provenance.input_count = arguments->refine ? 2 : 1;
    provenance.index = scene_photo_index(scene, arguments->photo);
    provenance.time_s = scene_time(scene, (long)provenance.index);
    struct state_writer *writer = parameters && found ? state_create(arguments->cli.output, &provenance) : NULL;
    if (writer) {
        if (state_write(writer, "grains", &PHOTO_GRAINS, grains) || state_write_text(writer, "grains", "found", found))
            state_discard(writer);
        else
            status = state_commit(writer);
    }
    free(parameters);
    free(found);
    return status;
}

static int read_known(const char *path, struct photo_grains *known)
{
    static const char *const needed[] = {"x_px", "y_px", "radius_px", NULL};
    struct state *state = state_open(path);
    int status = state ? state_read(state, "grains", &PHOTO_GRAINS, needed, known) : -1;
    state_close(state);
    return status;
}

static int find(const struct arguments *arguments, const struct photo *photo, const struct find_options *options,
                struct photo_grains *grains, struct find_notes *notes)
{
    struct photo_grains known = {0};
    if (arguments->refine && read_known(arguments->refine, &known))
        return -1;
    int status = arguments->refine ? find_known_grains(photo, options, &known, grains, notes)
                                   : find_grains(photo, options, grains, notes);
    table_free(&PHOTO_GRAINS, &known);
    return status ? error_context("%s", arguments->photo) : 0;
}

static int work(const struct arguments *arguments, const struct scene *scene, struct find_options *options,
                struct photo *photo, struct photo_grains *grains)
{
    struct find_notes notes;
    const struct photo_request request = scene_photo_request(scene);
    if (settings_read(scene, options) || photo_read(arguments->photo, &request, photo) ||
        corrections_check(options->corrections, photo->width, photo->height) ||
        find(arguments, photo, options, grains, &notes) ||
        (arguments->picture && overlay_write(arguments->picture, photo, grains, &notes)) ||
        write_file(arguments, scene, options, grains, &notes))
        return -1;
    size_t flagged = find_count_flagged(grains);
    log_event("findgrains", "grains", (double)grains->count, "flagged", (double)flagged, "blur_px", notes.blur_px,
              "noise", notes.noise, "window_px", notes.window_px, NULL);
    return cli_flagged(&arguments->cli, flagged, grains->count, "grains are flagged");
}

static int run(const struct arguments *arguments)
{
    struct scene scene = {0};
    struct photo photo = {0};
    struct photo_grains grains = {0};
    struct corrections corrections = {0};
    struct find_options options = {.corrections = &corrections};
    int status = overlay_check_path(arguments->picture);
    if (!status)
        status = scene_read(arguments->cli.scene, &scene);
    if (!status && arguments->added)
        status = corrections_read_added(arguments->added, &corrections);
    if (!status && arguments->removed)
        status = corrections_read_removed(arguments->removed, &corrections);
    if (!status)
        status = work(arguments, &scene, &options, &photo, &grains);
    corrections_free(&corrections);
    table_free(&PHOTO_GRAINS, &grains);
    photo_free(&photo);
    scene_free(&scene);
    return status;
}

int main(int argc, char **argv)
{
    static const struct argp_child children[] = {CLI_CHILD, {0}};
    static const struct argp parser = {option_table, parse, "PHOTO.tif", doc, children, NULL, NULL};
    struct arguments arguments = {.cli = CLI_DEFAULT};
    read_record_begin();
    cli_parse(&parser, argc, argv, &arguments);
    int status = cli_finish(&arguments.cli, run(&arguments));
    canvas_forget_fonts();
    return status;
}
