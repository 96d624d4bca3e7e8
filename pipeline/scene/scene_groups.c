/* Each group is read in the same way: is it there, are its keys known, is each value in its range, do the values fit
 * each other. Every mistake is an error with file, line and column, found before any photo is opened. Ranges are
 * generous, but they keep every product that a program makes (pixels, cells, indices) in its type. */
#include "pipeline/scene/scene_groups.h"

#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/files/pattern.h"
#include "pipeline/files/json.h"

/* px per side of a photo; the largest index of a photo, which nine digits write. */
enum { MAX_SIDE_PX = 1000000, MAX_INDEX = 999999999 };
#define LEAST_SCALE 1e-12 /* m per px: finer than any microscope, and a million pixels are still some metres apart */

/* The member for an error's place; NULL when it is left out. Case counts. */
static const cJSON *item_of(const cJSON *object, const char *key)
{
    return cJSON_GetObjectItemCaseSensitive(object, key);
}

/* ---- paths ---- */

/* Neither absolute nor upwards. "..name" is a file like any other, hence the look at what follows the dots. */
static int check_inside(const struct json *json, const cJSON *item, const char *path)
{
    if (*path == '/')
        return json_error(json, item,
                          "an absolute path: give it relative to the scene's folder, or give --allow-outside");
    for (const char *part = path; part; part = strchr(part, '/')) {
        part += *part == '/';
        if (!strncmp(part, "..", 2) && (part[2] == '/' || part[2] == '\0'))
            return json_error(json, item,
                              "'..' in a path: keep the file in the scene's folder, or give --allow-outside");
    }
    return 0;
}

/* A path that a scene names: not empty, inside the scene's folder unless that is allowed, printable, short enough to
 * be joined to a folder within PATH_MAX. */
static int check_path(const struct json *json, const cJSON *item, const char *path)
{
    if (*path == '\0')
        return json_error(json, item, "an empty path: name a file in the scene's folder, or leave the key out");
    if (!scene_outside_allowed() && check_inside(json, item, path))
        return -1;
    for (const char *c = path; *c; c++)
        if ((unsigned char)*c < 0x20)
            return json_error(json, item, "a control character in a path: rename the file");
    if (strlen(path) >= PATH_MAX / 2)
        return json_error(json, item, "a path of more than %d characters: use a shorter one", PATH_MAX / 2);
    return 0;
}

/* The path of that key, joined to the scene's folder, to *path, which the scene owns. Left out: 0, and *path stays
 * NULL. */
static int read_path(const struct scene *scene, const char *key, char **path)
{
    const cJSON *root = json_root(scene->json);
    const char *relative;
    int there = json_string(scene->json, root, key, &relative);
    if (there <= 0)
        return there;
    if (check_path(scene->json, item_of(root, key), relative))
        return -1;
    return (*path = scene_join(scene, relative)) ? 0 : -1;
}

/* ---- root ---- */

/* The one key that every scene must have. */
static int read_name(struct scene *scene)
{
    const cJSON *root = json_root(scene->json);
    const char *name = "";
    int there = json_string(scene->json, root, "name", &name);
    if (there < 0)
        return -1;
    if (*name == '\0')
        return json_error(scene->json, there ? item_of(root, "name") : root,
                          "'name' is missing: write \"name\": \"what this experiment is\"");
    scene->name = strdup(name);
    return scene->name ? 0 : error_memory("scene");
}

/* Two numbers, each within +-limit. */
static int read_vec(const struct json *json, const cJSON *object, const char *key, double limit, struct vec *value)
{
    double xy[2];
    int there = json_numbers(json, object, key, 2, xy);
    if (there <= 0)
        return there;
    if (fabs(xy[0]) > limit || fabs(xy[1]) > limit)
        return json_error(json, item_of(object, key), "'%s' is too large: give numbers between -%g and %g", key, limit,
                          limit);
    *value = vec(xy[0], xy[1]);
    return 1;
}

int scene_read_root(struct scene *scene)
{
    const struct json *json = scene->json;
    const cJSON *root = json_root(json);
    if (read_name(scene) || json_number(json, root, "scale_m_per_px", LEAST_SCALE, 1, &scene->scale) < 0 ||
        read_vec(json, root, "origin_px", 1e9, &scene->origin_px) < 0 ||
        read_vec(json, root, "gravity_m_per_s2", 1e6, &scene->gravity) < 0 || read_path(scene, "lens", &scene->lens) ||
        read_path(scene, "loads", &scene->loads))
        return -1;
    return 0;
}

