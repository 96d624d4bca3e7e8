/* Forces of several methods stand side by side in one packing, by their names. */
#include "forces/forces_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/packing/loads.h"
#include "pipeline/packing/packing_file.h"
#include "pipeline/speak/error.h"
#include "pipeline/state/freshness.h"

/* "map: balanced, up to 2e-07 <fn> left, stress 726/1144 kPa": of the first few. */
static void add_words(struct verdict_seen *seen, const struct packing *packing, const struct forces *forces)
{
    size_t used = strlen(seen->summary), room = sizeof seen->summary;
    double unit = isnan(packing->length_m) ? 1 : 1000;
    if (used + 90 < room)
        snprintf(seen->summary + used, room - used, "%s%s: %s, up to %.2g <fn> left, stress %.4g/%.4g %s",
                 used ? "; " : "", forces->method, VERDICT_NAMES[forces->verdict], forces->imbalance,
                 forces->stress[0][0] / unit, forces->stress[1][1] / unit, unit > 1 ? "kPa" : "N/m");
}

void verdict_note(struct verdict_seen *seen, const char *input, const struct packing *packing,
                  const struct forces *forces)
{
    add_words(seen, packing, forces);
    seen->states++;
    seen->of_them_void += forces->verdict == VERDICT_VOID;
    if (forces->verdict <= seen->verdict)
        return;
    seen->verdict = forces->verdict;
    seen->input = input;
    snprintf(seen->method, sizeof seen->method, "%s", forces->method);
    snprintf(seen->reasons, sizeof seen->reasons, "%s", forces->reasons);
}

int check_fresh(const char *path, const struct packing *packing, const struct scene *scene)
{
    const struct state_info *info = &packing->info;
    if (freshness_check(path, info, scene))
        return -1;
    if (strcmp(info->stage, "contacts") || !scene->loads || !packing->walls.count)
        return 0;
    return loads_check_same(scene->loads, info->index, packing->length_m, &packing->walls, path);
}

int forces_take_in(struct packing *packing, struct forces *forces)
{
    size_t k = 0;
    while (k < packing->force_count && strcmp(packing->forces[k].method, forces->method))
        k++;
    if (k == packing->force_count) {
        struct forces *grown = realloc(packing->forces, (k + 1) * sizeof *grown);
        if (!grown)
            return error_memory("forces");
        packing->forces = grown;
        packing->force_count++;
    } else {
        forces_free(&packing->forces[k]);
    }
    packing->forces[k] = *forces;
    memset(forces, 0, sizeof *forces);
    return 0;
}

int forces_write(const char *path, const struct packing *packing, const struct scene *scene, const char *parameters,
                 const char *const *inputs, size_t count)
{
    struct provenance provenance = PROVENANCE_DEFAULT;
    provenance.stage = "forces";
    provenance.parameters = parameters;
    provenance.scene = scene;
    provenance.input_paths = inputs;
    provenance.input_count = count;
    provenance.index = packing->info.index;
    provenance.time_s = packing->info.time_s;
    provenance.coordinates = "si";
    provenance.length_m = packing->length_m;
    memcpy(provenance.strain, packing->info.strain, sizeof provenance.strain);
    return packing_write(path, packing, &provenance);
}
