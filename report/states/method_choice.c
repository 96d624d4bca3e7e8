#include "report/states/method_choice.h"

#include <math.h>
#include <string.h>

#include "pipeline/speak/error.h"

const struct forces *method_default(const struct packing *packing)
{
    const struct forces *first = NULL;
    for (size_t f = 0; f < packing->force_count; f++)
        if (!first || method_order(packing->forces[f].method, first->method) < 0)
            first = &packing->forces[f];
    return first;
}

int method_choose(const struct packing *packing, const char *path, const char *method, const struct forces **forces)
{
    *forces = method ? packing_forces(packing, method) : method_default(packing);
    if (method && !*forces)
        return error_input("%s: has no forces of method '%s': choose one that it has", path, method);
    return 0;
}

/* ---- several states ---- */

size_t methods_find(const struct methods *methods, const char *method)
{
    size_t k = 0;
    while (k < methods->count && strncmp(methods->list[k].name, method, NAME_LENGTH))
        k++;
    return k;
}

void methods_add(struct methods *methods, const char *method, int converged, double mean_fn)
{
    size_t place = methods_find(methods, method);
    if (place == methods->count) {
        if (methods->count == METHODS_MOST)
            return;
        for (place = 0; place < methods->count && method_order(methods->list[place].name, method) < 0;)
            place++;
        memmove(&methods->list[place + 1], &methods->list[place],
                (methods->count++ - place) * sizeof methods->list[place]);
        memset(&methods->list[place], 0, sizeof methods->list[place]);
        memcpy(methods->list[place].name, method, strnlen(method, NAME_LENGTH));
    }
    methods->list[place].states++;
    methods->list[place].converged += converged != 0;
    if (isfinite(mean_fn)) {
        methods->list[place].sum_fn += mean_fn;
        methods->list[place].loaded++;
    }
}

const char *methods_common(const struct methods *methods)
{
    const char *first = NULL;
    for (size_t k = 0; k < methods->count; k++) {
        const char *name = methods->list[k].name;
        if (methods->list[k].states < methods->states)
            continue;
        if (!strcmp(name, "series") || !strcmp(name, "map") || methods->list[k].converged == methods->states)
            return name; /* the list is in order: series and map come first */
        if (!first)
            first = name;
    }
    return first;
}

double methods_mean_fn(const struct methods *methods, const char *method)
{
    double sum = 0;
    size_t loaded = 0;
    for (size_t k = 0; k < methods->count; k++) {
        if (method && strncmp(methods->list[k].name, method, NAME_LENGTH))
            continue;
        sum += methods->list[k].sum_fn;
        loaded += methods->list[k].loaded;
    }
    return loaded ? sum / (double)loaded : NAN;
}
