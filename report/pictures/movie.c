#include "report/pictures/movie.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pipeline/speak/error.h"
#include "pipeline/speak/progress.h"
#include "pipeline/draw/canvas.h"
#include "pipeline/packing/packing_file.h"
#include "report/pictures/force_map.h"
#include "report/states/method_choice.h"

/* What all frames share. */
struct common {
    struct map_box box;
    double mean_fn;
    struct methods methods;
    const char *method; /* NULL: each file's default */
};

static int look_at(const struct film *film, const char *path, struct common *common)
{
    struct packing packing;
    const struct forces *forces;
    if (packing_read(path, &packing))
        return -1;
    int result = method_choose(&packing, path, film->method, &forces);
    map_box_add(&common->box, &packing);
    common->methods.states += packing.force_count > 0;
    for (size_t f = 0; f < packing.force_count; f++)
        methods_add(&common->methods, packing.forces[f].method, packing.forces[f].converged,
                    map_mean_fn(&packing.forces[f]));
    packing_free(&packing);
    return result;
}

static int look_at_all(const struct film *film, char *const paths[], size_t count, struct common *common)
{
    *common = (struct common){.box = MAP_BOX_NONE};
    for (size_t k = 0; k < count; k++)
        if (look_at(film, paths[k], common))
            return -1;
    common->method = film->method ? film->method : methods_common(&common->methods);
    common->mean_fn = methods_mean_fn(&common->methods, common->method);
    return 0;
}

static int draw_frame(struct map *map, const char *frame_path)
{
    struct canvas canvas;
    if (map_measure(map) || canvas_begin(&canvas, frame_path, map->width, map->height))
        return -1;
    if (map_draw(map, canvas.cairo)) {
        canvas_discard(&canvas);
        return -1;
    }
    return canvas_commit(&canvas);
}

static int read_photo(const struct scene *scene, long index, struct photo *photo)
{
    struct photo_request request = {.channel = PHOTO_GREY_OF_RGB};
    char *path = scene_photo_path(scene, index);
    int result = path ? photo_read(path, &request, photo) : -1;
    free(path);
    return result;
}

static int film_frame(const struct film *film, const struct common *common, const char *path, const char *folder)
{
    struct packing packing;
    struct photo photo = {0};
    const char *base = basename(path);
    char name[256], *frame_path = NULL;
    if (packing_read(path, &packing))
        return -1;
    snprintf(name, sizeof name, "%.*s", (int)strcspn(base, "."), base);
    struct map map = {
        .packing = &packing, .title = name, .width = film->width, .mean_fn = common->mean_fn, .box = &common->box};
    int result = method_choose(&packing, path, packing.force_count ? common->method : NULL, &map.forces);
    if (result == 0 && film->scene) {
        result = read_photo(film->scene, (long)packing.info.index, &photo);
        map.photo = &photo;
        map.scene = film->scene;
    }
    if (result == 0 && asprintf(&frame_path, "%s/%s.png", folder, name) < 0) {
        frame_path = NULL;
        result = error_memory("a path");
    }
    if (result == 0)
        result = draw_frame(&map, frame_path);
    free(frame_path);
    photo_free(&photo);
    packing_free(&packing);
    return result;
}

int film_write(const struct film *film, char *const paths[], size_t count, const char *folder)
{
    struct common common;
    struct progress progress;
    int result = 0;
    if (look_at_all(film, paths, count, &common))
        return -1;
    int is_new = mkdir(folder, 0777) == 0;
    if (!is_new && errno != EEXIST)
        return error_failed("%s: the folder cannot be made: %s: check the path", folder, strerror(errno));
    progress_begin(&progress, "frames", count);
    for (size_t k = 0; k < count && result == 0; k++) {
        result = film_frame(film, &common, paths[k], folder);
        progress_step(&progress);
    }
    progress_end(&progress);
    if (result && is_new)
        rmdir(folder); /* stays when frames are in it */
    return result;
}
