#include "simulation/series_folder.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "pipeline/speak/error.h"
#include "pipeline/files/new_file.h"
#include "pipeline/packing/packing_file.h"

static const char LOADS_HEADER[] = "index,wall,fx_N,fy_N\n";
static const char SUMMARY_HEADER[] =
    "index,exx,eyy,gamma,sxx_N_per_m,syy_N_per_m,sxy_N_per_m,applied_xx_N_per_m,applied_yy_N_per_m,applied_xy_N_per_m,"
    "kappa,solid,z,h,rattlers,sliding,inertial_number,stored_J,lost_J,work_J,unbalanced,static,steps\n";

/* A table of text in memory, with its line of headings. -1 without memory. */
static int table_begin(struct text_table *table, const char *header)
{
    table->stream = open_memstream(&table->text, &table->size);
    if (!table->stream)
        return error_memory("tables of the series");
    fputs(header, table->stream);
    return 0;
}

int series_folder_open(struct series_folder *folder, const struct scene *scene, const char *parameters,
                       const char *path, long states)
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
    if (table_begin(&folder->loads, LOADS_HEADER) || table_begin(&folder->summary, SUMMARY_HEADER))
        return -1;
    progress_begin(&folder->progress, "states", (size_t)states);
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

/* FOLDER/NAME, to be freed; NULL with an error. */
static char *path_in(const struct series_folder *folder, const char *name)
{
    char *path = NULL;
    if (asprintf(&path, "%s/%s", folder->path, name) < 0) {
        error_set(EXIT_FAILED, "out of memory: %s: use a machine with more memory", name);
        return NULL;
    }
    return path;
}

/* One state as a line of states.csv; what is not known is an empty cell. */
static void summary_row(FILE *stream, const struct simulation_state *s)
{
    const double numbers[] = {s->strain[0],     s->strain[1],    s->strain[2],     s->stress[0][0],
                              s->stress[1][1],  s->stress[0][1], s->applied[0][0], s->applied[1][1],
                              s->applied[0][1], s->kappa,        s->solid,         s->z,
                              s->indeterminacy, s->rattlers,     s->sliding,       s->inertial,
                              s->stored,        s->lost,         s->work,          s->unbalanced};
    fprintf(stream, "%" PRId64, s->index);
    for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++)
        if (isfinite(numbers[k]))
            fprintf(stream, ",%.17g", numbers[k]);
        else
            fputc(',', stream);
    fprintf(stream, ",%d,%ld\n", s->relaxed, s->steps);
}

/* The whole file, with the state in a few numbers as attributes of /state. */
static int state_file(const char *path, const struct packing *packing, const struct simulation_state *s,
                      struct provenance *provenance)
{
    const double rest = s->relaxed;
    const struct state_number numbers[] = {
        {"pressure_N_per_m", &s->pressure, 1},
        {"weber_stress_N_per_m", &s->stress[0][0], 4},
        {"wall_stress_N_per_m", &s->applied[0][0], 4},
        {"kappa", &s->kappa, 1},
        {"solid_fraction", &s->solid, 1},
        {"z", &s->z, 1},
        {"h", &s->indeterminacy, 1},
        {"rattlers", &s->rattlers, 1},
        {"sliding", &s->sliding, 1},
        {"inertial_number", &s->inertial, 1},
        {"stored_J", &s->stored, 1},
        {"lost_J", &s->lost, 1},
        {"work_J", &s->work, 1},
        {"unbalanced", &s->unbalanced, 1},
        {"static", &rest, 1},
    };
    provenance->numbers = numbers;
    provenance->number_count = sizeof numbers / sizeof *numbers;
    int status = packing_write(path, packing, provenance);
    provenance->numbers = NULL;
    provenance->number_count = 0;
    return status;
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
    int status = state_file(path, packing, state, &provenance);
    free(path);
    if (status)
        return -1;
    for (size_t w = 0; w < packing->walls.count; w++)
        if (!wall_is_disc(&packing->walls, w)) /* the loads of corner discs are in those of the sides */
            fprintf(folder->loads.stream, "%" PRId64 ",%.*s,%.17g,%.17g\n", state->index, NAME_LENGTH,
                    packing->walls.name[w], packing->walls.fx[w], packing->walls.fy[w]);
    summary_row(folder->summary.stream, state);
    folder->states++;
    folder->unrelaxed += !state->relaxed;
    progress_step(&folder->progress);
    return 0;
}

/* The table as a whole file or none. 0, or -1 with an error. */
static int table_write(struct text_table *table, const char *path)
{
    struct new_file file;
    if (new_file_begin(&file, path))
        return -1;
    FILE *stream = fopen(file.temporary, "w");
    int written = stream && fwrite(table->text, 1, table->size, stream) == table->size;
    if (stream && fclose(stream))
        written = 0;
    if (!written) {
        error_set(EXIT_FAILED, "%s: %s: check the disk", path, strerror(errno));
        new_file_discard(&file);
        return -1;
    }
    return new_file_commit(&file);
}

/* Writes the table when there is something in it, and frees it. */
static int table_end(const struct series_folder *folder, struct text_table *table, const char *name)
{
    int status = table->stream && fclose(table->stream) ? error_memory(name) : 0;
    if (!status && table->stream && folder->states) {
        char *path = path_in(folder, name);
        status = path ? table_write(table, path) : -1;
        free(path);
    }
    free(table->text);
    *table = (struct text_table){0};
    return status;
}

int series_folder_close(struct series_folder *folder)
{
    if (folder->progress.what)
        progress_end(&folder->progress);
    int loads = table_end(folder, &folder->loads, "loads.csv");
    int summary = table_end(folder, &folder->summary, "states.csv");
    return loads || summary ? -1 : 0;
}
