/* What a user may say to contacts, on the command line and in the scene's section "contacts". */
#ifndef CONTACTS_ARGUMENTS_H
#define CONTACTS_ARGUMENTS_H

#include "contacts/find_contacts.h"
#include "pipeline/command/cli.h"

struct arguments {
    struct cli cli;
    const char *previous, *picture; /* paths; NULL: none */
    struct cli_inputs radii;        /* --radii; to be freed */
    struct contact_options options;
};
#define ARGUMENTS_DEFAULT                                                                                              \
    {                                                                                                                  \
        .cli = CLI_DEFAULT, .options = CONTACT_OPTIONS_DEFAULT                                                         \
    }

/* The command line, with one input; a wrong one ends the program. */
void arguments_parse(int argc, char **argv, struct arguments *arguments);
/* What the scene says where the command line is silent; then automatic corrections of the radii become those that the
 * previous state found (an empty one: none). -1: an error of the scene (EXIT_INPUT). */
int arguments_complete(struct arguments *arguments, const struct scene *scene, const struct packing *previous);

#endif
