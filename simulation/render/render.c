/* Tiles of the photo, each by one thread: painted in cells finer than pixels, then exposed. Nothing passes from tile to
 * tile, and all random numbers have keys, so that the photo does not depend on threads or on the order of tiles. */
#include "simulation/render/render.h"

#include <math.h>
#include <stdlib.h>

#include "pipeline/speak/error.h"
#include "simulation/render/layers.h"
#include "simulation/render/sensor.h"

/* Paint and expose the tiles that this thread gets; every thread must reach the loop. */
static int expose_tiles(const struct picture *picture, const struct optics *optics, const struct sensor *sensor,
                        struct photo *photo)
{
    struct camera camera = picture_camera(picture);
    int across = (photo->width + TILE_PIXELS - 1) / TILE_PIXELS, down = (photo->height + TILE_PIXELS - 1) / TILE_PIXELS;
    struct tile tile;
    int status = tile_alloc(&tile, sensor->margin);
    float *scratch = malloc(((size_t)tile.width + 1) * sizeof *scratch);
    if (!scratch)
        status = error_memory("a row of a tile");
#pragma omp for schedule(dynamic)
    for (long t = 0; t < (long)across * down; t++) {
        if (status)
            continue;
        tile_begin(&tile, &camera, (int)(t % across) * TILE_PIXELS, (int)(t / across) * TILE_PIXELS);
        layers_paint(picture, optics, &tile);
        sensor_expose(sensor, &tile, scratch, photo);
    }
    free(scratch);
    tile_free(&tile);
    return status;
}

int render_picture(const struct picture *picture, const struct optics *optics, struct photo *photo)
{
    struct sensor sensor;
    struct error_shared shared = ERROR_SHARED_NONE;
    if (sensor_begin(&sensor, optics, picture->index, picture->view.blur,
                     picture->view.brightness > 0 ? picture->view.brightness : 1))
        return -1;
    if (photo_alloc(photo, picture->width, picture->height))
        return -1;
#pragma omp parallel
    if (expose_tiles(picture, optics, &sensor, photo))
        error_share(&shared, 0);
    if (!error_collect(&shared))
        return 0;
    photo_free(photo);
    return -1;
}

int render(const struct packing *packing, const struct optics *optics, const struct scene *scene, long index,
           struct photo *photo, struct photo_truth *truth)
{
    struct picture picture;
    struct plate *plates = NULL;
    *truth = (struct photo_truth){0};
    struct lens lens;
    int status = scene->lens ? lens_read(scene->lens, &lens) : 0;
    status = status || picture_of(packing, optics, scene, index, scene->lens ? &lens : NULL, truth, &plates, &picture);
    status = status || face_contacts(packing, &truth->grains, scene->scale, &truth->contacts);
    status = status || render_picture(&picture, optics, photo);
    free(plates);
    if (!status)
        return 0;
    photo_truth_free(truth);
    return -1;
}
