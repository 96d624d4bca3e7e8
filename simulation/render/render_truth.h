/* What the photo shows, from a packing in metres to the picture in px, and the truth file beside the photo. */
#ifndef SIMULATION_RENDER_TRUTH_H
#define SIMULATION_RENDER_TRUTH_H

#include "pipeline/packing/packing.h"
#include "pipeline/packing/patches.h"
#include "pipeline/scene/scene.h"
#include "simulation/render/optics.h"
#include "simulation/render/picture.h"

/* Exactly what is where in one photo. */
struct photo_truth {
    struct photo_grains grains; /* corrected and as seen */
    struct contacts contacts;   /* m: of the faces as drawn */
    struct view view;           /* of the camera */
    struct patches patches;     /* paper as seen; wall markers without the camera's motion */
};
void photo_truth_free(struct photo_truth *truth);

/* Grains (with the faces' shapes drawn at random when the packing has none), frame, hinges, paper and markers of the
 * packing. The picture borrows truth->grains and *plates; the latter is to be freed. */
int picture_of(const struct packing *packing, const struct optics *optics, const struct scene *scene, long index,
               const struct lens *lens, struct photo_truth *truth, struct plate **plates, struct picture *picture);
/* Every pair of faces, and face and wall, that overlap along the branch: R_i + R_j - d > 0, rim radii along it. */
int face_contacts(const struct packing *packing, const struct photo_grains *grains, double scale,
                  struct contacts *contacts);
/* Beside PHOTO.tif: PHOTO.photo-truth.hdf. To be freed. */
char *photo_truth_path(const char *photo_path);
int photo_truth_write(const char *path, const struct photo_truth *truth, const struct scene *scene, long index,
                      const char *input_path);

#endif