/* ---- photos ---- */

/* Pattern, first and last: all or none. The reference is the first photo unless the scene says another. */
static int read_pattern(struct scene *scene, const cJSON *object)
{
    struct scene_photos *photos = &scene->photos;
    const char *pattern;
    int there = json_string(scene->json, object, "pattern", &pattern);
    int first = json_integer(scene->json, object, "first", 0, MAX_INDEX, &photos->first);
    int last = first < 0 ? -1 : json_integer(scene->json, object, "last", 0, MAX_INDEX, &photos->last);
    if (there < 0 || last < 0)
        return -1;
    if (there != first || there != last)
        return json_error(scene->json, object, "'pattern', 'first' and 'last' belong together: give all three or none");
    photos->reference = photos->first;
    if (there && check_path(scene->json, item_of(object, "pattern"), pattern))
        return -1;
    const char *remedy = there ? pattern_check(pattern, photos->first == 0 && photos->last == 0) : NULL;
    if (remedy)
        return json_error(scene->json, item_of(object, "pattern"), "'%.200s' names no series of photos: %s", pattern,
                          remedy);
    if (photos->last < photos->first)
        return json_error(scene->json, item_of(object, "last"), "'last' is before 'first': swap them");
    if (there && !(photos->pattern = strdup(pattern)))
        return error_memory("scene");
    return 0;
}

/* [width, height], whole px; their product is limited, so later sizes in bytes fit. */
static int read_size(struct scene *scene, const cJSON *object)
{
    double size[2];
    int there = json_numbers(scene->json, object, "size_px", 2, size);
    if (there <= 0)
        return there;
    for (int k = 0; k < 2; k++)
        if (!(size[k] >= 1 && size[k] <= MAX_SIDE_PX) || size[k] != floor(size[k]))
            return json_error(scene->json, item_of(object, "size_px"),
                              "'size_px' must be two whole numbers: give [width, height] of the photos");
    if (size[0] * size[1] > (double)PHOTO_MAX_PIXELS)
        return json_error(scene->json, item_of(object, "size_px"), "more than %zu pixels: give the true size",
                          PHOTO_MAX_PIXELS);
    scene->photos.width = (int)size[0];
    scene->photos.height = (int)size[1];
    return 0;
}

/* PHOTO_GREY_ONLY when left out: a colour photo is then an error that asks for the channel. */
static int read_channel(struct scene *scene, const cJSON *object)
{
    static const char *const words[] = {"grey", "red", "green", "blue", NULL};
    static const enum photo_channel channels[] = {PHOTO_GREY_OF_RGB, PHOTO_RED, PHOTO_GREEN, PHOTO_BLUE};
    int choice = 0, there = json_choice(scene->json, object, "channel", words, &choice);
    scene->photos.channel = there > 0 ? channels[choice] : PHOTO_GREY_ONLY;
    return there < 0 ? -1 : 0;
}

static int ascending(const void *left, const void *right)
{
    long a = *(const long *)left, b = *(const long *)right;
    return (a > b) - (a < b);
}

static int read_skip(struct scene *scene, const cJSON *object)
{
    struct scene_photos *photos = &scene->photos;
    const cJSON *list;
    int there = json_array(scene->json, object, "skip", &list);
    if (there <= 0)
        return there;
    photos->skip = calloc((size_t)cJSON_GetArraySize(list) + 1, sizeof *photos->skip);
    if (!photos->skip)
        return error_memory("scene");
    for (const cJSON *item = list->child; item; item = item->next) {
        double number = cJSON_IsNumber(item) ? item->valuedouble : -1;
        if (!photos->pattern || number != floor(number) || number < (double)photos->first ||
            number > (double)photos->last)
            return json_error(scene->json, item,
                              "'skip' names photos that the series does not have: give numbers from 'first' to 'last'");
        if ((long)number == photos->reference)
            return json_error(scene->json, item,
                              "'skip' names the reference photo, which all others are compared with: give another "
                              "'reference'");
        photos->skip[photos->skip_count++] = (long)number;
    }
    qsort(photos->skip, photos->skip_count, sizeof *photos->skip, ascending);
    for (size_t k = 1; k < photos->skip_count; k++)
        if (photos->skip[k] == photos->skip[k - 1])
            return json_error(scene->json, list, "'skip' names photo %ld twice: name it once", photos->skip[k]);
    return 0;
}

