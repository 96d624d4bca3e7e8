#include "forces/notes.h"

#include <stdio.h>

#include "pipeline/packing/limits.h"
#include "pipeline/speak/error.h"

/* Forces that are void are written, so that they can be looked at, and said so. */
static int judged(const struct cli *cli, const struct verdict_seen *seen, size_t unbalanced, size_t grains)
{
    char others[80] = "";
    cli_summary(cli, "%s: %s", seen->input ? seen->input : cli->output, seen->summary);
    if (seen->verdict != VERDICT_VOID)
        return cli_flagged(cli, unbalanced, grains, "grains are out of balance by more than 1 %");
    if (seen->of_them_void > 1)
        snprintf(others, sizeof others, " (%zu of %zu are void)", seen->of_them_void, seen->states);
    return cli_doubt("%s: %s is void: %s%s: do not use these forces", seen->input, seen->method, seen->reasons, others);
}

int note_forces(const struct cli *cli, const struct force_request *request, const struct force_outcome *outcome)
{
    double ratio = outcome->overlaps_over_loads;
    /* Stresses follow from the loads, whatever the scale: only the overlaps can tell that it is wrong. */
    if (ratio > LIMIT_OVERLAPS_OVER_LOADS || ratio < 1 / LIMIT_OVERLAPS_OVER_LOADS)
        (void)cli_doubt(
            "%s: overlaps times k_n are %.2g times the loads: scale_m_per_px, kn_N_per_m or the loads are wrong, or "
            "overlaps are no more than their errors",
            request->input, ratio);
    return judged(cli, &outcome->verdict, outcome->unbalanced, outcome->grains);
}

int note_series(const struct cli *cli, const struct series_outcome *outcome)
{
    /* Forces can be in equilibrium and yet not what the photos say. */
    if (outcome->misfit > LIMIT_MISFIT || outcome->worst_misfit > LIMIT_MISFIT)
        (void)cli_doubt(
            "the photos do not fit together: misfit %.2g of all, %.2g of %s (below 1 where they do): look for unknown "
            "loads (forces.series.softness: their size over <fn>), a wrong mu, files from another reference photo",
            outcome->misfit, outcome->worst_misfit, outcome->worst);
    return judged(cli, &outcome->verdict, outcome->unbalanced, outcome->grains);
}
