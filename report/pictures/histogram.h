/* The grey levels of a photo (thesis Fig. 4.16): two hills, voids and grains, between which a threshold has to lie; a
 * level at the end of the scale that stands out says that the photo is saturated. */
#ifndef REPORT_HISTOGRAM_H
#define REPORT_HISTOGRAM_H

#include "pipeline/scene/photo.h"
#include "pipeline/scene/scene.h"

enum { HISTOGRAM_BINS = 256 };

struct histogram {
    double density[HISTOGRAM_BINS]; /* share of the pixels per bin of equal width over 0 to `most` */
    double most;                    /* the largest level of the file: 65535 or 255 */
    size_t pixels;
};

/* Of the pixels inside the scene's frame, of all without one (scene NULL, or without frame). */
void histogram_make(const struct photo *photo, const struct scene *scene, struct histogram *histogram);

#endif
