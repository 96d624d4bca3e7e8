#include "pipeline/scene/scene.h"

#include <math.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/files/pattern.h"
#include "pipeline/files/json.h"

static int outside_allowed;

void scene_allow_outside(void)
{
    outside_allowed = 1;
}

int scene_outside_allowed(void)
{
    return outside_allowed;
}

/* Where symbolic links lead: into the scene's folder, or out of it? What is not there leads nowhere. */
static int leads_outside(const struct scene *scene, const char *path)
{
    char *target = realpath(path, NULL), *folder = target ? realpath(scene->folder, NULL) : NULL;
    size_t length = folder ? strlen(folder) : 0;
    int root = length == 1, outside = folder && !root && (strncmp(target, folder, length) || target[length] != '/');
    free(target);
    free(folder);
    return outside;
}

char *scene_join(const struct scene *scene, const char *relative)
{
    char *path = NULL;
    int folder = strcmp(scene->folder, ".") != 0 && *relative != '/', root = !strcmp(scene->folder, "/");
    if (asprintf(&path, "%s%s%s", folder ? scene->folder : "", folder && !root ? "/" : "", relative) < 0) {
        error_set(EXIT_FAILED, "out of memory: %s: use a machine with more memory", scene->path);
        return NULL;
    }
    if (!outside_allowed && leads_outside(scene, path)) {
        error_set(EXIT_INPUT,
                  "%s: names %s, and a symbolic link there leads out of the scene's folder: copy the file, or give "
                  "--allow-outside",
                  scene->path, path);
        free(path);
        return NULL;
    }
    return path;
}

void scene_free(struct scene *scene)
{
    free(scene->path);
    free(scene->folder);
    free(scene->name);
    free(scene->photos.pattern);
    free(scene->photos.skip);
    free(scene->lens);
    free(scene->drift_patches);
    free(scene->frame.markers);
    free(scene->loads);
    json_free(scene->json);
    memset(scene, 0, sizeof *scene);
}

const cJSON *scene_section(const struct scene *scene, const char *name)
{
    return cJSON_GetObjectItemCaseSensitive(json_root(scene->json), name);
}

int scene_lacks(const struct scene *scene, const char *key, const char *why)
{
    return error_input("%s: '%s' is missing: %s", scene->path, key, why);
}

char *scene_photo_path(const struct scene *scene, long index)
{
    if (!scene->photos.pattern) {
        scene_lacks(scene, "photos.pattern", "write for example \"photos/{index:04d}.tif\"");
        return NULL;
    }
    char *name = pattern_format(scene->photos.pattern, index);
    char *path = name ? scene_join(scene, name) : NULL;
    free(name);
    return path;
}

long scene_photo_index(const struct scene *scene, const char *path)
{
    long index = scene->photos.pattern ? pattern_index(scene->photos.pattern, path) : -1;
    return index >= scene->photos.first && index <= scene->photos.last ? index : -1;
}

int scene_photo_skipped(const struct scene *scene, int64_t index)
{
    size_t low = 0, high = scene->photos.skip_count;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (scene->photos.skip[middle] < index)
            low = middle + 1;
        else
            high = middle;
    }
    return low < scene->photos.skip_count && scene->photos.skip[low] == index;
}

long scene_photo_next(const struct scene *scene, long index)
{
    do
        index++;
    while (index <= scene->photos.last && scene_photo_skipped(scene, index));
    return index;
}

double scene_time(const struct scene *scene, long index)
{
    return index >= 0 ? (double)(index - scene->photos.first) * scene->photos.interval_s : NAN;
}

struct photo_request scene_photo_request(const struct scene *scene)
{
    return (struct photo_request){
        .width = scene->photos.width, .height = scene->photos.height, .channel = scene->photos.channel};
}

struct vec scene_metres(const struct scene *scene, struct vec px)
{
    return vec(scene->scale * (px.x - scene->origin_px.x), -scene->scale * (px.y - scene->origin_px.y));
}

struct vec scene_pixels(const struct scene *scene, struct vec m)
{
    return vec(scene->origin_px.x + m.x / scene->scale, scene->origin_px.y - m.y / scene->scale);
}
