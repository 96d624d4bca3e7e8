/* findgrains: the grains of one photo, in px. */
#include "findgrains/grains_of_photo.h"
#include "findgrains/picture/overlay.h"
#include "pipeline/command/cli.h"
#include "pipeline/files/read_record.h"
#include "pipeline/draw/canvas.h"
#include "pipeline/speak/error.h"

static const char doc[] =
    "Find the grains of one photo: centre, radius and (where the rims ask for it) elliptic shape, in pixels, with "
    "standard errors.\n\nNothing has to be tuned: grey levels, blur and noise are taken from the photo. From the "
    "scene it uses photos.size_px and photos.channel, frame (where grains can be; left out: found from the grains "
    "that lean against it, if there is one), grains.radius_px (left out: found from the photo, largest grains first; "
    "give it when grains differ in size by more than two octaves and the small ones are few) and findgrains.shape "
    "(auto, circle or ellipse).\v"
    "Example: findgrains --scene scene.json --picture 0000.png photos/0000.tif -o 0000.grains.hdf";

struct arguments {
    struct cli cli;
    struct photo_paths paths;
};

#define AT(field) .at = offsetof(struct arguments, field)
static const struct option_row rows[] = {
    {"picture", NULL, OPTION_OUTPUT, AT(paths.picture), "P.png", .letter = 'p',
     .help = "Also draw the circles over the photo, flagged ones dashed in vermillion, with row numbers where there is "
             "room. Small photos are magnified up to 4 times, large ones shrunk to 1/2, 1/3 ...: the caption says how "
             "much. Ticks are in px of the photo: read places and radii (--add, --remove) by them"},
    {"refine", NULL, OPTION_TEXT, AT(paths.refine), "N.tracks.hdf", .letter = 'r',
     .help = "Do not search: measure the grains of this file again, on a later photo; row k stays grain k. Radii of "
             "many photos can be averaged (contacts --radii)"},
    {"add", NULL, OPTION_TEXT, AT(paths.added), "LIST.txt", .letter = 'a',
     .help = "Grains that were missed, one \"x y radius\" (px of the photo) per line; they are measured like others"},
    {"remove", NULL, OPTION_TEXT, AT(paths.removed), "LIST.txt", .letter = 'd',
     .help = "False circles, one \"x y\" (px of the photo, anywhere inside) per line"},
    {0}};

/* For struct program: corrections change the list, and --refine keeps it. */
static int check(void *options)
{
    const struct photo_paths *paths = &((const struct arguments *)options)->paths;
    if (paths->refine && (paths->added || paths->removed))
        return error_input("--refine keeps the rows of its file: correct the list where the grains were found");
    return 0;
}

/* The ending of the picture is looked at first: finding grains takes long. */
static int run(struct arguments *arguments)
{
    struct scene scene = {0};
    struct photo_found found;
    arguments->paths.photo = arguments->cli.inputs.paths[0];
    arguments->paths.output = arguments->cli.output;
    int status = overlay_check_path(arguments->paths.picture) || scene_read(arguments->cli.scene, &scene) ||
                         grains_of_photo(&scene, &arguments->paths, &found)
                     ? -1
                     : 0;
    scene_free(&scene);
    if (!status)
        status = cli_flagged(&arguments->cli, found.flagged, found.grains, "grains are flagged");
    if (!status)
        cli_summary(&arguments->cli, "%zu grains, %zu flagged, radii %.3g-%.3g px", found.grains, found.flagged,
                    found.least_px, found.most_px);
    return status;
}

int main(int argc, char **argv)
{
    struct arguments arguments = {.cli = CLI_DEFAULT};
    const struct program program = {
        "PHOTO.tif", doc, rows, &arguments, NULL, 1, 1, "which photo? Give one photo at a time, a TIFF file", check};
    read_record_begin();
    cli_parse(&program, argc, argv);
    int status = cli_finish(&arguments.cli, run(&arguments));
    canvas_forget_fonts();
    return status;
}
