/* Grey levels of voids and grains from the histogram inside the zone. */
#ifndef FINDGRAINS_THRESHOLD_H
#define FINDGRAINS_THRESHOLD_H

#include "pipeline/scene/photo.h"
#include "findgrains/look/zone.h"

struct grey_levels {
    double threshold;   /* Otsu's: largest variance between the two classes */
    double void_level;  /* median of the pixels at or below the threshold */
    double void_spread; /* of the voids: from their median down to the darkest sixth */
    double grain_level; /* median of the pixels above it */
    double separation;  /* variance between the classes over the whole variance, 0 to 1; 0: one grey level only */
    double noise;       /* of a pixel: from second differences along rows, fine texture included */
};

/* Levels of the pixels in the zone (every pixel of a coarse grid when the photo is large). A photo of one grey has
 * separation 0 and no levels: no error. 0, or -1 when memory is gone. */
int threshold_find(const struct photo *photo, const struct zone *zone, struct grey_levels *levels);

#endif
