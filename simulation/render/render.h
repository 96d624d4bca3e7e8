/* The virtual camera: a packing becomes a 16-bit photo of speckled rods, and the truth of what is where in it.
 *
 * Photo value = sensor(point spread * pixel * scene) at every pixel's middle, where the scene is a function: each
 * grain's paint is evaluated from positions turned back into that grain's frame (speckle.c), never from a picture.
 * Values depend on the seed, the photo's index and the pixel only, not on tiles or threads. */
#ifndef SIMULATION_RENDER_H
#define SIMULATION_RENDER_H

#include "pipeline/packing/packing.h"
#include "pipeline/scene/photo.h"
#include "pipeline/scene/scene.h"
#include "simulation/render/optics.h"
#include "simulation/render/picture.h"
#include "simulation/render/render_truth.h"

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

/* The photo of a packing (SI side: m, y up) through the scene's scale, origin, frame, lens and size, and the truth that
 * belongs to it; `index` is the photo's in its series: another index, other noise and another motion of the camera
 * (none in the scene's reference). 0, or -1 with a line: the scene lacks scale_m_per_px or photos.size_px, the lens
 * cannot be read, memory is gone. Photo and truth are to be freed; on failure they are empty. */
int render(const struct packing *packing, const struct optics *optics, const struct scene *scene, long index,
           struct photo *photo, struct photo_truth *truth);

#endif
