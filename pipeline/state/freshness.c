#include "pipeline/state/freshness.h"

#include <stdlib.h>
#include <string.h>

#include "pipeline/files/json.h"
#include "pipeline/speak/error.h"

static const char *const KEYS[] = {"scale_m_per_px", "origin_px", "frame", "gravity_m_per_s2", NULL};

static const cJSON *item_of(const cJSON *object, const char *key)
{
    return cJSON_GetObjectItemCaseSensitive(object, key);
}

int freshness_note(cJSON *parameters, const struct scene *scene)
{
    cJSON *part = scene ? cJSON_AddObjectToObject(parameters, "scene") : NULL;
    if (scene && !part)
        return error_memory("parameters");
    for (int k = 0; scene && KEYS[k]; k++) {
        const cJSON *item = item_of(json_root(scene->json), KEYS[k]);
        cJSON *copy = item ? cJSON_Duplicate(item, 1) : NULL;
        if (item && (!copy || !cJSON_AddItemToObject(part, KEYS[k], copy))) {
            cJSON_Delete(copy);
            return error_memory("parameters");
        }
    }
    return 0;
}

static int stale(const char *path, const char *key)
{
    return error_input("%s: was made with another '%s' than the scene has now: run contacts again", path, key);
}

static int check_keys(const char *path, const struct state_info *info, const struct scene *scene)
{
    struct json *json = info->parameters ? json_parse(info->parameters, strlen(info->parameters), path) : NULL;
    const cJSON *then = json ? item_of(json_root(json), "scene") : NULL;
    int status = info->parameters && !json ? -1 : 0;
    for (int k = 0; then && KEYS[k] && !status; k++) {
        const cJSON *a = item_of(then, KEYS[k]), *b = item_of(json_root(scene->json), KEYS[k]);
        if ((a || b) && !(a && b && cJSON_Compare(a, b, 1)))
            status = stale(path, KEYS[k]);
    }
    json_free(json);
    return status;
}

int freshness_check(const char *path, const struct state_info *info, const struct scene *scene)
{
    if (strcmp(info->stage, "contacts"))
        return 0;
    return check_keys(path, info, scene);
}
