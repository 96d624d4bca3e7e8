/* How the virtual camera and the painted rods look: the scene's "optics" section (docs/render.md). Lengths are px of
 * the photo, grey levels fractions of the sensor's full scale. */
#ifndef SIMULATION_OPTICS_H
#define SIMULATION_OPTICS_H

#include <stdint.h>

#include "pipeline/scene/scene.h"
#include "simulation/render/camera.h"

enum { PAINT_MAX = 4 };

/* Dots of paint thrown at random (a Boolean model): radii and levels uniform within their ranges. */
struct paint {
    double radius_min, radius_max; /* px */
    double coverage;               /* share of the area that the dots cover, 0 <= coverage < 1 */
    double level_min, level_max;
};

/* The look of one kind of body: a level, and dots of paint on it. */
struct surface {
    double level, spread;          /* level of one body: level (1 + spread N(0, 1)) */
    struct paint paint[PAINT_MAX]; /* later ones on top */
    int paint_count;
};

struct optics {
    uint64_t seed;
    double psf;                    /* px: standard deviation of the Gaussian point spread, >= OPTICS_PSF_MIN */
    int bits;                      /* steps of the sensor: 2^bits - 1 over the full scale, in 16-bit words */
    double read_noise, shot_noise; /* standard deviation: sqrt(read^2 + shot^2 level) */
    double exposure;               /* multiplies every level before the sensor cuts at 0 and 1 */
    double shading;                /* the corners of the photo are darker by this share */
    struct surface grain, hollow, frame, hinge, outside, paper, marker, label;
    double ring_spacing, ring_contrast;        /* px; 0: no wood rings */
    double bevel_width, bevel_depth;           /* px; the rim darkens by this share over this width */
    double line_share, line_width, line_level; /* share of the rods with a pencil line; px */
    double parallax, flank_level;              /* px that a rod's far end is displaced per px from the photo's middle */
    struct rect *labels;                       /* bright things that are not grains, px; owned */
    size_t label_count;
    double ellipticity; /* mean of (longest - shortest radius) / mean radius of the faces; 0: circles */
    double frame_width; /* px: thickness of the steel around the specimen */
    struct view wander; /* standard deviations of the camera's motion between photos; zoom: of zoom - 1 */
};
#define OPTICS_PSF_MIN 0.3
#define OPTICS_DEFAULT                                                                                                 \
    {                                                                                                                  \
        .seed = 1, .psf = 0.7, .bits = 12, .read_noise = 0.005, .shot_noise = 0.005, .exposure = 1,                    \
        .grain = {.level = 0.5,                                                                                        \
                  .spread = 0.08,                                                                                      \
                  .paint = {{1.0, 2.5, 0.35, 0.2, 0.4}, {1.0, 2.0, 0.2, 0.55, 0.8}},                                   \
                  .paint_count = 2},                                                                                   \
        .hollow = {.level = 0.03}, .frame = {.level = 0.06}, .hinge = {.level = 0.7}, .outside = {.level = 0.2},       \
        .paper = {.level = 0.8, .paint = {{1.0, 2.5, 0.5, 0.05, 0.2}}, .paint_count = 1}, .label = {.level = 0.95},    \
        .line_width = 2, .line_level = 0.2, .flank_level = 0.25,                                                       \
        .marker = {.level = 0.8, .paint = {{1.0, 2.5, 0.5, 0.05, 0.2}}, .paint_count = 1}, .frame_width = 30           \
    }
/* One grey grain, no paint, no noise, 16-bit steps: what tests of edges want. */
#define OPTICS_PLAIN                                                                                                   \
    {                                                                                                                  \
        .seed = 1, .psf = 0.7, .bits = 16, .exposure = 1, .grain = {.level = 0.5}, .hollow = {.level = 0.05},          \
        .frame = {.level = 0.05}, .hinge = {.level = 0.7}, .outside = {.level = 0.05}, .frame_width = 30               \
    }

/* The camera of photo `index`: a normal draw per photo, none in the reference photo. */
struct view optics_view(const struct optics *optics, long index, long reference);

/* The scene's "optics" over OPTICS_DEFAULT; unknown keys and values out of range are errors with line and column. */
int optics_read(const struct scene *scene, struct optics *optics);
void optics_free(struct optics *optics); /* what optics_read() allocated; accepts a zeroed struct */

#endif
