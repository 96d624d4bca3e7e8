#include "simulation/series_folder.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "pipeline/error.h"
#include "pipeline/new_file.h"

int series_folder_open(struct series_folder *folder, const struct scene *scene, const char *parameters,
                       const char *path)
{
    memset(folder, 0, sizeof *folder);
    folder->scene = scene;
    folder->parameters = parameters;
    folder->path = path;
    if (mkdir(path, 0777) && errno != EEXIST)
        return error_failed("%s: %s: name a folder that can be made", path, strerror(errno));
    struct stat status;
    if (stat(path, &status) || !S_ISDIR(status.st_mode))
        return error_failed("%s: not a folder: name another one", path);
    folder->loads_stream = open_memstream(&folder->loads, &folder->loads_size);
    if (!folder->loads_stream)
        return error_memory("loads.csv");
    fputs("index,wall,fx_N,fy_N\n", folder->loads_stream);
    return 0;
}

/* Named like the photo that render will make of the state; without photos 0000, 0001, ... */
static char *state_name(const struct series_folder *folder, int64_t index)
{
    char *photo = folder->scene->photos.given ? scene_photo_path(folder->scene, (long)index) : NULL, *name = NULL;
    if (folder->scene->photos.given && !photo)
        return NULL;
    const char *base = photo ? strrchr(photo, '/') : NULL, *end;
    base = base ? base + 1 : photo;
    end = base ? strrchr(base, '.') : NULL;
    int length = !base ? 0 : end ? (int)(end - base) : (int)strlen(base);
    if ((photo ? asprintf(&name, "%s/%.*s.truth.hdf", folder->path, length, base)
               : asprintf(&name, "%s/%04" PRId64 ".truth.hdf", folder->path, index)) < 0) {
        error_set(EXIT_FAILED, "out of memory: %s: use a machine with more memory", folder->path);
        name = NULL;
    }
    free(photo);
    return name;
}

static char *path_in(const struct series_folder *folder, const char *name)
{
    char *path = NULL;
    if (asprintf(&path, "%s/%s", folder->path, name) < 0) {
        error_set(EXIT_FAILED, "out of memory: %s: use a machine with more memory", name);
        return NULL;
    }
    return path;
}

int series_folder_save(const struct packing *packing, const struct simulation_state *state, void *user)
{
    struct series_folder *folder = user;
    struct provenance provenance = PROVENANCE_DEFAULT;
    char *path = state_name(folder, state->index);
    if (!path)
        return -1;
    provenance.stage = "simulate";
    provenance.parameters = folder->parameters;
    const char *const inputs[] = {folder->scene->path};
    provenance.input_paths = inputs;
    provenance.input_count = 1;
    provenance.index = state->index;
    provenance.time_s = scene_time(folder->scene, (long)state->index);
    provenance.coordinates = "si";
    memcpy(provenance.strain, state->strain, sizeof provenance.strain);
    provenance.length_m = packing->length_m;
    int status = packing_write(path, packing, &provenance);
    free(path);
    if (status)
        return -1;
    for (size_t w = 0; w < packing->walls.count; w++)
        fprintf(folder->loads_stream, "%" PRId64 ",%.*s,%.17g,%.17g\n", state->index, NAME_LENGTH,
                packing->walls.name[w], packing->walls.fx[w], packing->walls.fy[w]);
    folder->states++;
    folder->unrelaxed += !state->relaxed;
    return 0;
}

static int write_loads(const struct series_folder *folder, const char *path)
{
    struct new_file file;
    if (new_file_begin(&file, path))
        return -1;
    FILE *stream = fopen(file.temporary, "w");
    int written = stream && fwrite(folder->loads, 1, folder->loads_size, stream) == folder->loads_size;
    if (stream && fclose(stream))
        written = 0;
    if (!written) {
        error_set(EXIT_FAILED, "%s: %s: check the disk", path, strerror(errno));
        new_file_discard(&file);
        return -1;
    }
    return new_file_commit(&file);
}

int series_folder_close(struct series_folder *folder)
{
    int status = 0;
    if (folder->loads_stream && fclose(folder->loads_stream))
        status = error_memory("loads.csv");
    char *path = status || !folder->states ? NULL : path_in(folder, "loads.csv");
    if (path)
        status = write_loads(folder, path);
    free(path);
    free(folder->loads);
    folder->loads = NULL;
    folder->loads_stream = NULL;
    return status;
}
