/* A series determines some constants that its files only state: stiffness, offset of the radii. `found` holds them with
 * their standard errors, beside the options, so that a file tells what it was made with and what came out. */
#include "forces/series/series_options.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/files/new_file.h"
#include "pipeline/files/json.h"

/* NaN becomes null: JSON has no NaN. */
static int add(cJSON *object, const char *key, double value)
{
    cJSON *added = isfinite(value) ? cJSON_AddNumberToObject(object, key, value) : cJSON_AddNullToObject(object, key);
    return added ? 0 : -1;
}

static int add_found(cJSON *object, const struct series_summary *summary)
{
    cJSON *found = cJSON_AddObjectToObject(object, "found");
    return !found || add(found, "kn_N_per_m", summary->kn) || add(found, "s_kn_N_per_m", summary->s_kn) ||
                   add(found, "offset_m", summary->offset) || add(found, "s_offset_m", summary->s_offset) ||
                   add(found, "misfit", summary->misfit) || add(found, "residual", summary->gradient) ||
                   add(found, "segments", (double)summary->segments) ||
                   (summary->refused && !cJSON_AddStringToObject(found, "stiffness_refused", summary->refused))
               ? -1
               : 0;
}

char *series_options_text(const struct force_options *options, const struct series_options *series,
                          const struct series_summary *summary)
{
    cJSON *object = cJSON_CreateObject();
    char *text = NULL;
    if (object && cJSON_AddStringToObject(object, "method", "series") && !add(object, "kn_N_per_m", options->law.kn) &&
        !add(object, "kt_over_kn", options->law.kt_over_kn) && !add(object, "mu", options->law.mu) &&
        !add(object, "mu_wall", options->law.mu_wall) && !add(object, "softness", series->softness) &&
        !add(object, "shape_m", series->shape) && !add(object, "offset", series->fit_offset) &&
        !add(object, "stiffness", series->fit_stiffness) && !add(object, "tangential", series->tangential) &&
        !add(object, "samples", series->samples) && !add_found(object, summary))
        text = json_print(object);
    cJSON_Delete(object);
    if (!text)
        error_set(EXIT_FAILED, "out of memory: parameters");
    return text;
}

/* fresh: pairs that carry but did not in the photo before; information: trace of the photo's part of the precision of
 * the shared unknowns. */
static const char HEADER[] = "index,mean_fn_N,contacts,open,fresh,data,misfit,information,residual\n";

static int print_table(const char *path, const struct packing *const *packings, size_t count,
                       const struct series_summary *summary)
{
    FILE *file = fopen(path, "w");
    if (!file)
        return error_failed("%s: cannot be written: look at the folder", path);
    fputs(HEADER, file);
    for (size_t s = 0; s < count; s++) {
        const struct series_photo *photo = &summary->photo[s];
        const struct forces *forces = packing_forces(packings[s], "series");
        fprintf(file, "%" PRId64 ",%.9g,%zu,%zu,%zu,%zu,%.4f,%.1f,%.3e\n", packings[s]->info.index, photo->mean,
                photo->contacts, photo->open, photo->fresh, photo->data, photo->misfit, photo->information,
                forces ? forces->imbalance : NAN);
    }
    int failed = ferror(file);
    return fclose(file) || failed ? error_failed("%s: cannot be written: is the disk full?", path) : 0;
}

/* Whole or not at all: a new file beside the old one, renamed when it is complete. */
int series_write_table(const char *folder, const struct packing *const *packings, size_t count,
                       const struct series_summary *summary)
{
    size_t room = strlen(folder) + 20;
    char *path = malloc(room);
    struct new_file file;
    if (!path)
        return error_memory("paths");
    snprintf(path, room, "%s/series.csv", folder);
    int status = new_file_begin(&file, path);
    if (!status) {
        status = print_table(file.temporary, packings, count, summary);
        if (status)
            new_file_discard(&file);
        else
            status = new_file_commit(&file);
    }
    free(path);
    return status;
}
