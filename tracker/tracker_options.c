/* subset: radius of the disc that is followed, over the grain's radius; search_px, search_deg: how far a grain may have
 * moved and turned since it was last seen. */
#include "tracker/tracker_options.h"

#include "pipeline/command/option_table.h"
#include "pipeline/speak/error.h"
#include "pipeline/files/json.h"

#define AT(field) .at = offsetof(struct tracker_options, field)
static const struct option_row rows[] = {{NULL, "subset", OPTION_NUMBER, AT(subset), .min = 0.1, .max = 1},
                                         {NULL, "search_px", OPTION_NUMBER, AT(search_px), .max = 2000},
                                         {NULL, "search_deg", OPTION_NUMBER, AT(search_deg), .max = 180},
                                         {0}};

int tracker_options_read(const struct scene *scene, struct tracker_options *options)
{
    *options = (struct tracker_options)TRACKER_DEFAULT;
    if (options_read(rows, scene, "tracker", 0, options))
        return -1;
    options->drift = scene->drift_patches;
    options->drift_count = scene->drift_patch_count;
    options->markers = scene->frame.markers;
    options->marker_count = scene->frame.marker_count;
    return 0;
}

static void add_rect(cJSON *list, const struct rect *rect)
{
    const double sides[4] = {rect->x0, rect->y0, rect->x1, rect->y1};
    cJSON_AddItemToArray(list, cJSON_CreateDoubleArray(sides, 4));
}

/* The numbers of the lens, not the name of its file: they are what changes positions. */
static void add_lens(cJSON *root, const struct lens *lens)
{
    const double centre[2] = {lens->centre.x, lens->centre.y};
    cJSON *object = cJSON_AddObjectToObject(root, "lens");
    cJSON_AddItemToObject(object, "centre_px", cJSON_CreateDoubleArray(centre, 2));
    cJSON_AddItemToObject(object, "K", cJSON_CreateDoubleArray(lens->k, 3));
    cJSON_AddItemToObject(object, "P", cJSON_CreateDoubleArray(lens->p, 3));
}

char *tracker_options_print(const struct tracker_options *options)
{
    cJSON *root = cJSON_CreateObject(), *section = cJSON_AddObjectToObject(root, "tracker");
    cJSON_AddNumberToObject(section, "subset", options->subset);
    cJSON_AddNumberToObject(section, "search_px", options->search_px);
    cJSON_AddNumberToObject(section, "search_deg", options->search_deg);
    cJSON *drift = cJSON_AddArrayToObject(root, "drift_patches_px");
    for (size_t k = 0; k < options->drift_count; k++)
        add_rect(drift, &options->drift[k]);
    cJSON *markers = cJSON_AddArrayToObject(root, "markers_px");
    for (size_t k = 0; k < options->marker_count; k++)
        add_rect(markers, &options->markers[k].rect);
    if (options->lens)
        add_lens(root, options->lens);
    char *text = json_print(root);
    if (!text)
        error_set(EXIT_FAILED, "out of memory: parameters: use a machine with more memory");
    cJSON_Delete(root);
    return text;
}
