#include "report/states/state_series.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/files/json.h"
#include "report/states/indeterminacy.h"

void series_free(struct series *series)
{
    for (size_t k = 0; k < series->count; k++) {
        free(series->rows[k].name);
        free(series->rows[k].grains.path);
        free(series->rows[k].tracks.path);
        free(series->rows[k].packing.path);
        free(series->rows[k].contacts_path);
    }
    for (size_t k = 0; k < series->input_count; k++) {
        free(series->inputs[k].file);
        free(series->inputs[k].name);
        free(series->inputs[k].sha256);
    }
    free(series->rows);
    free(series->inputs);
    memset(series, 0, sizeof *series);
}

/* ---- one photo ---- */

static size_t count_flags(const uint32_t *flags, size_t count, size_t of_bit[32])
{
    size_t distrusted = 0;
    for (size_t k = 0; k < count; k++) {
        distrusted += (flags[k] & GRAIN_DISTRUST) != 0;
        for (int bit = 0; bit < 32; bit++)
            of_bit[bit] += flags[k] >> bit & 1;
    }
    return distrusted;
}

static int summarise_photo(const struct loaded *loaded, struct photo_summary *photo)
{
    const struct photo_grains *grains = &loaded->grains;
    free(photo->path);
    memset(photo, 0, sizeof *photo);
    photo->path = strdup(loaded->path);
    photo->grains = grains->count;
    photo->distrusted = count_flags(grains->flags, grains->count, photo->flags);
    if (!photo->path)
        return error_memory("a path");
    return quantiles_of(grains->zncc, grains->flags, GRAIN_DISTRUST, grains->count, &photo->zncc) ||
                   quantiles_of(grains->s_x, grains->flags, GRAIN_DISTRUST, grains->count, &photo->s_place) ||
                   quantiles_of(grains->s_angle, grains->flags, GRAIN_DISTRUST, grains->count, &photo->s_angle) ||
                   quantiles_of(grains->s_radius, grains->flags, GRAIN_DISTRUST, grains->count, &photo->s_size)
               ? -1
               : 0;
}

/* ---- one state ---- */

static struct force_summary summarise_forces(const struct packing *packing, const struct forces *forces, double area)
{
    struct force_summary summary = {
        .iterations = forces->iterations, .converged = forces->converged, .infeasible = forces->infeasible};
    const struct contact_forces *contact = &forces->contact;
    size_t loaded, slipping = 0;
    memcpy(summary.method, forces->method, NAME_LENGTH);
    memcpy(summary.start, forces->start, NAME_LENGTH);
    summary.imbalance = forces->imbalance;
    summary.verdict = forces->verdict;
    memcpy(summary.reasons, forces->reasons, sizeof summary.reasons);
    summary.data_misfit = forces->data_misfit;
    summary.overlaps_over_loads = stress_overlaps_over_loads(packing, forces->kn);
    for (size_t c = 0; c < contact->count; c++)
        if (contact->fn[c] > 0)
            slipping += contact->status && contact->ft[c] != 0 && contact->status[c] == STATUS_SLIP;
    summary.mean_fn = forces_mean(contact->fn, contact->count, 1, &loaded);
    summary.slipping = (double)slipping / (double)loaded;
    stress_weber(packing, contact->fn, contact->ft, area, summary.weber);
    return summary;
}

static int summarise_packing(const struct loaded *loaded, struct packing_summary *summary)
{
    const struct packing *packing = &loaded->packing;
    double area;
    if (packing_area(packing, &area))
        return -1;
    free(summary->path);
    memset(summary, 0, sizeof *summary);
    summary->path = strdup(loaded->path);
    summary->grains = packing->grains.count;
    summary->distrusted = count_flags(packing->grains.flags, packing->grains.count, summary->flags);
    for (size_t k = 0; k < packing->grains.count; k++)
        summary->floating += (packing->grains.flags[k] & GRAIN_FLOATING) != 0;
    for (size_t c = 0; c < packing->contacts.count; c++)
        summary->candidates += (packing->contacts.flags[c] & CONTACT_CANDIDATE) != 0;
    packing_fabric(packing, area, &summary->fabric);
    if (indeterminacy(packing, method_default(packing), &summary->h))
        return -1;
    stress_applied(packing, area, summary->applied);
    memcpy(summary->strain, packing->info.strain, sizeof summary->strain);
    summary->in_pascal = !isnan(packing->length_m);
    for (size_t f = 0; f < packing->force_count && f < SERIES_METHODS; f++)
        summary->forces[summary->force_count++] = summarise_forces(packing, &packing->forces[f], area);
    return summary->path ? 0 : error_memory("a path");
}

/* ---- provenance ---- */

