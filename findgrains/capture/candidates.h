/* Rims that were seen in the photo, and may be grains: what speaks for each, and lists of them. */
#ifndef FINDGRAINS_CANDIDATES_H
#define FINDGRAINS_CANDIDATES_H

#include <stddef.h>

#include "findgrains/capture/rim.h"

/* A rim that was seen, before its refinement. */
struct candidate {
    struct rim rim;
    double support;      /* share of the rim where the photo falls from grain to void, weighted by how far it falls */
    double one_side;     /* |mean of exp(i theta)| over that share: 0 all around, 1 on one side only */
    double spread;       /* px: how far the rim may be off */
    struct rim captured; /* as it was captured, */
    double sure;         /* with this support: enough keeps the row even where the fine fit fails */
    int by_hand;         /* from the user's list: kept in any case */
    double merit;        /* while a list is sorted */
};

/* Grows with candidates_add(); a zeroed one is empty. */
struct candidates {
    struct candidate *items;
    size_t count, room;
};

int candidates_add(struct candidates *list, const struct candidate *item);
void candidates_free(struct candidates *list); /* accepts a zeroed struct */
/* What speaks for a rim: support above what circles of specks reach by chance, over its scatter, which falls with the
 * square root of the length of the rim: a small circle has to be supported better than a large one. */
double candidates_merit(const struct candidate *item);
double candidates_support(const struct candidate *item);
/* Sort by merit (ties by position, so that the order never depends on how the list was filled) and keep those whose
 * centres are at least share (R_i + R_j) away from every better one. 0, or -1 when memory is gone. */
int candidates_thin(struct candidates *list, double share, double (*merit)(const struct candidate *));

#endif
