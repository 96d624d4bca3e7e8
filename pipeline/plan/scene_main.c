#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "pipeline/command/cli.h"
#include "pipeline/speak/error.h"
#include "pipeline/packing/loads.h"
#include "pipeline/scene/scene.h"
#include "pipeline/scene/scene_part.h"

enum command { CHECK, PHOTOS, SERIES, PART };
static const char *const commands[] = {"check", "photos", "series", "part", NULL};
/* Whose part: the stages, and the sections of simulate and render. */
static const char *const stages[] = {"findgrains", "tracker",    "contacts", "forces",
                                     "report",     "simulation", "optics",   NULL};

struct arguments {
    struct cli cli;
    int command; /* -1: not yet given */
    const char *scene, *stage;
};

static const char help[] =
    "Read a scene and say what is in it.\v"
    "check: is every key known, every number in its range, every file that the scene names there? Prints nothing when "
    "all is well.\n"
    "photos: index and path of every photo, one per line, separated by a tabulator.\n"
    "series: first, last and reference photo, photos per block, lens and loads: key and value, separated by a "
    "tabulator.\n"
    "part: the part of the scene that a stage's numbers depend on, as JSON; STAGE: findgrains, tracker, contacts, "
    "forces, report, simulation or optics.\n\n"
    "Example:\n  scene check my-test/scene.json";

static int choose(const char *what, const char *text, const char *const words[], int *choice)
{
    *choice = option_choice(text, words);
    return *choice < 0 ? error_context("%s %s", what, text) : 0;
}

static int parse(void *options)
{
    struct arguments *arguments = options;
    const struct cli_inputs *words = &arguments->cli.inputs;
    int stage = 0;
    if (choose("command", words->paths[0], commands, &arguments->command))
        return -1;
    if (words->count != (arguments->command == PART ? 3 : 2))
        return error_input("which scene%s? See --help", arguments->command == PART ? ", and which stage" : "");
    if (arguments->command == PART && choose("stage", words->paths[2], stages, &stage))
        return -1;
    arguments->scene = words->paths[1];
    arguments->stage = stages[stage];
    return 0;
}

static int check_file(const struct scene *scene, const char *path)
{
    if (path && access(path, R_OK))
        return error_input("%s: names %s, which cannot be read: put it there", scene->path, path);
    return 0;
}

static int check_loads(const struct scene *scene)
{
    const struct scene_photos *photos = &scene->photos;
    size_t count = (size_t)(photos->last - photos->first + 1);
    int64_t *numbers = malloc(count * sizeof *numbers);
    if (!numbers)
        return error_memory("the numbers of the photos");
    for (size_t k = 0; k < count; k++)
        numbers[k] = photos->first + (int64_t)k;
    int status = loads_check(scene->loads, numbers, count);
    free(numbers);
    return status;
}

static int check(const struct scene *scene)
{
    if (check_file(scene, scene->lens) || check_file(scene, scene->loads))
        return -1;
    if (scene->loads && scene->photos.pattern && check_loads(scene))
        return -1;
    for (long index = scene->photos.first; scene->photos.pattern && index <= scene->photos.last; index++) {
        char *path = scene_photo_path(scene, index);
        int status = path ? check_file(scene, path) : -1;
        free(path);
        if (status)
            return -1;
    }
    return 0;
}

static int print_photos(const struct scene *scene)
{
    for (long index = scene->photos.first; index <= scene->photos.last; index++) {
        char *path = scene_photo_path(scene, index);
        if (!path)
            return -1;
        printf("%ld\t%s\n", index, path);
        free(path);
    }
    return 0;
}

static int print_series(const struct scene *scene)
{
    const struct scene_photos *photos = &scene->photos;
    if (!photos->pattern)
        return scene_lacks(scene, "photos.pattern", "write for example \"photos/{index:04d}.tif\"");
    printf("first\t%ld\nlast\t%ld\nreference\t%ld\nblock\t%d\n", photos->first, photos->last, photos->reference,
           photos->block);
    if (scene->lens)
        printf("lens\t%s\n", scene->lens);
    if (scene->loads)
        printf("loads\t%s\n", scene->loads);
    return 0;
}

static int print_part(const struct scene *scene, const char *stage)
{
    char *text = scene_part(scene, stage);
    if (!text)
        return -1;
    puts(text);
    free(text);
    return 0;
}

static int run(const struct arguments *arguments)
{
    struct scene scene;
    int status = scene_read(arguments->scene, &scene);
    if (status)
        return -1;
    switch ((enum command)arguments->command) {
    case CHECK:
        status = check(&scene);
        break;
    case PHOTOS:
        status = print_photos(&scene);
        break;
    case SERIES:
        status = print_series(&scene);
        break;
    case PART:
        status = print_part(&scene, arguments->stage);
        break;
    }
    scene_free(&scene);
    return status;
}

int main(int argc, char **argv)
{
    struct arguments arguments = {.cli = CLI_NEEDING(0), .command = -1};
    const struct program program = {"check SCENE.json\nphotos SCENE.json\nseries SCENE.json\npart SCENE.json STAGE",
                                    help,
                                    NULL,
                                    &arguments,
                                    NULL,
                                    2,
                                    3,
                                    "which scene? See --help",
                                    parse};
    cli_parse(&program, argc, argv);
    return cli_finish(&arguments.cli, run(&arguments));
}
