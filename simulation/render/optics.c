/* Reading the scene's section "optics". What it does not name stays at OPTICS_DEFAULT; unknown keys and numbers outside
 * their ranges are refused with line and column (pipeline/files/json.h). */
#include "simulation/render/optics.h"

#include <stdlib.h>

#include "pipeline/speak/error.h"
#include "pipeline/numbers/random.h"

static int read_range(const struct json *json, const cJSON *object, const char *key, double min, double max,
                      double *low, double *high)
{
    double pair[2];
    int there = json_numbers(json, object, key, 2, pair);
    if (there < 1)
        return there;
    if (!(pair[0] >= min && pair[1] >= pair[0] && pair[1] <= max))
        return json_error(json, cJSON_GetObjectItemCaseSensitive(object, key),
                          "'%s' must be [low, high] within %g and %g", key, min, max);
    *low = pair[0];
    *high = pair[1];
    return 1;
}

static int read_paint(const struct json *json, const cJSON *object, struct paint *paint)
{
    static const char *const keys[] = {"radius_px", "coverage", "level", NULL};
    if (!cJSON_IsObject(object))
        return json_error(json, object, "one paint must be an object with radius_px, coverage and level");
    if (json_check_keys(json, object, keys))
        return -1;
    int radius = read_range(json, object, "radius_px", 0.3, 1000, &paint->radius_min, &paint->radius_max);
    int level = read_range(json, object, "level", 0, 2, &paint->level_min, &paint->level_max);
    int coverage = json_number(json, object, "coverage", 0, 0.99, &paint->coverage);
    if (radius < 0 || level < 0 || coverage < 0)
        return -1;
    if (!radius || !level || !coverage)
        return json_error(json, object, "one paint needs radius_px, coverage and level");
    return 0;
}

static int read_paints(const struct json *json, const cJSON *object, struct surface *surface)
{
    const cJSON *list = NULL, *item;
    int there = json_array(json, object, "paint", &list);
    if (there < 1)
        return there;
    if (cJSON_GetArraySize(list) > PAINT_MAX)
        return json_error(json, list, "%d paints: give at most %d", cJSON_GetArraySize(list), PAINT_MAX);
    surface->paint_count = 0;
    cJSON_ArrayForEach(item, list) if (read_paint(json, item, &surface->paint[surface->paint_count++])) return -1;
    return 0;
}

/* The keys that every surface has. */
static int read_surface(const struct json *json, const cJSON *object, struct surface *surface)
{
    if (json_number(json, object, "level", 0, 2, &surface->level) < 0)
        return -1;
    return read_paints(json, object, surface) < 0 ? -1 : 0;
}

static int read_plain(const struct json *json, const cJSON *optics, const char *name, struct surface *surface)
{
    static const char *const keys[] = {"level", "paint", NULL};
    const cJSON *object = NULL;
    int there = json_object(json, optics, name, &object);
    if (there < 1)
        return there;
    return json_check_keys(json, object, keys) ? -1 : read_surface(json, object, surface);
}

/* A number of a section: where it goes, and its range. */
struct number {
    const char *key;
    double min, max, *to;
};
enum { NUMBERS_MOST = 8 };

/* The object `name` of the parent, which has these numbers, each of which may be missing, and no other key. 1 when it
 * is there, 0 when not, -1 for an error. */
static int read_numbers_of(const struct json *json, const cJSON *parent, const char *name, const struct number *numbers,
                           size_t count)
{
    const char *keys[NUMBERS_MOST + 1] = {NULL};
    const cJSON *object = NULL;
    int there = json_object(json, parent, name, &object);
    if (there < 1)
        return there;
    for (size_t k = 0; k < count; k++)
        keys[k] = numbers[k].key;
    if (json_check_keys(json, object, keys))
        return -1;
    for (size_t k = 0; k < count; k++)
        if (json_number(json, object, numbers[k].key, numbers[k].min, numbers[k].max, numbers[k].to) < 0)
            return -1;
    return 1;
}

/* What the faces of the rods look like beside their paint. */
static int read_looks(const struct json *json, const cJSON *grain, struct optics *optics)
{
    const struct number rings[] = {{"spacing_px", 1, 1000, &optics->ring_spacing},
                                   {"contrast", 0, 1, &optics->ring_contrast}};
    const struct number bevel[] = {{"width_px", 0.1, 100, &optics->bevel_width}, {"depth", 0, 1, &optics->bevel_depth}};
    const struct number lines[] = {{"share", 0, 1, &optics->line_share},
                                   {"width_px", 0.1, 100, &optics->line_width},
                                   {"level", 0, 2, &optics->line_level}};
    const struct number flank[] = {{"parallax", 0, 0.2, &optics->parallax}, {"level", 0, 2, &optics->flank_level}};
    int there = read_numbers_of(json, grain, "rings", rings, 2);
    if (there > 0 && optics->ring_contrast > 0 && optics->ring_spacing <= 0)
        return json_error(json, cJSON_GetObjectItemCaseSensitive(grain, "rings"), "rings need spacing_px");
    return there < 0 || read_numbers_of(json, grain, "bevel", bevel, 2) < 0 ||
                   read_numbers_of(json, grain, "lines", lines, 3) < 0 ||
                   read_numbers_of(json, grain, "flank", flank, 2) < 0
               ? -1
               : 0;
}

