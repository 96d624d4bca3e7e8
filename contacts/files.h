/* What contacts reads and says about itself in its file. */
#ifndef CONTACTS_FILES_H
#define CONTACTS_FILES_H

#include "contacts/arguments.h"
#include "contacts/find_contacts.h"

/* The photo side of one state. */
struct photo_state {
    struct photo_grains grains;
    struct patches patches;
    struct state_info info;
};

/* Grains and patches of a file of findgrains or tracker; to be freed. 0, or -1 with a line: another kind of file
 * (EXIT_INPUT), columns missing, unreadable; nothing is to be freed then. */
int photo_state_read(const char *path, struct photo_state *state);
void photo_state_free(struct photo_state *state); /* accepts a zeroed struct */
/* Further measurements of the radii: `count` files into as many tables, one block to be freed with photos_free(). */
int photos_read(char *const *paths, size_t count, struct photo_state **photos);
void photos_free(struct photo_state *photos, size_t count);
/* Is this the reference photo of the scene (or the only photo)? */
int photo_state_is_reference(const struct photo_state *state, const struct scene *scene);

/* The options as used, and the errors of what was found automatically, as the JSON text of the attribute `parameters`;
 * to be freed. */
char *contact_options_text(const struct contact_options *options, const struct contact_summary *summary);

/* The state file, with its inputs, parameters and what it is as a whole. */
int contacts_write(const struct arguments *arguments, const struct scene *scene, const struct photo_state *photo,
                   const struct contact_options *options, const struct contact_summary *summary,
                   const struct packing *packing);
/* What was found, as one line of the log (--log), numbers by their names; and on stderr: what must not be overlooked
 * (grains without numbers, a packing without contacts, a radius correction that is undecided), else a summary. 0 or
 * EXIT_FLAGGED. */
int contacts_tell(const struct cli *cli, const struct contact_options *options, const struct contact_summary *summary);

#endif
