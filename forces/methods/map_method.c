/* map as a row: what the packing says goes in as evidence, the most likely admissible forces come out. */
#include "forces/methods/map.h"
#include "forces/methods/map_samples.h"

static int evidence_of(const struct problem *problem, const double *f, struct evidence *evidence)
{
    return evidence_build(problem->packing, problem->network, problem->options, f, evidence);
}

static int solve(const struct problem *problem, double *f, struct outcome *outcome)
{
    struct evidence evidence;
    if (evidence_of(problem, f, &evidence))
        return -1;
    int status = map_solve(problem->network, problem->options, &evidence, f, outcome);
    evidence_free(&evidence);
    return status;
}

/* The evidence is built again from the start: the forces have taken its place in f. */
static int sample(const struct problem *problem, const double *f, struct spread *spread)
{
    struct evidence evidence;
    if (evidence_of(problem, f, &evidence))
        return -1;
    int status = map_sample(problem->network, problem->options, &evidence, spread);
    evidence_free(&evidence);
    return status;
}

const struct method MAP_METHOD = {
    .name = "map",
    .says = "the most likely admissible forces; the one to use",
    .needs = NEEDS_STIFFNESS,
    .starts = 1,
    .balances = 1,
    .walks = 1,
    .ranges = 1,
    .candidates = CANDIDATES_ALWAYS,
    .margin = LEAST_FORCE_ERROR, /* its forces are means over what is possible: they lie inside */
    .doubt = 0,                  /* it does not stop near equilibrium */
    .solve = solve,
    .sample = sample};
