#include "forces/add_series.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "forces/series/series_options.h"
#include "pipeline/command/cli.h"
#include "pipeline/speak/error.h"
#include "pipeline/files/new_file.h"
#include "pipeline/packing/packing_file.h"

/* One state and where it comes from. */
struct member {
    const char *path;
    size_t place; /* on the command line */
    struct packing packing;
};

static int is_folder(const char *path)
{
    struct stat status;
    return !stat(path, &status) && S_ISDIR(status.st_mode);
}

/* FOLDER/N.forces.hdf for .../N.contacts.hdf; to be freed. */
static char *output_path(const char *folder, const char *input)
{
    static const char *const endings[] = {".contacts.hdf", ".forces.hdf", ".hdf"};
    const char *slash = strrchr(input, '/'), *base = slash ? slash + 1 : input;
    size_t length = strlen(base), room = strlen(folder) + length + 20;
    for (int k = 0; k < 3; k++)
        if (length > strlen(endings[k]) && !strcmp(base + length - strlen(endings[k]), endings[k])) {
            length -= strlen(endings[k]);
            break;
        }
    char *path = malloc(room);
    if (path)
        snprintf(path, room, "%s/%.*s.forces.hdf", folder, (int)length, base);
    else
        error_set(EXIT_FAILED, "out of memory: paths");
    return path;
}

/* Each state has a file of its own to go to. */
static int check_outputs(const struct series_request *request)
{
    int status = 0;
    for (size_t k = 1; k < request->count && !status; k++) {
        char *path = output_path(request->output, request->inputs[k]);
        status = path ? 0 : -1;
        for (size_t m = 0; m < k && !status; m++) {
            char *other = output_path(request->output, request->inputs[m]);
            if (!other)
                status = -1;
            else if (!strcmp(path, other))
                status = error_input("%s: its forces would replace those of %s: rename one", request->inputs[k],
                                     request->inputs[m]);
            free(other);
        }
        free(path);
    }
    return status;
}

/* By the number of the photo; those without one as they stand on the command line. */
static int compare_members(const void *a, const void *b)
{
    const struct member *p = a, *q = b;
    int64_t i = p->packing.info.index, j = q->packing.info.index;
    if (i >= 0 && j >= 0 && i != j)
        return i < j ? -1 : 1;
    return p->place < q->place ? -1 : p->place > q->place;
}

static int read_members(const struct series_request *request, struct member *members)
{
    for (size_t k = 0; k < request->count; k++) {
        members[k].path = request->inputs[k], members[k].place = k;
        if (packing_read(request->inputs[k], &members[k].packing))
            return -1;
    }
    qsort(members, request->count, sizeof *members, compare_members);
    return 0;
}

/* Take the forces into the packing; an old result of the same name gives way. */
static int take_in(struct packing *packing, struct forces *forces)
{
    for (size_t k = 0; k < packing->force_count; k++)
        if (!strcmp(packing->forces[k].method, forces->method)) {
            forces_free(&packing->forces[k]);
            packing->forces[k] = *forces;
            memset(forces, 0, sizeof *forces);
            return 0;
        }
    struct forces *grown = realloc(packing->forces, (packing->force_count + 1) * sizeof *grown);
    if (!grown)
        return error_memory("forces");
    packing->forces = grown;
    packing->forces[packing->force_count++] = *forces;
    memset(forces, 0, sizeof *forces);
    return 0;
}

static int write_member(const struct series_request *request, const struct member *members, size_t k,
                        const char *parameters)
{
    const struct packing *packing = &members[k].packing;
    const char **inputs = calloc(request->count + 1, sizeof *inputs);
    char *path = is_folder(request->output) ? output_path(request->output, members[k].path) : strdup(request->output);
    int status = inputs && path ? 0 : error_memory("paths");
    for (size_t s = 0; s < request->count && !status; s++)
        inputs[s] = members[s].path;
    struct provenance provenance = PROVENANCE_DEFAULT;
    provenance.stage = "forces";
    provenance.parameters = parameters;
    provenance.scene = request->scene;
    provenance.input_paths = inputs;
    provenance.input_count = request->count;
    provenance.index = packing->info.index;
    provenance.time_s = packing->info.time_s;
    provenance.coordinates = "si";
    provenance.length_m = packing->length_m;
    memcpy(provenance.strain, packing->info.strain, sizeof provenance.strain);
    status = status || packing_write(path, packing, &provenance) ? -1 : 0;
    free(inputs), free(path);
    return status;
}

static int write_all(const struct series_request *request, struct member *members, struct forces *forces,
                     const struct series_summary *summary, struct series_outcome *outcome)
{
    char *parameters = series_options_text(&request->options, &request->series_options, summary);
    int status = parameters ? 0 : -1;
    for (size_t k = 0; k < request->count && !status; k++) {
        outcome->unbalanced += forces_unbalanced_grains(&members[k].packing, &forces[k], 0.01);
        outcome->grains += members[k].packing.grains.count;
        if (!outcome->worst || summary->photo[k].misfit > outcome->worst_misfit)
            outcome->worst = members[k].path, outcome->worst_misfit = summary->photo[k].misfit;
        status = take_in(&members[k].packing, &forces[k]) || write_member(request, members, k, parameters) ? -1 : 0;
    }
    free(parameters);
    return status;
}

static void tell(const struct series_summary *summary)
{
    log_event("series", "converged", (double)summary->converged, "residual", summary->gradient, "steps",
              (double)summary->steps, "products", (double)summary->products, "misfit", summary->misfit, "offset_m",
              summary->offset, "s_offset_m", summary->s_offset, "kn_N_per_m", summary->kn, "s_kn_N_per_m",
              summary->s_kn, "segments", (double)summary->segments, NULL);
}

static int infer_members(const struct series_request *request, struct member *members, struct forces *forces,
                         struct series_outcome *outcome)
{
    struct series_summary summary = {0};
    const struct packing **packings = calloc(request->count + 1, sizeof *packings);
    int status = packings ? check_outputs(request) : error_memory("states");
    if (!status)
        status = read_members(request, members);
    for (size_t k = 0; k < request->count && !status; k++)
        packings[k] = &members[k].packing;
    if (!status &&
        infer_series(packings, request->count, &request->options, &request->series_options, forces, &summary))
        status = error_context("%s and the other states", members[0].path);
    if (!status) {
        tell(&summary);
        outcome->misfit = summary.misfit;
        status = write_all(request, members, forces, &summary, outcome);
    }
    if (!status && is_folder(request->output))
        status = series_write_table(request->output, packings, request->count, &summary);
    series_summary_free(&summary);
    free(packings);
    return status;
}

int add_series(const struct series_request *request, struct series_outcome *outcome)
{
    struct member *members = calloc(request->count + 1, sizeof *members);
    struct forces *forces = calloc(request->count + 1, sizeof *forces);
    int status = members && forces ? 0 : error_memory("states");
    memset(outcome, 0, sizeof *outcome);
    if (!status && request->count > 1 && !is_folder(request->output) && mkdir(request->output, 0777))
        status = error_failed("%s: %s: name a folder for the forces", request->output, strerror(errno));
    status = status || infer_members(request, members, forces, outcome) ? -1 : 0;
    for (size_t k = 0; members && forces && k < request->count; k++) {
        packing_free(&members[k].packing);
        forces_free(&forces[k]);
    }
    free(members), free(forces);
    return status;
}
