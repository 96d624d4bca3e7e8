/* What a person adds to or takes from the grains that were found: two text files, one grain per line, px, # starts a
 * comment. Added: "x y radius"; removed: "x y", anywhere inside the grain. */
#ifndef FINDGRAINS_CORRECTIONS_H
#define FINDGRAINS_CORRECTIONS_H

#include <stddef.h>

#include "findgrains/capture/candidates.h"

struct correction {
    double x, y, radius; /* px of the photo; radius 0: remove */
    const char *path;    /* of the list, borrowed; NULL: not from a list */
    int line;
};

struct corrections {
    struct correction *items;
    size_t count, room;
};

/* Append a list to `corrections`, which borrows the path; errors name file and line. */
int corrections_read_added(const char *path, struct corrections *corrections);
int corrections_read_removed(const char *path, struct corrections *corrections);
void corrections_free(struct corrections *corrections); /* accepts a zeroed struct */

/* An error, with file and line, for the first added grain whose centre lies outside a photo of width x height px by
 * more than half its radius (cut grains may have it a little outside). NULL: none. */
int corrections_check(const struct corrections *corrections, int width, int height);
/* Take away the candidates that hold a removed point (an error when none does), add the added ones. NULL: nothing. */
int corrections_apply(const struct corrections *corrections, struct candidates *found);

#endif
