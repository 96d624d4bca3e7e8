/* Radii that are too small by e part all contacts by gaps near 2 e, while the other neighbours stand anywhere: so half
 * of the grains have their nearest neighbour within about 2 e, and what is nearer than twice that is mostly contacts
 * that were lost. */
#include "contacts/network/near_gaps.h"

#include <math.h>
#include <stdlib.h>

#include "contacts/network/near_pairs.h"
#include "pipeline/numbers/quantiles.h"
#include "pipeline/speak/error.h"

#define FARTHEST 0.25 /* of the median radius: neighbours with wider gaps were not meant to touch */

/* m; FARTHEST of 0 without grains. */
static double farthest(const struct grains *grains, double *room)
{
    size_t n = 0;
    for (size_t k = 0; k < grains->count; k++)
        if (!(grains->flags[k] & GRAIN_NOT_FINITE))
            room[n++] = grains->radius[k];
    return n ? FARTHEST * median_of(room, n) : 0;
}

/* Median over the grains of the gap to the nearest neighbour, `most` where there is none within it. */
static double nearest(const struct grains *grains, const struct pairs *pairs, double most, double *room)
{
    for (size_t k = 0; k < grains->count; k++)
        room[k] = most;
    for (size_t p = 0; p < pairs->count; p++) {
        const struct pair *pair = &pairs->pair[p];
        room[pair->i] = fmin(room[pair->i], -pair->overlap);
        room[pair->j] = fmin(room[pair->j], -pair->overlap);
    }
    return grains->count ? median_of(room, grains->count) : most;
}

int near_gaps_find(const struct grains *grains, struct near_gaps *gaps)
{
    struct pairs pairs = {0};
    double window, *values = malloc((grains->count + 1) * sizeof *values);
    *gaps = (struct near_gaps){.median = NAN};
    if (!values)
        return error_memory("gaps");
    double most = farthest(grains, values), *grown = NULL;
    int status = candidates_between_grains(grains, 0, most, &pairs, &window);
    if (status == 0) {
        gaps->reach = fmin(fmax(2 * nearest(grains, &pairs, most, values), window), most);
        grown = realloc(values, (pairs.count + 1) * sizeof *values);
        status = grown ? 0 : error_memory("gaps");
    }
    for (size_t p = 0; status == 0 && p < pairs.count; p++)
        if (-pairs.pair[p].overlap < gaps->reach)
            grown[gaps->pairs++] = -pairs.pair[p].overlap;
    if (gaps->pairs)
        gaps->median = median_of(grown, gaps->pairs);
    free(grown ? grown : values);
    pairs_free(&pairs);
    return status;
}
