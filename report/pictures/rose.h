/* A polar histogram of contact directions, and of the normal forces over them: whether the packing bears more in one
 * direction than in another, in contacts or in forces. */
#ifndef REPORT_ROSE_H
#define REPORT_ROSE_H

#include "pipeline/draw/canvas.h"

#include "report/states/distribution.h"

struct rose_outline {
    char name[17];             /* of the method */
    size_t style;              /* chart_colour() */
    double mean_fn[ROSE_BINS]; /* over that of all contacts */
};

/* Into (0, 0, width, height), with the title above. share[b]: contacts in direction b over the mean of all directions,
 * NaN as 0. Wedges: share of contacts; outlines: mean fn by each method. The circle is 1, the mean of all directions.
 */
void rose_draw(struct canvas *canvas, double width, double height, const char *title, const double share[ROSE_BINS],
               const struct rose_outline *outlines, size_t count);

#endif
