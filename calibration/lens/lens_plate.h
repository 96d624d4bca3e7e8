/* Photos of a speckled plate: a grid of discs of the reference followed into the others. */
#ifndef CALIBRATION_LENS_PLATE_H
#define CALIBRATION_LENS_PLATE_H

#include "calibration/lens/lens_points.h"
#include "tracker/follow/track_grains.h"

struct plate_options {
    double radius_px; /* of a disc; 0: a sixtieth of the photo's smaller side, at least 16 */
    double search_px, search_deg;
};
#define PLATE_DEFAULT                                                                                                  \
    {                                                                                                                  \
        .search_px = 400, .search_deg = 30                                                                             \
    }

/* What was followed; `points` borrows from the arrays. */
struct plate {
    struct lens_points points;
    struct vec *reference, *seen;
    double *sigma;
};

/* Reads the photos (plain grey, of one size), follows the grid, fills the plate, which is to be freed, after a failure
 * too. 0, or -1 with a line that names the photo. */
int plate_follow(const char *reference, char *const *photos, size_t count, const struct plate_options *options,
                 struct plate *plate);
void plate_free(struct plate *plate); /* accepts a zeroed struct */

#endif
