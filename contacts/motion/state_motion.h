/* The motion columns of all contacts of a state: since the reference, and since the previous state with what is new and
 * what has opened. */
#ifndef CONTACTS_STATE_MOTION_H
#define CONTACTS_STATE_MOTION_H

#include "contacts/network/near_pairs.h"
#include "contacts/walls/frame.h"
#include "pipeline/packing/packing.h"

struct moved_state {
    const struct pairs *pairs; /* of the packing's contacts, row by row */
    const struct frame *frame;
    const struct vec *reference; /* positions in the reference; NULL: this is it, or unknown */
    int is_reference;
    const struct packing *previous; /* NULL: none */
    double candidate_sigmas;
};

/* un, ut and their errors, for pairs that may have touched in the reference. */
void move_since_reference(const struct moved_state *state, struct packing *packing);
/* dun, dut, their errors, and the flags CONTACT_NEW and CONTACT_OPENED. */
int move_since_previous(const struct moved_state *state, struct packing *packing);

#endif
