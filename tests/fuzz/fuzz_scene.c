/* A scene is read or refused with one line; what was read can be used. */
#include <math.h>
#include <stdlib.h>

#include "pipeline/speak/error.h"
#include "pipeline/scene/scene.h"
#include "tests/fuzz/target.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct scene scene;
    error_clear();
    if (scene_read(fuzz_file(data, size), &scene)) {
        if (error_status() != EXIT_INPUT || !*error_message())
            abort();
        return 0;
    }
    if (scene.photos.pattern) {
        char *path = scene_photo_path(&scene, scene.photos.last);
        if (!path || scene_photo_index(&scene, path) != scene.photos.last)
            abort();
        free(path);
    }
    struct vec m = scene_metres(&scene, vec(1, 2));
    if (scene.scale > 0 && !(isfinite(m.x) && isfinite(m.y)))
        abort();
    scene_free(&scene);
    return 0;
}
