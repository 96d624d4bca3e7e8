/* A scene from its file: defaults, the keys of the root, then group by group (scene_groups.h). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/scene/scene_groups.h"
#include "pipeline/speak/error.h"
#include "pipeline/files/json.h"

/* Sections whose keys belong to their programs. */
static const char *const sections[] = {"findgrains", "tracker", "contacts", "forces", "simulation", "optics", NULL};

static char *copy(const char *text)
{
    char *again = strdup(text);
    if (!again)
        error_set(EXIT_FAILED, "out of memory: scene: use a machine with more memory");
    return again;
}

static char *folder_of(const char *path)
{
    char *folder = copy(path), *slash = folder ? strrchr(folder, '/') : NULL;
    if (slash)
        slash[slash == folder] = '\0';
    else if (folder)
        strcpy(folder, *folder ? "." : "");
    return folder;
}

/* Nothing is known until the file says so. */
static void set_defaults(struct scene *scene)
{
    memset(scene, 0, sizeof *scene);
    scene->photos.interval_s = NAN;
    scene->photos.block = 20;
    scene->scale = NAN;
    scene->grains = (struct scene_grains){NAN, NAN, NAN, NAN};
    scene->contact = (struct contact_law)CONTACT_LAW_DEFAULT;
}

static int check_root(const struct json *json)
{
    static const char *const keys[] = {
        "schema", "name",   "photos",           "scale_m_per_px", "origin_px", "lens",     "drift_patches_px",
        "frame",  "grains", "contact",          "loads",          "tracker",   "contacts", "findgrains",
        "forces", "optics", "gravity_m_per_s2", "simulation",     NULL};
    const cJSON *root = json_root(json), *section;
    const char *schema = "";
    if (!cJSON_IsObject(root))
        return json_error(json, root, "a scene is one group: write { \"schema\": \"film.scene/1\", ... }");
    int there = json_string(json, root, "schema", &schema);
    if (there < 0)
        return -1;
    if (!there || strcmp(schema, "film.scene/1"))
        return json_error(json, there ? cJSON_GetObjectItemCaseSensitive(root, "schema") : root,
                          "this is not a scene that this program knows: write \"schema\": \"film.scene/1\"");
    if (json_check_keys(json, root, keys))
        return -1;
    for (int k = 0; sections[k]; k++)
        if (json_object(json, root, sections[k], &section) < 0)
            return -1;
    return 0;
}

static int read_all(struct scene *scene)
{
    if (check_root(scene->json) || scene_read_root(scene) || scene_read_photos(scene) || scene_read_frame(scene) ||
        scene_read_grains(scene) || scene_read_drift_patches(scene))
        return -1;
    const cJSON *object;
    scene->contact_given = json_object(scene->json, json_root(scene->json), "contact", &object);
    if (scene->contact_given < 0)
        return -1;
    return scene->contact_given ? contact_law_read(scene->json, object, &scene->contact) : 0;
}

int scene_read(const char *path, struct scene *scene)
{
    set_defaults(scene);
    if (!(scene->path = copy(path)) || !(scene->folder = folder_of(path)) || !(scene->json = json_read(path)) ||
        read_all(scene)) {
        scene_free(scene);
        return -1;
    }
    return 0;
}
