/* Which grains can carry a force: mechanical checks of the network (docs/theory.md section 1). */
#ifndef CONTACTS_STABILITY_H
#define CONTACTS_STABILITY_H

#include "pipeline/packing/packing.h"

struct stability_rules {
    double mu, mu_wall; /* NaN: not known: any two contacts hold */
    int weightless;     /* 1: ask who can be squeezed, whatever the loads */
};

/* Peel off grains that their contacts cannot hold (holding.h), again and again, since what they touch loses a contact
 * with them: these are flagged GRAIN_RATTLER, and GRAIN_FLOATING too when a load (weight) acts on them, because then a
 * contact was missed. Candidates do not count, contacts with walls and fixed grains do. Grains without a position carry
 * nothing and are flagged neither way. Old flags of either kind are cleared first. */
int stability_flag(struct packing *packing, const struct stability_rules *rules);

/* The same, but while a grain floats that has a candidate, its most probable one becomes a contact (CONTACT_PROMOTED);
 * one per floating grain and round. *promoted: how many. */
int stability_repair(struct packing *packing, const struct stability_rules *rules, size_t *promoted);

#endif
