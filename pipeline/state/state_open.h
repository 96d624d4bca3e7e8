/* What the files that read state files share. Private to pipeline/. */
#ifndef PIPELINE_STATE_OPEN_H
#define PIPELINE_STATE_OPEN_H

#include <hdf5.h>
#include <stddef.h>
#include <stdint.h>

struct state {
    char *path;
    int fd; /* what is read is what was opened first, whatever takes its name meanwhile */
    hid_t hdf;
};

/* The name under which HDF5 and stdio open that descriptor's file. */
void state_own_name(const struct state *state, char name[64]);

/* Is there an object `name` in a group? 1: there, by a hard link; 0: absent; -1: a link that leads elsewhere, or damage
 * (error set). */
int state_look(const struct state *state, hid_t parent, const char *name);
/* Walk down a path of groups. 1: *group is open; 0: absent; -1: error (set). */
int state_find_group(const struct state *state, const char *path, hid_t *group);
/* state_find_group() where the group must be there; negative on failure (error set). */
hid_t state_open_group(const struct state *state, const char *path);
/* Always -1: something that a reader needs is not there; the error says which program wrote the file. */
int state_lacks(const struct state *state, const char *kind, const char *group, const char *name);

/* 0: *text is to be freed; 1: no such attribute; -1: error (set). */
int state_attribute_text(const struct state *state, const char *group, const char *name, char **text);
/* The same of an open dataset. */
int state_dataset_text(const struct state *state, hid_t dataset, const char *name, char **text);
/* One integer of the root group; 0, 1 or -1 as above. */
int state_attribute_integer(const struct state *state, const char *name, int64_t *value);

#endif
