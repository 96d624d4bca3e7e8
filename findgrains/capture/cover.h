/* Where grains are already seen for sure: no edge there votes, and no peak of the votes there is a grain. */
#ifndef FINDGRAINS_COVER_H
#define FINDGRAINS_COVER_H

#include "findgrains/look/level.h"
#include "findgrains/capture/candidates.h"

struct cover {
    const struct level *level;
    unsigned char *pixels; /* 1: covered */
};

/* Over the pixels of a level, from a list of grains in photo coordinates. */
int cover_make(const struct level *level, const struct candidates *sure, struct cover *cover);
void cover_add(struct cover *cover, const struct rim *rim);
int cover_at(const struct cover *cover, double x, double y); /* photo coordinates */
void cover_free(struct cover *cover);                        /* accepts a zeroed struct */

#endif