int scene_read_photos(struct scene *scene)
{
    static const char *const keys[] = {"pattern", "first",   "last",  "reference", "interval_s",
                                       "size_px", "channel", "block", "skip",      NULL};
    const struct json *json = scene->json;
    struct scene_photos *photos = &scene->photos;
    const cJSON *object;
    long block = photos->block;
    int there = json_object(json, json_root(json), "photos", &object);
    if (there <= 0)
        return there;
    if (json_check_keys(json, object, keys) || read_pattern(scene, object) || read_size(scene, object) ||
        read_channel(scene, object) ||
        json_integer(json, object, "reference", photos->first, photos->last, &photos->reference) < 0 ||
        json_number(json, object, "interval_s", DBL_MIN, 1e9, &photos->interval_s) < 0 ||
        json_integer(json, object, "block", 1, 1000000, &block) < 0 || read_skip(scene, object))
        return -1;
    photos->block = (int)block;
    photos->given = 1;
    return 0;
}

/* ---- rectangles ---- */

/* x0 y0 x1 y1 with x0 < x1 and y0 < y1, inside the photo where its size is known. */
static int read_rect(const struct scene *scene, const cJSON *item, struct rect *rect)
{
    double v[4];
    int k = 0;
    const struct scene_photos *photos = &scene->photos;
    if (!cJSON_IsArray(item) || cJSON_GetArraySize(item) != 4)
        return json_error(scene->json, item, "a rectangle is four numbers: write [x0, y0, x1, y1]");
    for (const cJSON *number = item->child; number; number = number->next) {
        if (!cJSON_IsNumber(number) || fabs(number->valuedouble) > MAX_SIDE_PX)
            return json_error(scene->json, number, "a rectangle is four numbers in px: write [x0, y0, x1, y1]");
        v[k++] = number->valuedouble;
    }
    *rect = (struct rect){v[0], v[1], v[2], v[3]};
    if (!(rect->x0 < rect->x1) || !(rect->y0 < rect->y1))
        return json_error(scene->json, item, "an empty rectangle: write [x0, y0, x1, y1], x0 < x1 and y0 < y1");
    if (rect->x0 < -0.5 || rect->y0 < -0.5 || (photos->width && rect->x1 > photos->width) ||
        (photos->height && rect->y1 > photos->height))
        return json_error(scene->json, item, "a rectangle that leaves the photo: keep it inside photos.size_px");
    return 0;
}

int scene_read_drift_patches(struct scene *scene)
{
    const struct json *json = scene->json;
    const cJSON *list;
    int there = json_array(json, json_root(json), "drift_patches_px", &list);
    if (there <= 0)
        return there;
    size_t count = (size_t)cJSON_GetArraySize(list);
    scene->drift_patches = calloc(count + 1, sizeof *scene->drift_patches);
    if (!scene->drift_patches)
        return error_memory("scene");
    for (const cJSON *item = list->child; item; item = item->next)
        if (read_rect(scene, item, &scene->drift_patches[scene->drift_patch_count++]))
            return -1;
    return 0;
}

/* ---- frame ---- */

/* Clockwise as seen from the top left (y down), convex. */
static int check_corners(const struct json *json, const cJSON *item, const struct vec corners[4])
{
    static const char order[] = "give top-left, top-right, bottom-right, bottom-left, in px from the top left";
    for (int k = 0; k < 4; k++) {
        struct vec in = vec_sub(corners[k], corners[(k + 3) % 4]), out = vec_sub(corners[(k + 1) % 4], corners[k]);
        if (!(vec_cross(in, out) > 0))
            return json_error(json, item, "the corners are no convex frame in the right order: %s", order);
    }
    if (!(corners[CORNER_TOP_LEFT].x < corners[CORNER_TOP_RIGHT].x) ||
        !(corners[CORNER_TOP_LEFT].y < corners[CORNER_BOTTOM_LEFT].y))
        return json_error(json, item, "the corners begin at the wrong one: %s", order);
    return 0;
}

/* Four corners as seen, px. */
static int read_corners(struct scene *scene, const cJSON *frame)
{
    const struct json *json = scene->json;
    struct vec *corners = scene->frame.corners_px;
    const cJSON *list;
    int k = 0, there = json_array(json, frame, "corners_px", &list);
    if (there < 0)
        return -1;
    if (!there || cJSON_GetArraySize(list) != 4)
        return json_error(json, there ? list : frame,
                          "a frame needs four corners: write \"corners_px\": "
                          "[[x, y], [x, y], [x, y], [x, y]]");
    for (const cJSON *item = list->child; item; item = item->next, k++) {
        const cJSON *x = cJSON_GetArrayItem(item, 0), *y = cJSON_GetArrayItem(item, 1);
        if (!cJSON_IsArray(item) || cJSON_GetArraySize(item) != 2 || !cJSON_IsNumber(x) || !cJSON_IsNumber(y) ||
            fabs(x->valuedouble) > MAX_SIDE_PX || fabs(y->valuedouble) > MAX_SIDE_PX)
            return json_error(json, item, "a corner is two numbers in px: write [x, y]");
        corners[k] = vec(x->valuedouble, y->valuedouble);
    }
    return check_corners(json, list, corners);
}

