#include "forces/forces_in_packing.h"

#include <stdlib.h>
#include <string.h>

#include "forces/forces_file.h"
#include "forces/options.h"
#include "pipeline/speak/error.h"

/* Takes the result over, or frees it. */
static int take(struct packing *packing, struct forces *forces)
{
    int status = forces_take_in(packing, forces);
    forces_free(forces);
    return status;
}

int forces_in_packing(const struct scene *scene, const char *method, const struct packing *previous,
                      struct packing *packing)
{
    struct force_arguments arguments = FORCE_ARGUMENTS_DEFAULT;
    struct forces forces;
    int row = method_find(method, strlen(method));
    if (row < 0)
        return error_input("%s: no such method: give map, qsm, cdm or cem", method);
    if (force_arguments_read(scene, &arguments))
        return -1;
    arguments.options.previous = previous;
    return infer_forces(packing, &arguments.options, (enum force_method)row, &forces) ? -1 : take(packing, &forces);
}

int forces_in_series(const struct scene *scene, struct packing *packings, size_t count)
{
    struct force_arguments arguments = FORCE_ARGUMENTS_DEFAULT;
    struct series_summary summary = {0};
    const struct packing **list = calloc(count + 1, sizeof *list);
    struct forces *forces = calloc(count + 1, sizeof *forces);
    int status = list && forces ? force_arguments_read(scene, &arguments) : error_memory("states");
    for (size_t k = 0; !status && k < count; k++)
        list[k] = &packings[k];
    if (!status)
        status = infer_series(list, count, &arguments.options, &arguments.series, forces, &summary);
    for (size_t k = 0; !status && k < count; k++)
        status = take(&packings[k], &forces[k]);
    for (size_t k = 0; forces && k < count; k++)
        forces_free(&forces[k]);
    series_summary_free(&summary);
    free(forces), free(list);
    return status;
}
