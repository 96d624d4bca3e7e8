/* Every start is a set of numbers, whatever it came from. */
#include "forces/methods/start.h"

#include <string.h>

#include "forces/methods/known_forces.h"
#include "forces/network/elastic.h"
#include "pipeline/speak/error.h"

enum force_start start_meant(const struct problem *problem, const struct method *method)
{
    const struct force_options *options = problem->options;
    if (!method->starts)
        return options->previous ? START_PREVIOUS : START_OVERLAP;
    if (options->start != START_DEFAULT)
        return options->start;
    return contact_law_known(&options->law) && problem->packing->contacts.overlap ? START_OVERLAP : START_ZERO;
}

/* An iteration may begin anywhere: a force that is not known begins at 0; but it cannot be held. */
static int fill_unknown(const struct problem *problem, double *f)
{
    const struct network *network = problem->network;
    for (size_t c = 0; c < network->count; c++) {
        if (isfinite(f[2 * c]) && isfinite(f[2 * c + 1]))
            continue;
        if (problem->options->fix != FIX_NONE)
            return error_input("contact %zu has no finite force in the start that could be held: leave --fix out, or "
                               "start from other forces",
                               network->contact[c].row);
        for (size_t part = 2 * c; part < 2 * c + 2; part++)
            f[part] = isfinite(f[part]) ? f[part] : 0;
    }
    return 0;
}

int start_forces(const struct problem *problem, const struct method *method, double *f)
{
    const struct force_options *options = problem->options;
    int status = 0;
    memset(f, 0, 2 * problem->network->count * sizeof *f);
    switch (start_meant(problem, method)) {
    case START_OVERLAP:
        return forces_of_overlaps(problem, f);
    case START_MEAN:
        for (size_t c = 0; c < problem->network->count; c++)
            f[2 * c] = 1;
        return 0;
    case START_CEM:
        status = CEM_METHOD.solve(problem, f, &(struct outcome){0});
        break;
    case START_PREVIOUS:
        status = forces_of_state(problem, options->previous, method->name, f);
        break;
    case START_FILE:
        status = forces_of_state(problem, options->from, method->name, f);
        break;
    case START_DEFAULT:
    case START_ZERO:
        break;
    }
    return status ? status : fill_unknown(problem, f);
}