/* px; corner discs of half of it would touch. */
static double shortest_side(const struct vec corners[4])
{
    double shortest = INFINITY;
    for (int k = 0; k < 4; k++)
        shortest = fmin(shortest, vec_norm(vec_sub(corners[(k + 1) % 4], corners[k])));
    return shortest;
}

static int read_marker(struct scene *scene, const cJSON *item, struct scene_marker *marker)
{
    static const char *const keys[] = {"wall", "rect", NULL};
    static const char *const walls[] = {"top", "bottom", "left", "right", NULL};
    int wall;
    if (!cJSON_IsObject(item))
        return json_error(scene->json, item,
                          "a marker is a group: write {\"wall\": \"top\", \"rect\": [x0, y0, x1, y1]}");
    if (json_check_keys(scene->json, item, keys))
        return -1;
    int there = json_choice(scene->json, item, "wall", walls, &wall);
    if (there < 0)
        return -1;
    if (!there || !item_of(item, "rect"))
        return json_error(scene->json, item,
                          "a marker needs 'wall' and 'rect': write {\"wall\": \"top\", \"rect\": "
                          "[x0, y0, x1, y1]}");
    strcpy(marker->wall, walls[wall]);
    return read_rect(scene, item_of(item, "rect"), &marker->rect);
}

/* The list of markers, owned by the scene. */
static int read_markers(struct scene *scene, const cJSON *object)
{
    const cJSON *list;
    struct scene_frame *frame = &scene->frame;
    int there = json_array(scene->json, object, "markers_px", &list);
    if (there <= 0)
        return there;
    frame->markers = calloc((size_t)cJSON_GetArraySize(list) + 1, sizeof *frame->markers);
    if (!frame->markers)
        return error_memory("scene");
    for (const cJSON *item = list->child; item; item = item->next)
        if (read_marker(scene, item, &frame->markers[frame->marker_count++]))
            return -1;
    return 0;
}

int scene_read_frame(struct scene *scene)
{
    static const char *const keys[] = {"corners_px", "corner_radius_px", "markers_px", NULL};
    const struct json *json = scene->json;
    const cJSON *object;
    int there = json_object(json, json_root(json), "frame", &object);
    if (there <= 0)
        return there;
    if (json_check_keys(json, object, keys) || read_corners(scene, object) ||
        json_number(json, object, "corner_radius_px", 0, shortest_side(scene->frame.corners_px) / 2,
                    &scene->frame.corner_radius_px) < 0 ||
        read_markers(scene, object))
        return -1;
    scene->frame.given = 1;
    return 0;
}

/* ---- grains ---- */

int scene_read_grains(struct scene *scene)
{
    static const char *const keys[] = {"radius_px", "density_kg_m3", "length_m", NULL};
    const struct json *json = scene->json;
    struct scene_grains *grains = &scene->grains;
    const cJSON *root = json_root(json), *object = NULL;
    double radius[2];
    if (json_object(json, root, "grains", &object) < 0)
        return -1;
    if (object) {
        int range = json_check_keys(json, object, keys) ? -1 : json_numbers(json, object, "radius_px", 2, radius);
        if (range < 0 || json_number(json, object, "density_kg_m3", DBL_MIN, 1e6, &grains->density) < 0 ||
            json_number(json, object, "length_m", DBL_MIN, 1e3, &grains->length) < 0)
            return -1;
        if (range && (!(radius[0] >= 1) || !(radius[0] <= radius[1]) || radius[1] > MAX_SIDE_PX))
            return json_error(json, item_of(object, "radius_px"),
                              "'radius_px' is no range: give [smallest, largest] in px, 1 or more");
        if (range) {
            grains->radius_min_px = radius[0];
            grains->radius_max_px = radius[1];
        }
    }
    if (vec_norm(scene->gravity) > 0 && isnan(grains->density))
        return json_error(json, item_of(root, "gravity_m_per_s2"),
                          "gravity needs masses: give grains.density_kg_m3 or leave gravity out");
    return 0;
}
