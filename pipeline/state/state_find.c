/* Finding objects of a state file. Files may come from anywhere: every object is reached by hard links inside the file
 * only, and what cannot be looked up is an error, not an absence. */
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/state/state_hdf.h"
#include "pipeline/state/state_open.h"

/* Always -1, with an error that names the file and the thing. */
static int damaged(const struct state *state, const char *name)
{
    return error_input("%s: damaged at '%s': make the file again", state->path, name);
}

int state_look(const struct state *state, hid_t parent, const char *name)
{
    H5L_info_t link;
    htri_t exists = H5Lexists(parent, name, H5P_DEFAULT);
    if (exists == 0)
        return 0;
    if (exists < 0 || H5Lget_info(parent, name, &link, H5P_DEFAULT) < 0)
        return damaged(state, name);
    if (link.type != H5L_TYPE_HARD)
        return error_input("%s: '%s' is a soft or external link: put the data into the file itself", state->path, name);
    return 1;
}

int state_find_group(const struct state *state, const char *path, hid_t *group)
{
    char *parts = strdup(path), *rest = NULL;
    int found = 1;
    if (!parts)
        return error_memory(path);
    *group = H5Gopen2(state->hdf, "/", H5P_DEFAULT);
    for (char *part = strtok_r(parts, "/", &rest); part && *group >= 0; part = strtok_r(NULL, "/", &rest)) {
        found = state_look(state, *group, part);
        hid_t next = found == 1 ? H5Gopen2(*group, part, H5P_DEFAULT) : -1;
        H5Gclose(*group);
        *group = next;
        if (found != 1)
            break;
    }
    free(parts);
    if (found == 1 && *group < 0)
        return error_input("%s: '%s' is not a readable group: make the file again", state->path, path);
    return found;
}

int state_lacks(const struct state *state, const char *kind, const char *group, const char *name)
{
    char stage[32] = "";
    if (state_read_text(state, "/", "stage", stage, sizeof stage) || !stage[0])
        return error_input("%s: has no %s /%s%s: give a file of the right stage", state->path, kind, group, name);
    return error_input("%s: has no %s /%s%s, it was written by %s: give a file of the right stage", state->path, kind,
                       group, name, stage);
}

hid_t state_open_group(const struct state *state, const char *path)
{
    hid_t group = -1;
    int found = state_find_group(state, path, &group);
    if (found == 0)
        return state_lacks(state, "group", path, "");
    return found == 1 ? group : -1;
}

int state_has(const struct state *state, const char *path)
{
    hid_t group = -1;
    int found = state_find_group(state, path, &group);
    if (found == 1)
        H5Gclose(group);
    return found;
}

/* The members of a group while HDF5 lists them; names are owned. */
struct names {
    char **list;
    size_t count, capacity;
    int linked; /* a soft or external link was met */
};

/* For H5Literate. Soft and external links are refused: they may lead anywhere on the disk. */
static herr_t collect_name(hid_t group, const char *name, const H5L_info_t *link, void *data)
{
    (void)group;
    struct names *names = data;
    if (link->type != H5L_TYPE_HARD) {
        names->linked = 1;
        return -1;
    }
    if (names->count == names->capacity) {
        size_t capacity = names->capacity ? 2 * names->capacity : 16;
        char **list = realloc(names->list, capacity * sizeof *list);
        if (!list)
            return -1;
        names->list = list;
        names->capacity = capacity;
    }
    names->list[names->count] = strdup(name);
    return names->list[names->count++] ? 0 : -1;
}

/* Keep only groups and pack the strings behind the pointers into one block. */
static char **pack_groups(hid_t group, const struct names *names, size_t *count)
{
    size_t bytes = sizeof(char *);
    for (size_t k = 0; k < names->count; k++)
        bytes += sizeof(char *) + strlen(names->list[k]) + 1;
    char **packed = malloc(bytes);
    if (!packed)
        return NULL;
    char *text = (char *)(packed + names->count + 1);
    *count = 0;
    for (size_t k = 0; k < names->count; k++) {
        hid_t child = H5Oopen(group, names->list[k], H5P_DEFAULT);
        H5I_type_t type = child >= 0 ? H5Iget_type(child) : H5I_BADID;
        if (child >= 0)
            H5Oclose(child);
        if (type == H5I_BADID) {
            free(packed);
            return NULL;
        }
        if (type != H5I_GROUP)
            continue;
        packed[(*count)++] = text;
        text = stpcpy(text, names->list[k]) + 1;
    }
    packed[*count] = NULL;
    return packed;
}

int state_list(const struct state *state, const char *path, char ***list, size_t *count)
{
    struct names names = {0};
    hid_t group = -1;
    *list = NULL;
    *count = 0;
    int found = state_find_group(state, path, &group);
    if (found < 0)
        return -1;
    if (found == 1) {
        if (H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, NULL, collect_name, &names) >= 0)
            *list = pack_groups(group, &names, count);
        H5Gclose(group);
    } else {
        *list = calloc(1, sizeof **list);
    }
    for (size_t k = 0; k < names.count; k++)
        free(names.list[k]);
    free(names.list);
    if (names.linked)
        return error_input("%s: '%s' has a soft or external link: put the data into the file itself", state->path,
                           path);
    return *list ? 0 : error_failed("%s: the groups in '%s' cannot be listed: make the file again", state->path, path);
}
