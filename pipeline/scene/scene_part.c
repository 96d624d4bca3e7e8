#include "pipeline/scene/scene_part.h"

#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/files/json.h"

/* tests/unit/test_directions holds that the stages on the photo side touch nothing else of the scene. */
static const char *const photo_side[] = {"photos", "lens", "drift_patches_px", "frame", "grains", NULL};
static const char *const programs[] = {"findgrains", "tracker", "contacts", "forces", "simulation", "optics", NULL};

static int is_among(const char *const words[], const char *word)
{
    for (; *words; words++)
        if (!strcmp(*words, word))
            return 1;
    return 0;
}

static int is_seen(const char *key, const char *stage)
{
    if (!strcmp(key, "name"))
        return !strcmp(stage, "report");
    if (!strcmp(stage, "findgrains") || !strcmp(stage, "tracker"))
        return !strcmp(key, stage) || is_among(photo_side, key);
    return !strcmp(key, stage) || !is_among(programs, key);
}

static void remove_members(cJSON *root, const char *stage)
{
    for (cJSON *item = root->child, *next; item; item = next) {
        next = item->next;
        if (!is_seen(item->string, stage))
            cJSON_Delete(cJSON_DetachItemViaPointer(root, item));
    }
    cJSON *photos = cJSON_GetObjectItemCaseSensitive(root, "photos");
    cJSON_DeleteItemFromObjectCaseSensitive(photos, "last");
    if (!strcmp(stage, "findgrains"))
        cJSON_DeleteItemFromObjectCaseSensitive(photos, "skip");
}

size_t scene_part_files(const struct scene *scene, const char *stage, const char *paths[2])
{
    size_t count = 0;
    int contacts = !strcmp(stage, "contacts");
    if (scene->lens && (contacts || !strcmp(stage, "findgrains") || !strcmp(stage, "tracker")))
        paths[count++] = scene->lens;
    if (scene->loads && contacts)
        paths[count++] = scene->loads;
    return count;
}

char *scene_part(const struct scene *scene, const char *stage)
{
    cJSON *part = cJSON_Duplicate(json_root(scene->json), 1);
    if (!part) {
        error_set(EXIT_FAILED, "out of memory: scene: use a machine with more memory");
        return NULL;
    }
    remove_members(part, stage);
    char *text = json_print(part);
    cJSON_Delete(part);
    return text;
}
