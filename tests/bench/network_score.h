/* Contacts that a program named, against those that are: precision, recall and F1 in several readings, the best plain
 * threshold that the truth could choose, and the reliability of the probabilities. Shared by the benches of contacts.
 *
 * A true contact has a true overlap above zero. In a packing without weight some grains carry nothing and rest against
 * their neighbours at a gap of zero, contacts by convention only; hence the reading "carrying": true contacts are those
 * with more than 1 % of the mean overlap, and pairs below that, or with a grain that has fewer than two of these, count
 * neither way. */
#ifndef BENCH_NETWORK_SCORE_H
#define BENCH_NETWORK_SCORE_H

#include "pipeline/packing/contacts.h"

struct scored_pair {
    double overlap, probability; /* as measured and stated */
    double truth;                /* overlap; -1 or NaN: apart */
    int contact;                 /* named one */
    int idle;                    /* one of its grains is flagged as a rattler */
    int wall;
    int carries; /* in truth both its grains carry something */
};

/* One network: the pairs of the file, and the true contacts that are not in it. */
struct scored_network {
    struct scored_pair *pair;
    size_t count, room;
    double missing, missing_carrying; /* true contacts that the file does not have, even as candidates */
    double missing_wall;
    double mean; /* true overlap */
};

int scored_network_add(struct scored_network *network, struct scored_pair pair);
void scored_network_free(struct scored_network *network);

/* carries[k] = 1 where grain k has at least two contacts of more than 1 % of the mean overlap; returns that mean. */
double find_carrying(const struct contacts *truth, size_t grains, unsigned char *carries);

struct hits {
    double found, right, expected;
};
double precision(struct hits hits);
double recall(struct hits hits);
double f1(struct hits hits);

enum { SCORE_BINS = 10, RULES = 9 };
struct network_figures {
    struct hits all, bearing, carrying, walls; /* bearing: without the contacts of grains flagged as rattlers */
    struct hits best, best_carrying;           /* with the best threshold on the measured overlap */
    struct hits rule[RULES];                   /* contacts: probability above 0.1, 0.2 ... 0.9 */
    struct reliability {
        double count[SCORE_BINS], is[SCORE_BINS], stated[SCORE_BINS];
    } every, decidable; /* all pairs; without those that count neither way */
};

/* Adds one network to the sums; `figures` starts zeroed. Sorts the pairs. */
void network_figures_add(struct scored_network *network, struct network_figures *figures);
void print_reliability(const struct network_figures *figures);

#endif
