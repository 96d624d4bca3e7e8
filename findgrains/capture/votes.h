/* Where grains may be: gradient votes for centres, one layer per radius (Kimme, Ballard and Sklansky, CACM 18 (1975)
 * 120; Loy and Zelinsky, IEEE PAMI 25 (2003) 959). Only edges that fall outwards vote, so that voids do not. */
#ifndef FINDGRAINS_VOTES_H
#define FINDGRAINS_VOTES_H

#include "findgrains/capture/cover.h"
#include "findgrains/look/level.h"
#include "findgrains/capture/candidates.h"

/* Peaks of the votes on a level for radii from `low` to `high` (level pixels), added to `peaks` in level coordinates.
 * `contrast` is the difference between grain and void in grey levels; what `cover` (of this level) hides is left out.
 */
int candidates_vote(const struct level *level, const struct cover *cover, double low, double high, double contrast,
                    struct candidates *peaks);

#endif