static int read_labels(const struct json *json, const cJSON *section, struct optics *optics)
{
    const cJSON *list = NULL, *item;
    int there = json_array(json, section, "labels_px", &list);
    if (there < 1)
        return there;
    optics->labels = calloc((size_t)cJSON_GetArraySize(list) + 1, sizeof *optics->labels);
    if (!optics->labels)
        return error_memory("labels");
    cJSON_ArrayForEach(item, list)
    {
        double side[4];
        for (int k = 0; k < 4; k++) {
            const cJSON *number = cJSON_GetArrayItem(item, k);
            if (!cJSON_IsArray(item) || cJSON_GetArraySize(item) != 4 || !cJSON_IsNumber(number))
                return json_error(json, item, "a label is a rectangle [x0, y0, x1, y1]");
            side[k] = number->valuedouble;
        }
        optics->labels[optics->label_count++] = (struct rect){side[0], side[1], side[2], side[3]};
    }
    return 0;
}

static int read_grain(const struct json *json, const cJSON *section, struct optics *optics)
{
    static const char *const keys[] = {"level", "spread", "paint",       "rings", "bevel",
                                       "lines", "flank",  "ellipticity", NULL};
    const cJSON *grain = NULL;
    int there = json_object(json, section, "grain", &grain);
    if (there < 1)
        return there;
    if (json_check_keys(json, grain, keys) || read_surface(json, grain, &optics->grain) ||
        json_number(json, grain, "spread", 0, 0.5, &optics->grain.spread) < 0 ||
        json_number(json, grain, "ellipticity", 0, 0.2, &optics->ellipticity) < 0)
        return -1;
    return read_looks(json, grain, optics);
}

static int read_noise(const struct json *json, const cJSON *section, struct optics *optics)
{
    const struct number noise[] = {{"read", 0, 1, &optics->read_noise}, {"shot", 0, 1, &optics->shot_noise}};
    return read_numbers_of(json, section, "noise", noise, 2) < 0 ? -1 : 0;
}

static int read_camera(const struct json *json, const cJSON *section, struct view *wander)
{
    const struct number camera[] = {{"shift_px", 0, 1000, &wander->dx},
                                    {"angle_rad", 0, 0.1, &wander->angle},
                                    {"zoom", 0, 0.1, &wander->zoom},
                                    {"blur_px", 0, 5, &wander->blur},
                                    {"brightness", 0, 0.2, &wander->brightness}};
    int there = read_numbers_of(json, section, "camera", camera, 5);
    if (there > 0)
        wander->dy = wander->dx;
    return there < 0 ? -1 : 0;
}

static int read_numbers(const struct json *json, const cJSON *section, struct optics *optics)
{
    long seed = (long)optics->seed, bits = optics->bits;
    if (json_integer(json, section, "seed", 0, 1L << 53, &seed) < 0 ||
        json_integer(json, section, "bits", 4, 16, &bits) < 0 ||
        json_number(json, section, "psf_px", OPTICS_PSF_MIN, 50, &optics->psf) < 0 ||
        json_number(json, section, "exposure", 0.01, 100, &optics->exposure) < 0 ||
        json_number(json, section, "shading", 0, 1, &optics->shading) < 0 ||
        json_number(json, section, "frame_width_px", 0, 1e5, &optics->frame_width) < 0)
        return -1;
    optics->seed = (uint64_t)seed;
    optics->bits = (int)bits;
    return 0;
}

struct view optics_view(const struct optics *optics, long index, long reference)
{
    const struct view *wander = &optics->wander;
    uint64_t key = random_bits(random_bits(optics->seed, 0x63616D657261u), (uint64_t)index);
    if (index == reference)
        return (struct view){0};
    return (struct view){.dx = wander->dx * random_normal(key, 0),
                         .dy = wander->dy * random_normal(key, 1),
                         .angle = wander->angle * random_normal(key, 2),
                         .zoom = 1 + wander->zoom * random_normal(key, 3),
                         .blur = wander->blur * random_normal(key, 4),
                         .brightness = 1 + wander->brightness * random_normal(key, 5)};
}

void optics_free(struct optics *optics)
{
    free(optics->labels);
    optics->labels = NULL;
    optics->label_count = 0;
}

static int read_plains(const struct json *json, const cJSON *section, struct optics *optics)
{
    struct {
        const char *name;
        struct surface *surface;
    } plain[] = {{"void", &optics->hollow}, {"frame", &optics->frame}, {"outside", &optics->outside},
                 {"hinge", &optics->hinge}, {"paper", &optics->paper}, {"marker", &optics->marker},
                 {"label", &optics->label}};
    for (size_t k = 0; k < sizeof plain / sizeof *plain; k++)
        if (read_plain(json, section, plain[k].name, plain[k].surface) < 0)
            return -1;
    return 0;
}

int optics_read(const struct scene *scene, struct optics *optics)
{
    static const char *const keys[] = {"seed",           "psf_px", "bits",   "noise", "exposure",  "shading",
                                       "frame_width_px", "camera", "grain",  "void",  "frame",     "outside",
                                       "hinge",          "paper",  "marker", "label", "labels_px", NULL};
    *optics = (struct optics)OPTICS_DEFAULT;
    const struct json *json = scene->json;
    const cJSON *section = scene_section(scene, "optics");
    if (!section)
        return 0;
    if (json_check_keys(json, section, keys) == 0 && read_numbers(json, section, optics) == 0 &&
        read_noise(json, section, optics) == 0 && read_camera(json, section, &optics->wander) == 0 &&
        read_grain(json, section, optics) == 0 && read_labels(json, section, optics) == 0 &&
        read_plains(json, section, optics) == 0)
        return 0;
    optics_free(optics);
    return -1;
}
