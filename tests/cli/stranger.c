/* A program of somebody else, built against what is installed (tests/cli/install): two photos of a scene through all
 * stages in memory, and the last state through a file.
 *
 *     stranger SCENE.json STATE.hdf        prints: grains contacts followed, stress over the applied one */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "contacts/contacts_in_photo.h"
#include "findgrains/grains_in_photo.h"
#include "forces/forces_in_packing.h"
#include "pipeline/packing/packing_file.h"
#include "pipeline/packing/stress.h"
#include "pipeline/packing/structure.h"
#include "pipeline/speak/error.h"
#include "tracker/track_photo.h"

/* All of it is empty before; release() takes everything back. */
struct work {
    struct scene scene;
    struct photo photos[2];
    struct photo_grains grains, tracked;
    struct patches patches;
    struct packing packings[2], again;
};

static int read_photo(const struct scene *scene, long index, struct photo *photo)
{
    const struct photo_request request = scene_photo_request(scene);
    char *path = scene_photo_path(scene, index);
    int status = path ? photo_read(path, &request, photo) : -1;
    free(path);
    return status;
}

/* The reference as found, the next photo as tracked: two networks with their forces. */
static int measure(struct work *work)
{
    const struct scene *scene = &work->scene;
    struct packing *packings = work->packings;
    return read_photo(scene, 0, &work->photos[0]) || read_photo(scene, 1, &work->photos[1]) ||
           grains_in_photo(scene, &work->photos[0], &work->grains) ||
           track_photo(scene, &work->photos[0], &work->grains, &work->photos[1], NULL, &work->tracked,
                       &work->patches) ||
           contacts_in_photo(scene, &work->grains, NULL, 0, NULL, &packings[0]) ||
           contacts_in_photo(scene, &work->tracked, &work->patches, 1, &packings[0], &packings[1]) ||
           forces_in_packing(scene, "map", NULL, &packings[0]) ||
           forces_in_packing(scene, "map", &packings[0], &packings[1]) || forces_in_series(scene, packings, 2);
}

static int write_and_read(const char *path, struct work *work)
{
    struct provenance provenance = PROVENANCE_DEFAULT;
    provenance.stage = "stranger";
    provenance.coordinates = "si";
    provenance.index = 1;
    provenance.length_m = work->packings[1].length_m;
    return packing_write(path, &work->packings[1], &provenance) || packing_read(path, &work->again);
}

/* One line per method: "map 120 grains 120 followed 231 contacts, stress 1.0000 1.0000". */
static int print(const struct work *work)
{
    const struct packing *packing = &work->again;
    struct fabric fabric;
    double area, applied[2][2];
    size_t followed = 0;
    if (packing_area(packing, &area))
        return -1;
    stress_applied(packing, area, applied);
    packing_fabric(packing, area, &fabric);
    for (size_t k = 0; k < work->tracked.count; k++)
        followed += !(work->tracked.flags[k] & GRAIN_DISTRUST);
    for (size_t m = 0; m < packing->force_count; m++) {
        const struct forces *forces = &packing->forces[m];
        double sigma[2][2];
        stress_weber(packing, forces->contact.fn, forces->contact.ft, area, sigma);
        printf("%s %zu grains %zu followed %zu contacts, stress %.4f %.4f\n", forces->method, packing->grains.count,
               followed, fabric.contacts, sigma[0][0] / applied[0][0], sigma[1][1] / applied[1][1]);
    }
    return 0;
}

static void release(struct work *work)
{
    packing_free(&work->again);
    packing_free(&work->packings[1]);
    packing_free(&work->packings[0]);
    table_free(&PATCHES, &work->patches);
    table_free(&PHOTO_GRAINS, &work->tracked);
    table_free(&PHOTO_GRAINS, &work->grains);
    photo_free(&work->photos[1]);
    photo_free(&work->photos[0]);
    scene_free(&work->scene);
}

int main(int argc, char **argv)
{
    struct work work = {0};
    int status = argc != 3 || scene_read(argv[1], &work.scene) || measure(&work) || write_and_read(argv[2], &work) ||
                 print(&work);
    if (status)
        fprintf(stderr, "stranger: %s\n", error_message());
    release(&work);
    return status;
}
