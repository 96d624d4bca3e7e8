/* The command line of contacts. */
#ifndef CONTACTS_ARGUMENTS_H
#define CONTACTS_ARGUMENTS_H

#include "contacts/find_contacts.h"
#include "pipeline/command/cli.h"

struct arguments {
    struct cli cli;
    const char *input, *previous, *picture;
    struct cli_inputs radii;      /* --radii */
    struct contact_options given; /* NaN: not on the command line */
};
#define ARGUMENTS_NONE                                                                                                 \
    {                                                                                                                  \
        .cli = CLI_DEFAULT, .given = {.radius_scale = NAN, .radius_offset_px = NAN, .tolerance_px = NAN }              \
    }

extern const struct argp contacts_argp; /* its input is a struct arguments * */

/* The scene's options, then those of the command line, then what the previous state found. */
int arguments_options(const struct arguments *arguments, const struct scene *scene, const struct packing *previous,
                      struct contact_options *options);

#endif
