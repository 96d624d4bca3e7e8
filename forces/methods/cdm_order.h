/* The order in which contact dynamics visits the contacts. */
#ifndef FORCES_CDM_ORDER_H
#define FORCES_CDM_ORDER_H

#include "forces/network/network.h"

/* Contacts contact[start[k]] .. contact[start[k + 1] - 1] share no grain (colour k), so that they can be visited at the
 * same time in any order. The last group is visited one by one: contacts with a wall, which all share its motion, and
 * those of a grain with more contacts than there are colours. */
struct cdm_order {
    int *contact;
    size_t *start;
    int colours; /* without the last group */
};

/* coloured 0: one group, in the order of the network. 0, or -1 when memory is gone; free it even then. */
int cdm_order_build(const struct network *network, int coloured, struct cdm_order *order);
void cdm_order_free(struct cdm_order *order); /* accepts a zeroed struct */

#endif
