/* What findgrains found where the scene left it out, as a piece of a scene. */
#ifndef REPORT_FOUND_H
#define REPORT_FOUND_H

#include "pipeline/numbers/geometry.h"

struct found {
    int frame_given;                     /* by the scene: none was looked for */
    int has_frame;                       /* found: */
    struct vec corners[4];               /* px */
    double corner_radius;                /* px */
    double least_radius, largest_radius; /* px, of the grains without a flag; NaN: there is none */
};

/* From a file of findgrains. */
int found_read(const char *path, struct found *found);
/* Members of a scene, "frame" (where one was found) and "grains", without braces around them; corners to 0.01 px, radii
 * to whole px outwards. To be freed; NULL with an error when out of memory. */
char *found_print(const struct found *found);

#endif
