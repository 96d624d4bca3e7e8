/* Who touches whom: the pairs of one state, the walls, what the overlaps tell about touching, and the contacts. */
#ifndef CONTACTS_CONTACT_NETWORK_H
#define CONTACTS_CONTACT_NETWORK_H

#include "contacts/contact_input.h"
#include "contacts/contact_summary.h"
#include "contacts/network/near_pairs.h"
#include "contacts/walls/frame.h"

/* Pairs of grains are of two kinds: where both can be squeezed by what they touch, and where one is idle, held by no
 * pair of contacts (stability.h): such a grain rests somewhere at no force, whatever its measured overlaps. Each kind
 * has its own shares of squeezed, resting and separate pairs. */
struct contact_network {
    struct pairs pairs;
    struct frame frame;
    double window, error; /* m: how far pairs were looked for; median standard error of their overlaps */
    struct pair_statistics bearing, idle_pairs;
    unsigned char *idle; /* of each grain; NULL: not known yet, every pair counts as bearing */
    int unbalanced;      /* 1: shapes that are not in equilibrium overlap at random (radius_offset.h), nothing rests */
    struct overlap_histogram histogram;
};

void contact_network_free(struct contact_network *network); /* accepts a zeroed struct */

/* Pairs, statistics, walls, and the tables /walls and /contacts of the packing, whose grains are given; what it held
 * before goes. network->idle is used when it is there. reference: positions in the reference photo; NULL: this is it.
 */
int contact_network_build(const struct contact_input *input, const struct contact_options *options,
                          const struct vec *reference, struct contact_network *network, struct packing *packing);

/* Find the idle grains from the contacts of the packing, without regard to loads: network->idle, NULL where most grains
 * are idle (there is nothing to be told apart then). Sets GRAIN_RATTLER and GRAIN_FLOATING. 0, or -1 when memory is
 * gone. */
int contact_network_find_idle(const struct contact_input *input, struct contact_network *network,
                              struct packing *packing);

#endif
