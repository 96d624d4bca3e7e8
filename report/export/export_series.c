/* A LAMMPS dump is one block per step: its time step (here the photo's index), the number of rows, the box, the rows.
 * The box is that of the grains' rims, 0 to 1 when there is none. A .series file is JSON that names files and times;
 * OVITO and ParaView sort nothing, so the files are sorted by time here. */
#include "report/export/export_series.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/files/json.h"
#include "report/states/method_choice.h"

/* ---- LAMMPS ---- */

/* m; from > to: empty. */
struct range {
    double from, to;
};

/* Heading of one step. `what`: "ATOMS" or "ENTRIES", `count` of which follow. The box is fixed (ff); along z, where
 * nothing is, it is -1 to 1. */
static void put_step(const struct loaded *loaded, const char *what, size_t count, const struct range box[2],
                     FILE *stream)
{
    fprintf(stream, "ITEM: TIMESTEP\n%" PRId64 "\nITEM: NUMBER OF %s\n%zu\nITEM: BOX BOUNDS ff ff ff\n",
            loaded_info(loaded)->index, what, count);
    for (int a = 0; a < 2; a++)
        fprintf(stream, "%.17g %.17g\n", box[a].from, box[a].to);
    fputs("-1 1\n", stream);
}

/* Makes the range hold value +- radius; what is not finite changes nothing. */
static void widen(struct range *range, double value, double radius)
{
    if (!isfinite(value) || !isfinite(radius))
        return;
    range->from = fmin(range->from, value - radius);
    range->to = fmax(range->to, value + radius);
}

/* The box around all rims, m. */
static void measure(const struct grains *grains, struct range box[2])
{
    box[0] = box[1] = (struct range){INFINITY, -INFINITY};
    for (size_t k = 0; k < grains->count; k++) {
        widen(&box[0], grains->x[k], grains->radius[k]);
        widen(&box[1], grains->y[k], grains->radius[k]);
    }
    for (int a = 0; a < 2; a++)
        if (!(box[a].to > box[a].from))
            box[a] = (struct range){0, 1};
}

/* 0, or -1 with an error that names the file. */
static int need_si(const struct loaded *loaded)
{
    return loaded->is_si ? 0 : error_input("%s: is in px: give a file of contacts or forces", loaded->path);
}

int export_lammps(const struct loaded *loaded, FILE *stream)
{
    const struct grains *g = &loaded->packing.grains;
    struct range box[2];
    if (need_si(loaded))
        return -1;
    measure(g, box);
    put_step(loaded, "ATOMS", g->count, box, stream);
    fputs("ITEM: ATOMS id type x y z radius angle flags\n", stream);
    for (size_t k = 0; k < g->count; k++)
        fprintf(stream, "%zu 1 %.17g %.17g 0 %.17g %.17g %" PRIu32 "\n", k, g->x[k], g->y[k], g->radius[k],
                g->angle ? g->angle[k] : 0, g->flags[k]);
    return 0;
}

int export_lammps_local(const struct loaded *loaded, const char *method, FILE *stream)
{
    const struct packing *packing = &loaded->packing;
    struct range box[2];
    size_t count = 0, wall;
    if (need_si(loaded))
        return -1;
    const struct forces *forces;
    if (method_choose(packing, loaded->path, method, &forces))
        return -1;
    for (size_t c = 0; c < packing->contacts.count; c++)
        count += !packing_is_wall(packing, c, &wall);
    measure(&packing->grains, box);
    put_step(loaded, "ENTRIES", count, box, stream);
    fprintf(stream, "ITEM: ENTRIES index batom1 batom2 overlap%s\n", forces ? " fn ft" : "");
    for (size_t c = 0; c < packing->contacts.count; c++) {
        if (packing_is_wall(packing, c, &wall))
            continue;
        fprintf(stream, "%zu %" PRId64 " %" PRId64 " %.17g", c, packing->contacts.i[c], packing->contacts.j[c],
                packing->contacts.overlap[c]);
        if (forces)
            fprintf(stream, " %.17g %.17g", forces->contact.fn[c], forces->contact.ft[c]);
        fputc('\n', stream);
    }
    return 0;
}

/* ---- ParaView ---- */

/* A state file within its series: base name (borrowed) and time, s, or the index where no time is known. */
struct moment {
    const char *name;
    double time;
};

/* For qsort(): by time, then name. */
static int by_time(const void *left, const void *right)
{
    const struct moment *a = left, *b = right;
    if (a->time != b->time)
        return a->time < b->time ? -1 : 1;
    return strcmp(a->name, b->name);
}

/* Bytes of the path up to its last slash, that included; 0: in the working folder. */
static size_t folder_length(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? (size_t)(slash - path) + 1 : 0;
}

/* Only the root attributes are read: a series is long. */
static int read_moment(const char *path, const char *output, struct moment *moment)
{
    struct state_info info;
    size_t length = folder_length(path);
    if (length != folder_length(output) || strncmp(path, output, length))
        return error_input("%s: is not in the folder of %s: put the series beside its files", path, output);
    struct state *state = state_open(path);
    if (!state)
        return -1;
    int result = state_read_info(state, &info);
    state_close(state);
    if (result)
        return -1;
    moment->name = path + length;
    moment->time = isnan(info.time_s) ? (double)info.index : info.time_s;
    state_info_free(&info);
    return 0;
}

/* NULL: out of memory; a list that lacks a file would be believed. */
static char *print_moments(const struct moment *moments, size_t count)
{
    cJSON *object = cJSON_CreateObject(), *files = cJSON_AddArrayToObject(object, "files");
    int whole = files && cJSON_AddStringToObject(object, "file-series-version", "1.0");
    for (size_t k = 0; k < count && whole; k++) {
        cJSON *file = cJSON_CreateObject();
        whole = cJSON_AddItemToArray(files, file) && cJSON_AddStringToObject(file, "name", moments[k].name) &&
                cJSON_AddNumberToObject(file, "time", moments[k].time);
    }
    char *text = whole ? json_print(object) : NULL;
    cJSON_Delete(object);
    return text;
}

int export_hdf_series(char *const paths[], size_t count, const char *output, FILE *stream)
{
    struct moment *moments = calloc(count + 1, sizeof *moments);
    int result = moments ? 0 : error_memory("a series");
    for (size_t k = 0; k < count && result == 0; k++)
        result = read_moment(paths[k], output, &moments[k]);
    if (result == 0) {
        qsort(moments, count, sizeof *moments, by_time);
        char *text = print_moments(moments, count);
        result = text ? 0 : error_memory("a series");
        fputs(text ? text : "", stream);
        free(text);
    }
    free(moments);
    return result;
}
