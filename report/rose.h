/* A polar histogram of contact directions. */
#ifndef REPORT_ROSE_H
#define REPORT_ROSE_H

#include <cairo.h>

#include "report/distribution.h"

/* Wedges: share of contacts; outline: mean fn (NULL: none). The circle is 1, as without any preferred direction. */
void rose_draw(cairo_t *cairo, double width, double height, const char *title, const double share[ROSE_BINS],
               const double mean_fn[ROSE_BINS]);

#endif
