/* The linear law: F = kn x, kt = kn kt_over_kn, whatever the radii. Its energy is F x / 2. */
#include "pipeline/laws/contact_law.h"

#include <float.h>

static struct contact_pair pair_of(const struct contact_law *law, double reduced_radius)
{
    (void)reduced_radius;
    return (struct contact_pair){.kn = law->kn};
}

static double force(const struct contact_pair *pair, double overlap)
{
    return pair->kn * overlap;
}

static double overlap_of(const struct contact_pair *pair, double force)
{
    return force / pair->kn;
}

static double stiffness(const struct contact_pair *pair, double force)
{
    (void)force;
    return pair->kn;
}

static double work(const struct contact_pair *pair, double overlap, double force)
{
    (void)pair;
    return 0.5 * force * overlap;
}

static const struct law_key KEYS[] = {{"kn_N_per_m", offsetof(struct contact_law, kn), DBL_MIN, 1e15, 0},
                                      {"kt_over_kn", offsetof(struct contact_law, kt_over_kn), 0, 10, 0},
                                      {0}};

const struct law linear_law = {.name = "linear",
                               .says = "springs of one stiffness",
                               .keys = KEYS,
                               .linear = 1,
                               .keeps_ft = 1, /* its stiffness never falls */
                               .pair = pair_of,
                               .force = force,
                               .overlap = overlap_of,
                               .stiffness = stiffness,
                               .work = work};
