/* The look of a photo as a table of rows; dots in a key are groups of the section. Lists (paint, labels) are read by
 * functions of their own. */
#include "simulation/render/optics.h"

#include <stdlib.h>

#include "pipeline/command/option_table.h"
#include "pipeline/speak/error.h"
#include "pipeline/numbers/random.h"
#include "pipeline/files/json.h"

/* [low, high] in that order, both within [min, max]. */
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

/* All three keys are needed: a paint without one of them would be invisible, or everywhere. */
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

/* A list replaces the surface's default paints, an empty one removes them. */
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

/* Rectangles [x0, y0, x1, y1], px. */
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

/* The camera stands still for the reference photo; elsewhere each motion is a normal number that depends on seed and
 * index alone, so that any photo can be drawn by itself. */
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

#define AT(field) .at = offsetof(struct optics, field)
#define SURFACE(key, field)                                                                                            \
    {NULL, key ".level", OPTION_NUMBER, AT(field.level), .max = 2},                                                    \
    {                                                                                                                  \
        NULL, key ".paint", .type = OPTION_ELSE                                                                        \
    }
/* Lengths in px, levels as shares of full scale, noise as standard deviations of them (optics.h). */
static const struct option_row rows[] = {
    {NULL, "seed", OPTION_LONG, AT(seed), .max = 0x1p53},
    {NULL, "bits", OPTION_WHOLE, AT(bits), .min = 4, .max = 16},
    {NULL, "psf_px", OPTION_NUMBER, AT(psf), .min = OPTICS_PSF_MIN, .max = 50},
    {NULL, "exposure", OPTION_NUMBER, AT(exposure), .min = 0.01, .max = 100},
    {NULL, "shading", OPTION_NUMBER, AT(shading), .max = 1},
    {NULL, "frame_width_px", OPTION_NUMBER, AT(frame_width), .max = 1e5},
    {NULL, "noise.read", OPTION_NUMBER, AT(read_noise), .max = 1},
    {NULL, "noise.shot", OPTION_NUMBER, AT(shot_noise), .max = 1},
    {NULL, "camera.shift_px", OPTION_NUMBER, AT(wander.dx), .max = 1000},
    {NULL, "camera.angle_rad", OPTION_NUMBER, AT(wander.angle), .max = 0.1},
    {NULL, "camera.zoom", OPTION_NUMBER, AT(wander.zoom), .max = 0.1},
    {NULL, "camera.blur_px", OPTION_NUMBER, AT(wander.blur), .max = 5},
    {NULL, "camera.brightness", OPTION_NUMBER, AT(wander.brightness), .max = 0.2},
    {NULL, "grain.spread", OPTION_NUMBER, AT(grain.spread), .max = 0.5},
    {NULL, "grain.ellipticity", OPTION_NUMBER, AT(ellipticity), .max = 0.2},
    {NULL, "grain.rings.spacing_px", OPTION_NUMBER, AT(ring_spacing), .min = 1, .max = 1000},
    {NULL, "grain.rings.contrast", OPTION_NUMBER, AT(ring_contrast), .max = 1},
    {NULL, "grain.bevel.width_px", OPTION_NUMBER, AT(bevel_width), .min = 0.1, .max = 100},
    {NULL, "grain.bevel.depth", OPTION_NUMBER, AT(bevel_depth), .max = 1},
    {NULL, "grain.lines.share", OPTION_NUMBER, AT(line_share), .max = 1},
    {NULL, "grain.lines.width_px", OPTION_NUMBER, AT(line_width), .min = 0.1, .max = 100},
    {NULL, "grain.lines.level", OPTION_NUMBER, AT(line_level), .max = 2},
    {NULL, "grain.flank.parallax", OPTION_NUMBER, AT(parallax), .max = 0.2},
    {NULL, "grain.flank.level", OPTION_NUMBER, AT(flank_level), .max = 2},
    SURFACE("grain", grain),
    SURFACE("void", hollow),
    SURFACE("frame", frame),
    SURFACE("outside", outside),
    SURFACE("hinge", hinge),
    SURFACE("paper", paper),
    SURFACE("marker", marker),
    SURFACE("label", label),
    {NULL, "labels_px", .type = OPTION_ELSE},
    {0}};

/* The lists of paint of all surfaces, each where the scene has one. */
static int read_surfaces(const struct json *json, const cJSON *section, struct optics *optics)
{
    const struct {
        const char *name;
        struct surface *surface;
    } all[] = {{"grain", &optics->grain},     {"void", &optics->hollow}, {"frame", &optics->frame},
               {"outside", &optics->outside}, {"hinge", &optics->hinge}, {"paper", &optics->paper},
               {"marker", &optics->marker},   {"label", &optics->label}};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
        const cJSON *object = NULL;
        if (json_object(json, section, all[k].name, &object) > 0 && read_paints(json, object, all[k].surface) < 0)
            return -1;
    }
    return 0;
}

/* What two keys tell together, and lists. */
/* The camera shifts alike in both directions. */
static int read_rest(const struct json *json, const cJSON *section, struct optics *optics)
{
    if (optics->ring_contrast > 0 && optics->ring_spacing <= 0)
        return json_error(json, cJSON_GetObjectItemCaseSensitive(section, "grain"), "rings need spacing_px");
    optics->wander.dy = optics->wander.dx;
    return read_labels(json, section, optics) || read_surfaces(json, section, optics) ? -1 : 0;
}

int optics_read(const struct scene *scene, struct optics *optics)
{
    const cJSON *section = scene_section(scene, "optics");
    *optics = (struct optics)OPTICS_DEFAULT;
    if (!section || (!options_read(rows, scene, "optics", 0, optics) && !read_rest(scene->json, section, optics)))
        return 0;
    optics_free(optics);
    return -1;
}
