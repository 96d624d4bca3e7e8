/* The specimen's frame from the grains that lean against it: the dark frame itself shows little against dark voids,
 * but its four straight sides are tangent to many rims and have none behind them. */
#ifndef FINDGRAINS_FIND_FRAME_H
#define FINDGRAINS_FIND_FRAME_H

#include "pipeline/numbers/geometry.h"
#include "pipeline/packing/grains.h"
#include "findgrains/look/zone.h"

struct found_frame {
    int found; /* all four sides */
    struct vec corners[4];
    double s_corners[4][2]; /* px, standard errors of x and y */
    double corner_radius;   /* px: discs of this radius at the corners touch no grain; 0: the corners are square */
    int touching[4];        /* grains that lean against top, right, bottom, left */
};

/* From rims in photo coordinates (x_px y_px radius_px flags; shape_c shape_s where there), flagged ones left out. Not
 * found (no error) unless each side has six or more grains leaning against it, over half the specimen's width. 0, or -1
 * when memory is gone. */
int find_frame(const struct photo_grains *grains, struct found_frame *frame);
/* Flags what lies behind the frame as cut (labels, screws). */
void find_frame_flag(const struct zone *zone, struct photo_grains *grains);

#endif
