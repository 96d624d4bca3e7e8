/* The side of a file stands in its attribute "coordinates": "seen" and "corrected" are px, on the photo side; all
 * else is a packing in m. */
#include "report/states/loaded.h"

#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/packing/packing_file.h"

void loaded_free(struct loaded *loaded)
{
    free(loaded->path);
    table_free(&PHOTO_GRAINS, &loaded->grains);
    packing_free(&loaded->packing);
    state_info_free(&loaded->info);
    memset(loaded, 0, sizeof *loaded);
}

const struct state_info *loaded_info(const struct loaded *loaded)
{
    return loaded->is_si ? &loaded->packing.info : &loaded->info;
}

/* Places, radii and flags have to be there; all other columns are read where they are. */
static int read_photo_side(const struct state *state, struct loaded *loaded)
{
    static const char *const required[] = {"x_px", "y_px", "radius_px", "flags", NULL};
    return state_read(state, "grains", &PHOTO_GRAINS, required, &loaded->grains);
}

int loaded_read(const char *path, struct loaded *loaded)
{
    memset(loaded, 0, sizeof *loaded);
    loaded->path = strdup(path);
    if (!loaded->path)
        return error_memory(path);
    struct state *state = state_open(path);
    int result = state ? state_read_info(state, &loaded->info) : -1;
    if (result == 0) {
        const char *coordinates = loaded->info.coordinates;
        loaded->is_si = strcmp(coordinates, "seen") && strcmp(coordinates, "corrected");
        if (!loaded->is_si)
            result = read_photo_side(state, loaded);
    }
    state_close(state);
    if (result == 0 && loaded->is_si) {
        state_info_free(&loaded->info);
        result = packing_read(path, &loaded->packing);
    }
    if (result)
        loaded_free(loaded);
    return result;
}
