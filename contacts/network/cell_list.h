/* Which discs are near each other. Discs are sorted into classes of radius (factors of 2), each class into square
 * cells as wide as its largest disc; a disc looks into the cells around it of its own and every smaller class. Cost
 * and memory grow linearly with the number of discs, whatever the ratio of radii; far-off discs cost nothing. */
#ifndef CONTACTS_CELL_LIST_H
#define CONTACTS_CELL_LIST_H

#include <stddef.h>
#include <stdint.h>

struct near_pairs {
    size_t count;
    int64_t *i, *j; /* i < j, sorted by i, then j */
};

/* Every pair with distance <= radius_i + radius_j + margin (any unit, margin >= 0). A disc with a number that is not
 * finite (or 1e150 and more) or a radius that is not positive has no pair; skip (may be NULL): rows to leave out. */
int near_pairs_find(const double *x, const double *y, const double *radius, const unsigned char *skip, size_t count,
                    double margin, struct near_pairs *pairs);
void near_pairs_free(struct near_pairs *pairs); /* accepts a zeroed struct */

#endif
