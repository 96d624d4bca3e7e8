/* What the loads say about the overlaps. By Weber's formula (thesis, eq. 3.5) the stress is sigma = (1/V) sum f l over
 * all contacts, l from centre to centre: friction forces are at right angles to l between round rods, so that
 *
 *     sum f_n |l| = V tr sigma,      and with f_n = k_n x:      sum x |l| = V tr sigma / k_n,
 *
 * whatever the network looks like. V tr sigma = - sum F x over walls and weights (stress.h). */
#ifndef CONTACTS_LOADED_OVERLAPS_H
#define CONTACTS_LOADED_OVERLAPS_H

#include "contacts/contact_input.h"

/* m2: sum of overlap times branch over the contacts between grains; 0: not known, for want of a frame, of loads in both
 * directions, of a stiffness, of pressure, or because the law is not linear. Walls carry their share of V tr sigma with
 * branches of one radius instead of two: they are 2 <R> / side of the specimen, which is taken off. */
int loaded_overlaps(const struct contact_input *input, const struct grains *grains, double *sum);

#endif
