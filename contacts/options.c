#include <stdlib.h>
#include <string.h>

#include "contacts/find_contacts.h"
#include "pipeline/speak/error.h"

/* A number, or "auto". */
static int number_or_auto(const struct json *json, const cJSON *section, const char *key, double min, double max,
                          double *value, int *automatic)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(section, key);
    const char *word;
    if (!cJSON_IsString(item))
        return json_number(json, section, key, min, max, value);
    if (json_string(json, section, key, &word) < 0)
        return -1;
    if (strcmp(word, "auto"))
        return json_error(json, item, "%s is \"%s\": give a number or \"auto\"", key, word);
    *automatic = 1;
    return 1;
}

int contact_options_read(const struct scene *scene, struct contact_options *options)
{
    static const char *const keys[] = {
        "radius_scale", "radius_offset_px", "tolerance_px", "candidate_sigmas", "frame_error_px", "repair", NULL};
    const struct json *json = scene->json;
    const cJSON *section = scene_section(scene, "contacts");
    if (!section)
        return 0;
    if (json_check_keys(json, section, keys) ||
        number_or_auto(json, section, "radius_scale", 0.5, 2, &options->radius_scale, &options->radius_scale_auto) <
            0 ||
        number_or_auto(json, section, "radius_offset_px", -1000, 1000, &options->radius_offset_px,
                       &options->radius_offset_auto) < 0 ||
        json_number(json, section, "tolerance_px", -1000, 1000, &options->tolerance_px) < 0 ||
        json_number(json, section, "candidate_sigmas", 0, 100, &options->candidate_sigmas) < 0 ||
        json_boolean(json, section, "repair", &options->repair) < 0 ||
        json_number(json, section, "frame_error_px", 0, 1000, &options->frame_error_px) < 0)
        return -1;
    return 0;
}

int contact_options_follow(const struct packing *previous, struct contact_options *options)
{
    const char *text = previous->info.parameters;
    struct json *json = text ? json_parse(text, strlen(text), "parameters of the previous state") : NULL;
    int status = 0;
    if (!json)
        return text ? -1 : 0;
    if (options->radius_scale_auto &&
        (status = json_number(json, json_root(json), "radius_scale", 0.5, 2, &options->radius_scale)) > 0)
        options->radius_scale_auto = 0;
    if (status >= 0 && options->radius_offset_auto &&
        (status = json_number(json, json_root(json), "radius_offset_px", -1000, 1000, &options->radius_offset_px)) > 0)
        options->radius_offset_auto = 0;
    json_free(json);
    return status < 0 ? -1 : 0;
}
