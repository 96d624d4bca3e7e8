/* The contact network of one photo in SI units: grains, walls and every pair that touches or may touch, with its
 * overlap, its probability and its motion. Photo pixels end here. */
#ifndef CONTACTS_FIND_CONTACTS_H
#define CONTACTS_FIND_CONTACTS_H

#include "contacts/contact_input.h"
#include "contacts/contact_summary.h"

/* The network of one photo into `packing`, which must be zeroed and is left empty on failure: tables /grains (rows of
 * input->grains), /walls (bottom right top left, then corner discs; none without a frame) and /contacts (sorted by i,
 * then j; j from the number of grains on: a wall; candidates included, flagged); m, rad, y up. packing->info.strain is
 * the strain between the walls. Loads are not applied (loads_apply). summary may be NULL.
 *
 * 0, or -1 with a line: the scene lacks a scale, or a density under gravity; tables do not fit each other; two grains
 * have one centre (all EXIT_INPUT); memory is gone. */
int find_contacts(const struct contact_input *input, const struct contact_options *options, struct packing *packing,
                  struct contact_summary *summary);

/* A packing of so many grains hangs together somewhere: has this one no contact, or a dense one less than half a
 * contact per grain? */
int contacts_are_few(const struct contact_summary *summary);

/* packing_indeterminacy() with the friction of the scene (not given: friction everywhere), into packing and summary;
 * apply the loads first. 0, or -1 when out of memory. */
int contact_indeterminacy(const struct scene *scene, struct packing *packing, struct contact_summary *summary);

#endif
