#include "pipeline/plan/scene_commands.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "pipeline/plan/plan.h"
#include "pipeline/plan/plan_marks.h"
#include "pipeline/plan/plan_text.h"
#include "pipeline/plan/scene_check.h"
#include "pipeline/scene/scene_part.h"
#include "pipeline/speak/error.h"

/* ---- what a scene says ---- */

static int print_photos(const struct scene *scene)
{
    const struct scene_photos *photos = &scene->photos;
    for (long k = scene_photo_next(scene, photos->first - 1); k <= photos->last; k = scene_photo_next(scene, k)) {
        char *path = scene_photo_path(scene, k);
        if (!path)
            return -1;
        printf("%ld\t%s\n", k, path);
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

/* ---- what has to be made, and what is ---- */

/* The folder of this very program: the others lie beside it. Into `folder`; -1 with an error. */
static int find_programs(char folder[PATH_MAX])
{
    ssize_t length = readlink("/proc/self/exe", folder, PATH_MAX - 1);
    char *slash = length > 0 ? memrchr(folder, '/', (size_t)length) : NULL;
    if (!slash)
        return error_failed("/proc/self/exe does not tell where the programs are: is /proc mounted?");
    *slash = '\0';
    return 0;
}

/* What needs a plan; the folder of the results need not be there, but for SCENE_BEGIN. */
static int run_plan(enum scene_command command, const struct plan *plan, int make)
{
    switch (command) {
    case SCENE_PLAN:
        return make ? plan_print_make(plan, stdout) : plan_print_json(plan, stdout);
    case SCENE_BEGIN:
        return plan_begin(plan);
    case SCENE_STATUS:
        return plan_print_status(plan, stdout);
    default:
        plan_print_results(plan, stdout);
        return 0;
    }
}

static int with_plan(enum scene_command command, const struct scene *scene, const struct scene_words *words)
{
    char programs[PATH_MAX], *beside = NULL;
    struct plan plan;
    if (asprintf(&beside, "%s/results", scene->folder) < 0)
        return error_memory("plan");
    struct plan_words about = words->plan;
    about.programs = programs;
    if (!*about.out)
        about.out = beside;
    int status = find_programs(programs) || plan_make(&plan, scene, &about) ? -1 : 0;
    if (!status) {
        status = run_plan(command, &plan, words->make);
        plan_free(&plan);
    }
    free(beside);
    return status;
}

const char *const SCENE_COMMANDS[] = {"check", "photos", "series", "part", "plan", "begin", "status", "results", NULL};

int scene_run(enum scene_command command, const struct scene_words *words)
{
    struct scene scene;
    if (scene_read(words->scene, &scene))
        return -1;
    int status = command == SCENE_CHECK    ? scene_check(&scene)
                 : command == SCENE_PHOTOS ? print_photos(&scene)
                 : command == SCENE_SERIES ? print_series(&scene)
                 : command == SCENE_PART   ? print_part(&scene, words->part)
                                           : with_plan(command, &scene, words);
    scene_free(&scene);
    return status;
}
