#include "findgrains/settings.h"

#include "pipeline/command/option_table.h"
#include "pipeline/speak/error.h"
#include "pipeline/scene/lens.h"
#include "pipeline/files/json.h"

#include <math.h>
#include <string.h>

static const char *const shapes[] = {"auto", "circle", "ellipse", NULL};

/* The frame's sides are straight; through the lens they are seen bent between the corners. */
static int read_bend(const struct scene *scene, struct find_options *options)
{
    struct lens lens;
    options->frame_bend_px = 0;
    if (!scene->lens || !options->has_frame)
        return 0;
    if (lens_read(scene->lens, &lens))
        return -1;
    for (int k = 0; k < 4; k++)
        options->frame_bend_px =
            fmax(options->frame_bend_px, lens_bend(&lens, options->corners_px[k], options->corners_px[(k + 1) % 4]));
    return 0;
}

/* The frame and the range of radii are the experiment's, so they stand in the scene's own groups. */
int settings_read(const struct scene *scene, struct find_options *options)
{
    static const struct option_row rows[] = {
        {NULL, "shape", OPTION_CHOICE, offsetof(struct find_options, shape), .words = shapes}, {0}};
    options->shape = FIND_SHAPE_AUTO;
    options->radius_min_px = scene->grains.radius_min_px;
    options->radius_max_px = scene->grains.radius_max_px;
    options->has_frame = scene->frame.given;
    options->corner_radius_px = scene->frame.corner_radius_px;
    memcpy(options->corners_px, scene->frame.corners_px, sizeof options->corners_px);
    if (read_bend(scene, options))
        return -1;
    return options_read(rows, scene, "findgrains", 0, options);
}

/* Numbers that are not known are left out. */
static void add_number(cJSON *object, const char *key, double value)
{
    if (isfinite(value))
        cJSON_AddNumberToObject(object, key, value);
}

static void add_frame(cJSON *object, const struct find_options *options)
{
    cJSON *frame = cJSON_AddObjectToObject(object, "frame"), *corners = cJSON_AddArrayToObject(frame, "corners_px");
    for (int k = 0; k < 4; k++) {
        double corner[2] = {options->corners_px[k].x, options->corners_px[k].y};
        cJSON_AddItemToArray(corners, cJSON_CreateDoubleArray(corner, 2));
    }
    add_number(frame, "corner_radius_px", options->corner_radius_px);
    if (options->frame_bend_px > 0)
        add_number(frame, "bend_px", options->frame_bend_px);
}

/* x y radius of what was added, x y of what was removed: px, as in the lists. */
static void add_corrections(cJSON *object, const struct corrections *corrections)
{
    cJSON *list = cJSON_AddArrayToObject(object, "corrections");
    for (size_t k = 0; k < corrections->count; k++) {
        const struct correction *item = &corrections->items[k];
        double numbers[3] = {item->x, item->y, item->radius};
        cJSON_AddItemToArray(list, cJSON_CreateDoubleArray(numbers, item->radius > 0 ? 3 : 2));
    }
}

/* Takes the object. Memory that was out while the tree was built shows here too (json_print). */
static char *printed(cJSON *object)
{
    char *text = object ? json_print(object) : NULL;
    cJSON_Delete(object);
    if (!text)
        error_set(EXIT_FAILED, "out of memory: parameters: use a machine with more memory");
    return text;
}

char *settings_print(const struct find_options *options)
{
    cJSON *object = cJSON_CreateObject();
    add_number(object, "radius_min_px", options->radius_min_px);
    add_number(object, "radius_max_px", options->radius_max_px);
    cJSON_AddStringToObject(object, "shape", shapes[options->shape]);
    if (options->has_frame)
        add_frame(object, options);
    if (options->corrections && options->corrections->count)
        add_corrections(object, options->corrections);
    return printed(object);
}

static void add_found_frame(cJSON *object, const struct found_frame *found)
{
    cJSON *frame = cJSON_AddObjectToObject(object, "frame"), *corners = cJSON_AddArrayToObject(frame, "corners_px");
    cJSON *errors = cJSON_AddArrayToObject(frame, "s_corners_px");
    for (int k = 0; k < 4; k++) {
        double corner[2] = {found->corners[k].x, found->corners[k].y};
        cJSON_AddItemToArray(corners, cJSON_CreateDoubleArray(corner, 2));
        cJSON_AddItemToArray(errors, cJSON_CreateDoubleArray(found->s_corners[k], 2));
    }
    add_number(frame, "corner_radius_px", found->corner_radius);
    cJSON_AddItemToObject(frame, "touching", cJSON_CreateIntArray(found->touching, 4));
}

/* Levels in grey levels of the photo, lengths in px; errors of the frame's corners as standard deviations. */
char *settings_print_notes(const struct find_notes *notes)
{
    cJSON *object = cJSON_CreateObject();
    add_number(object, "void_level", notes->levels.void_level);
    add_number(object, "grain_level", notes->levels.grain_level);
    add_number(object, "threshold", notes->levels.threshold);
    add_number(object, "radius_min_px", notes->radius_min_px);
    add_number(object, "radius_max_px", notes->radius_max_px);
    add_number(object, "blur_px", notes->blur_px);
    add_number(object, "noise", notes->noise);
    add_number(object, "texture", notes->texture);
    add_number(object, "window_px", notes->window_px);
    add_number(object, "correlation", notes->correlation);
    cJSON_AddBoolToObject(object, "ellipses", notes->ellipses);
    if (notes->frame.found)
        add_found_frame(object, &notes->frame);
    return printed(object);
}
