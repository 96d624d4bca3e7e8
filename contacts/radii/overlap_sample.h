/* The overlaps that tell the zero of all overlaps (radius_offset.h): of pairs between trusted grains near the pile-up
 * of contacts. */
#ifndef CONTACTS_OVERLAP_SAMPLE_H
#define CONTACTS_OVERLAP_SAMPLE_H

#include "contacts/network/near_pairs.h"

enum correction_kind { CORRECT_OFFSET, CORRECT_SCALE };

struct overlap_pair {
    size_t i, j;         /* grains */
    double x, s, branch; /* m: overlap, its stated error, distance of the centres */
    double lever;        /* d overlap / d correction */
};

struct overlap_sample {
    struct overlap_pair *pair;
    double *x, *s; /* m: overlaps moved by a correction, errors with a blur; the work of overlap_sample_move, _blur */
    size_t count, grains;
    double share;                   /* of the pairs between grains that are not idle: those in the sample */
    double lowest;                  /* only pairs with x / lever >= lowest are in the sample */
    double mean_lever, mean_branch; /* m */
    double error;                   /* m: median of s */
};

/* Which pairs count: gaps up to `farthest`, grains that are trusted and not idle. */
struct overlap_choice {
    const unsigned char *idle; /* of each grain (contact_network.h); NULL: none is */
    double farthest;           /* m */
    enum correction_kind kind;
};

/* round: every rim as a circle. */
int overlap_sample_take(const struct grains *grains, const struct pairs *pairs, const struct overlap_choice *choice,
                        int round, struct overlap_sample *sample);
void overlap_sample_free(struct overlap_sample *sample); /* accepts a zeroed struct */

/* Where the pile-up is and how wide its upper flank: the mode of x / lever, and the mean beyond it. */
void overlap_sample_pile(struct overlap_sample *sample, double *mode, double *width);
/* Leave out pairs far below the pile-up, where the density of gaps is no longer that near zero. */
void overlap_sample_cut(struct overlap_sample *sample, double lowest);

/* sample->x: with this correction of the radii. sample->s: with this much more error, m. */
void overlap_sample_move(struct overlap_sample *sample, double correction);
void overlap_sample_blur(struct overlap_sample *sample, double blur);

#endif
