/* The walls of one state: four straight segments whose lines start from the corners of the scene's frame (reference
 * photo), are refined by the grains that lie on them (support.h), follow the wall markers where there are some, else
 * the grains; and a disc on each corner when the frame has a corner radius. */
#ifndef CONTACTS_FRAME_H
#define CONTACTS_FRAME_H

#include "contacts/walls/support.h"
#include "pipeline/scene/lens.h"
#include "pipeline/packing/patches.h"
#include "pipeline/scene/scene.h"
#include "pipeline/packing/walls.h"

struct frame_request {
    const struct scene *scene;
    const struct lens *lens;       /* NULL: none */
    const struct grains *grains;   /* of this state */
    const struct vec *reference;   /* m: positions in the reference photo; NULL: this state is the reference */
    const struct patches *patches; /* NULL: none */
    struct rim_statistics statistics;
    double frame_error_px; /* of the corners in the scene; 0: exact, the grains are not asked */
};

/* Rows in the order bottom, right, top, left, then the discs; empty tables when the scene has no frame. */
struct frame {
    struct walls now, reference;
    double s_motion[8]; /* m: standard error of each wall's motion along its normal since the reference */
};

/* The walls in the reference and now. 0, or -1 when memory is gone; to be freed. */
int frame_walls(const struct frame_request *request, struct frame *frame);
void frame_free(struct frame *frame); /* accepts a zeroed struct */

/* Motion of each wall's middle since `before` into dx, dy, dangle (NaN where `before` has no such wall). */
void frame_motion(struct walls *walls, const struct walls *before);

/* Strain of the quadrilateral between the walls: exx, eyy (shortening positive), gamma = dux/dy + duy/dx (the top
 * moving to the right positive); NaN without both. */
void frame_strain(const struct walls *walls, const struct walls *reference, double strain[3]);

#endif
