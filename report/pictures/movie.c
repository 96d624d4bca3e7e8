/* Two passes over the files: the first finds what all frames share - the box around everything, the method, and the
 * mean force that is the unit of width - so that frames can be compared; the second draws. One packing is in memory at
 * a time. */
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
#include "pipeline/packing/packing_file.h"
#include "report/pictures/force_map.h"
#include "report/states/method_choice.h"

/* What all frames share. */
struct common {
    struct force_map_box box;
    double mean_fn;
    struct methods methods;
    const char *method; /* NULL: each file's default */
};

/* Add one file to it. Its methods count all, whichever is drawn: the choice is made when all are known. */
static int look_at(const struct movie *movie, const char *path, struct common *common)
{
    struct packing packing;
    const struct forces *forces;
    if (packing_read(path, &packing))
        return -1;
    int result = method_choose(&packing, path, movie->method, &forces);
    force_map_box_add(&common->box, &packing);
    common->methods.states += packing.force_count > 0;
    for (size_t f = 0; f < packing.force_count; f++)
        methods_add(&common->methods, packing.forces[f].method, packing.forces[f].converged,
                    force_map_mean_fn(&packing.forces[f]));
    packing_free(&packing);
    return result;
}

static int look_at_all(const struct movie *movie, char *const paths[], size_t count, struct common *common)
{
    *common = (struct common){.box = FORCE_MAP_BOX_NONE};
    for (size_t k = 0; k < count; k++)
        if (look_at(movie, paths[k], common))
            return -1;
    common->method = movie->method ? movie->method : methods_common(&common->methods);
    common->mean_fn = methods_mean_fn(&common->methods, common->method);
    return 0;
}

/* The photo of that number of the scene, grey. */
static int read_photo(const struct scene *scene, long index, struct photo *photo)
{
    struct photo_request request = {.channel = PHOTO_GREY_OF_RGB};
    char *path = scene_photo_path(scene, index);
    int result = path ? photo_read(path, &request, photo) : -1;
    free(path);
    return result;
}

/* DIR/NAME.png of one file; a packing without forces is drawn with its contacts. */
static int write_frame(const struct movie *movie, const struct common *common, const char *path, const char *folder)
{
    struct packing packing;
    struct photo photo = {0};
    const char *base = basename(path);
    char name[256], *frame_path = NULL;
    if (packing_read(path, &packing))
        return -1;
    snprintf(name, sizeof name, "%.*s", (int)strcspn(base, "."), base);
    struct force_map map = {
        .packing = &packing, .title = name, .width = movie->width, .mean_fn = common->mean_fn, .box = &common->box};
    int result = method_choose(&packing, path, packing.force_count ? common->method : NULL, &map.forces);
    if (result == 0 && movie->scene) {
        result = read_photo(movie->scene, (long)packing.info.index, &photo);
        map.photo = &photo;
        map.scene = movie->scene;
    }
    if (result == 0 && asprintf(&frame_path, "%s/%s.png", folder, name) < 0) {
        frame_path = NULL;
        result = error_memory("a path");
    }
    if (result == 0)
        result = force_map_write(&map, frame_path);
    free(frame_path);
    photo_free(&photo);
    packing_free(&packing);
    return result;
}

int movie_write(const struct movie *movie, char *const paths[], size_t count, const char *folder)
{
    struct common common;
    struct progress progress;
    int result = 0;
    if (look_at_all(movie, paths, count, &common))
        return -1;
    int is_new = mkdir(folder, 0777) == 0;
    if (!is_new && errno != EEXIST)
        return error_failed("%s: the folder cannot be made: %s: check the path", folder, strerror(errno));
    progress_begin(&progress, "frames", count);
    for (size_t k = 0; k < count && result == 0; k++) {
        result = write_frame(movie, &common, paths[k], folder);
        progress_step(&progress);
    }
    progress_end(&progress);
    if (result && is_new)
        rmdir(folder); /* stays when frames are in it */
    return result;
}
