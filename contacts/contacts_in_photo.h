/* The public call of contacts (CONTRIBUTING.md, "Public headers"): the scene says everything, no options are needed. */
#ifndef CONTACTS_CONTACTS_IN_PHOTO_H
#define CONTACTS_CONTACTS_IN_PHOTO_H

#include "pipeline/packing/packing.h"
#include "pipeline/packing/patches.h"
#include "pipeline/scene/scene.h"

/* The contact network of photo `index` in SI units (m, rad, N; x right, y up), with the scene's loads on its walls.
 * grains: of grains_in_photo() (as seen) or of track_photo() (with the column x_seen_px; lens undone). patches: of
 * track_photo(); NULL: none. previous: the packing of the photo before, for dun and dut; NULL: none. From the scene:
 * scale, frame, lens, grains, contact, gravity, loads, section "contacts".
 *
 * Fills `packing`, which must be zeroed: grains (the same rows), walls (bottom right top left, then corner discs; none
 * without a frame), contacts (sorted by i, then j; j from the number of grains on: a wall; overlap in m, its
 * probability of being positive; those flagged CONTACT_CANDIDATE are not decided), indeterminacy, strain between the
 * walls.
 *
 * Inputs stay the caller's; packing_free() frees the result, which is empty after a failure. 0, or -1 with a line
 * (pipeline/speak/error.h): no scale, no density under gravity, tables that do not fit each other, no loads for this
 * photo (EXIT_INPUT); memory is gone (EXIT_FAILED). How: docs/contacts.md, docs/theory.md section 1. */
int contacts_in_photo(const struct scene *scene, const struct photo_grains *grains, const struct patches *patches,
                      int64_t index, const struct packing *previous, struct packing *packing);

#endif