static void note_version(struct series *series, const char *stage, const char *version)
{
    char entry[2 * NAME_LENGTH + 2];
    snprintf(entry, sizeof entry, "%.*s %.*s", NAME_LENGTH, stage, NAME_LENGTH, version);
    size_t used = strlen(series->versions);
    if (!strstr(series->versions, entry) && used + strlen(entry) + 3 < sizeof series->versions)
        snprintf(series->versions + used, sizeof series->versions - used, "%s%s", used ? ", " : "", entry);
}

static int add_input(struct series *series, const char *file, const char *name, const char *sha256)
{
    struct series_input *inputs = realloc(series->inputs, (series->input_count + 1) * sizeof *inputs);
    if (!inputs)
        return error_memory("the list of inputs");
    series->inputs = inputs;
    struct series_input *input = &inputs[series->input_count++];
    input->file = strdup(file);
    input->name = strdup(name);
    input->sha256 = strdup(sha256);
    return input->file && input->name && input->sha256 ? 0 : error_memory("the list of inputs");
}

static int note_inputs(struct series *series, const struct loaded *loaded)
{
    const struct state_info *info = loaded_info(loaded);
    note_version(series, info->stage, info->program_version);
    if (!info->inputs)
        return 0;
    struct json *json = json_parse(info->inputs, strlen(info->inputs), loaded->path);
    if (!json)
        return -1;
    const cJSON *input;
    int result = 0;
    cJSON_ArrayForEach(input, json_root(json))
    {
        const char *name = NULL, *sha256 = NULL;
        if (json_string(json, input, "name", &name) != 1 || json_string(json, input, "sha256", &sha256) != 1)
            result = error_input("%s: its list of inputs is not readable: make the file again", loaded->path);
        else
            result = add_input(series, basename(loaded->path), name, sha256);
        if (result)
            break;
    }
    json_free(json);
    return result;
}

/* ---- rows ---- */

/* The row of that name, made when there is none. */
static struct series_row *row_of(struct series *series, const char *path, const struct state_info *info)
{
    const char *base = basename(path);
    size_t length = strcspn(base, ".");
    for (size_t k = 0; k < series->count; k++)
        if (strlen(series->rows[k].name) == length && !strncmp(series->rows[k].name, base, length))
            return &series->rows[k];
    struct series_row *rows = realloc(series->rows, (series->count + 1) * sizeof *rows);
    char *name = strndup(base, length);
    if (rows)
        series->rows = rows;
    if (!rows || !name) {
        free(name);
        (void)error_memory("the rows of a series");
        return NULL;
    }
    struct series_row *row = &rows[series->count++];
    memset(row, 0, sizeof *row);
    row->name = name;
    row->index = info->index;
    row->time_s = info->time_s;
    return row;
}

static int add_file(struct series *series, const char *path)
{
    struct loaded loaded;
    if (loaded_read(path, &loaded))
        return -1;
    const struct state_info *info = loaded_info(&loaded);
    struct series_row *row = row_of(series, path, info);
    int result = row ? note_inputs(series, &loaded) : -1;
    if (row && *info->taken)
        memcpy(row->taken, info->taken, sizeof row->taken);
    if (result == 0 && !loaded.is_si)
        result = summarise_photo(&loaded, strcmp(info->stage, "tracker") ? &row->grains : &row->tracks);
    else if (result == 0 && (loaded.packing.force_count || !row->packing.path))
        result = summarise_packing(&loaded, &row->packing);
    if (result == 0 && loaded.is_si && !loaded.packing.force_count && !row->contacts_path)
        result = (row->contacts_path = strdup(path)) ? 0 : error_memory("a path");
    loaded_free(&loaded);
    return result;
}

static int by_index(const void *left, const void *right)
{
    const struct series_row *a = left, *b = right;
    if (a->index != b->index)
        return a->index < b->index ? -1 : 1;
    return strcmp(a->name, b->name);
}

static void gather_methods(struct series *series)
{
    for (size_t k = 0; k < series->count; k++) {
        const struct packing_summary *packing = &series->rows[k].packing;
        series->methods.states += packing->force_count > 0;
        for (size_t f = 0; f < packing->force_count; f++)
            methods_add(&series->methods, packing->forces[f].method, packing->forces[f].converged,
                        packing->forces[f].mean_fn);
    }
    series->method = methods_common(&series->methods);
}

size_t series_style(const struct series *series, const char *method)
{
    return methods_find(&series->methods, method) + 1;
}

int series_read(char *const paths[], size_t count, struct series *series)
{
    memset(series, 0, sizeof *series);
    for (size_t k = 0; k < count; k++)
        if (add_file(series, paths[k])) {
            series_free(series);
            return -1;
        }
    qsort(series->rows, series->count, sizeof *series->rows, by_index);
    gather_methods(series);
    return 0;
}
