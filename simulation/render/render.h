/* The virtual camera: a packing becomes a 16-bit photo of speckled rods, and the truth of what is where in it.
 *
 * Photo value = sensor(point spread * pixel * scene) at every pixel's middle, where the scene is a function: each
 * grain's paint is evaluated from positions turned back into that grain's frame (speckle.c), never from a picture.
 * Values depend on the seed, the photo's index and the pixel only, not on tiles or threads. */
#ifndef SIMULATION_RENDER_H
#define SIMULATION_RENDER_H

#include "pipeline/packing/packing.h"
#include "pipeline/packing/patches.h"
#include "pipeline/scene/photo.h"
#include "pipeline/scene/scene.h"
#include "simulation/render/camera.h"
#include "simulation/render/optics.h"

struct drawn_disc {
    double x, y, radius; /* px */
};

/* A rectangle: speckled paper fixed beside the machine, a speckled marker on a wall, or a bright label. */
enum plate_kind { PLATE_PAPER, PLATE_MARKER, PLATE_LABEL };
struct plate {
    enum plate_kind kind;
    char name[NAME_LENGTH];     /* "paper", or the wall's */
    double x, y, width, height; /* px: middle, sides */
    double angle;               /* rad, counter-clockwise as seen */
    double x_ref, y_ref;        /* px: middle in the scene's rectangle */
};

/* What the camera looks at, in px of the photo (x right, y down, pixel middles at integers). */
struct picture {
    int width, height;
    long index;                        /* of the photo in its series: another index, other noise */
    const struct photo_grains *grains; /* x_px y_px radius_px; angle, shape_c, shape_s when there. Row k is always
                                          painted the same way, wherever it goes */
    int framed;                        /* is there a steel frame around the specimen? */
    struct vec corners[4];             /* where its inner lines meet, in the order of enum CORNER_* */
    struct drawn_disc hinges[4];       /* convex discs of the frame */
    int hinge_count;
    const struct plate *plates;
    size_t plate_count;
    struct view view;        /* the camera's motion; zeroed: none */
    const struct lens *lens; /* NULL: none */
};

/* The photo of a picture: the short way for tests. Grains by hand:
 *
 *     struct photo_grains grains = {0};
 *     static const char *const columns[] = {"x_px", "y_px", "radius_px", "angle", NULL};
 *     table_alloc(&PHOTO_GRAINS, &grains, count, columns);   // then fill the arrays
 *     struct optics optics = OPTICS_DEFAULT;
 *     struct picture picture = {.width = 400, .height = 300, .grains = &grains};
 *     struct photo photo = {0};
 *     render_picture(&picture, &optics, &photo);
 */
int render_picture(const struct picture *picture, const struct optics *optics, struct photo *photo);
/* The camera that takes it. */
struct camera picture_camera(const struct picture *picture);

/* Exactly what is where in one photo. */
struct photo_truth {
    struct photo_grains grains; /* corrected and as seen */
    struct contacts contacts;   /* m: of the faces as drawn */
    struct view view;           /* of the camera */
    struct patches patches;     /* paper as seen; wall markers without the camera's motion */
};
void photo_truth_free(struct photo_truth *truth);

/* The photo of a packing (SI side) through the scene's scale, frame and size; `index` is the photo's in its series. */
int render(const struct packing *packing, const struct optics *optics, const struct scene *scene, long index,
           struct photo *photo, struct photo_truth *truth);

#endif
