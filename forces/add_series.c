/* All states are read before the first is worked on, sorted by the number of their photo, solved together and written
 * one by one; each file names all of them as its inputs. */
#include "forces/add_series.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "forces/forces_file.h"
#include "forces/infer_forces.h"
#include "forces/series/series_options.h"
#include "pipeline/command/cli.h"
#include "pipeline/speak/error.h"
#include "pipeline/files/new_file.h"
#include "pipeline/packing/packing_file.h"

/* One state and where it comes from. */
struct member {
    const char *path;
    char *target; /* where its forces go */
    size_t place; /* on the command line */
    struct packing packing;
};

static int is_folder(const char *path)
{
    struct stat status;
    return !stat(path, &status) && S_ISDIR(status.st_mode);
}

/* FOLDER/N.forces.hdf for .../N.contacts.hdf; to be freed. NULL: memory is gone. */
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
    return path;
}

/* Each state has a file of its own to go to. */
static int name_targets(const struct series_request *request, struct member *members)
{
    for (size_t k = 0; k < request->count; k++) {
        members[k] = (struct member){.path = request->inputs[k], .place = k};
        members[k].target =
            is_folder(request->output) ? output_path(request->output, request->inputs[k]) : strdup(request->output);
        if (!members[k].target)
            return error_memory("paths");
        for (size_t m = 0; m < k; m++)
            if (!strcmp(members[k].target, members[m].target))
                return error_input("%s: its forces would replace those of %s: rename one", request->inputs[k],
                                   request->inputs[m]);
    }
    return 0;
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
        if (packing_read(request->inputs[k], &members[k].packing) ||
            check_fresh(request->inputs[k], &members[k].packing, request->scene))
            return -1;
    }
    qsort(members, request->count, sizeof *members, compare_members);
    return 0;
}

/* Into the folder, or, a single state, into the file that was named. */
static int write_member(const struct series_request *request, const struct member *members, size_t k,
                        const char *parameters)
{
    const char **inputs = calloc(request->count + 1, sizeof *inputs);
    int status = inputs ? 0 : error_memory("paths");
    for (size_t s = 0; s < request->count && !status; s++)
        inputs[s] = members[s].path;
    if (!status)
        status =
            forces_write(members[k].target, &members[k].packing, request->scene, parameters, inputs, request->count);
    free(inputs);
    return status;
}

/* Files, and what the caller reports: grains out of balance, the photo that fits worst. */
static int write_all(const struct series_request *request, struct member *members, struct forces *forces,
                     const struct series_summary *summary, struct series_outcome *outcome)
{
    char *parameters = series_options_text(&request->options, &request->series_options, summary);
    int status = parameters ? 0 : -1;
    for (size_t k = 0; k < request->count && !status; k++) {
        outcome->unbalanced += forces_unbalanced_grains(&members[k].packing, &forces[k], 0.01);
        outcome->grains += members[k].packing.grains.count;
        verdict_note(&outcome->verdict, members[k].path, &members[k].packing, &forces[k]);
        if (!outcome->worst || summary->photo[k].misfit > outcome->worst_misfit)
            outcome->worst = members[k].path, outcome->worst_misfit = summary->photo[k].misfit;
        status =
            forces_take_in(&members[k].packing, &forces[k]) || write_member(request, members, k, parameters) ? -1 : 0;
    }
    free(parameters);
    return status;
}

/* For the log. */
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
    int status = packings ? name_targets(request, members) : error_memory("states");
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
        free(members[k].target);
        forces_free(&forces[k]);
    }
    free(members), free(forces);
    return status;
}
