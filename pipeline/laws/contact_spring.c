#include "pipeline/laws/contact_spring.h"

#include <math.h>

static int is_rough(const struct contact_law *law)
{
    return law->kind == LAW_POHRT_POPOV || law->kind == LAW_POHRT_POPOV_PLASTIC;
}

struct contact_pair contact_pair_of(const struct contact_law *law, double reduced_radius)
{
    if (law->kind == LAW_LINEAR)
        return (struct contact_pair){.kn = law->kn};
    double radius = reduced_radius, modulus = 0.5 * law->young / (1 - law->poisson * law->poisson);
    struct contact_pair pair = {.hertz = 4.0 / 3.0 * modulus * sqrt(radius),
                                .cube = cbrt(6 * modulus * modulus * radius)};
    if (!is_rough(law))
        return pair;
    double a = 0.2567 * law->fractal, h = law->roughness;
    pair.exponent = a;
    pair.area = 0.75 * pow(M_PI, 1.5) * radius * h * pow(20 / (pow(M_PI, 1.5) * law->fractal), 1 / a);
    pair.threshold = 4 * modulus / (3 * radius) * pow(pair.area / M_PI, 1.5);
    pair.factor = M_PI / 10 * law->fractal * modulus * sqrt(pair.area) * pow(h * modulus * sqrt(pair.area), -a);
    pair.threshold_overlap = pow(pair.threshold, 1 - a) / ((1 - a) * pair.factor);
    return pair;
}

/* Hertz's stiffness k = cube F^1/3 integrated: x = 3/2 F^2/3 / cube. */
static double hertz_reach(const struct contact_pair *pair, double force)
{
    double root = cbrt(force);
    return 1.5 * root * root / pair->cube;
}

static double hertz_force(const struct contact_pair *pair, double reach)
{
    double square = pair->cube * reach / 1.5; /* F^2/3 */
    return square > 0 ? square * sqrt(square) : 0;
}

double contact_pair_force(const struct contact_law *law, const struct contact_pair *pair, double overlap)
{
    if (!(overlap > 0))
        return 0;
    if (law->kind == LAW_LINEAR)
        return pair->kn * overlap;
    if (!is_rough(law))
        return pair->hertz * overlap * sqrt(overlap);
    if (overlap < pair->threshold_overlap)
        return pow((1 - pair->exponent) * pair->factor * overlap, 1 / (1 - pair->exponent));
    return hertz_force(pair, overlap - pair->threshold_overlap + hertz_reach(pair, pair->threshold));
}

double contact_pair_overlap(const struct contact_law *law, const struct contact_pair *pair, double force)
{
    if (!(force > 0))
        return 0;
    if (law->kind == LAW_LINEAR)
        return force / pair->kn;
    if (!is_rough(law))
        return hertz_reach(pair, force);
    if (force < pair->threshold)
        return pow(force, 1 - pair->exponent) / ((1 - pair->exponent) * pair->factor);
    return pair->threshold_overlap + hertz_reach(pair, force) - hertz_reach(pair, pair->threshold);
}

double contact_pair_stiffness(const struct contact_law *law, const struct contact_pair *pair, double force)
{
    if (law->kind == LAW_LINEAR)
        return pair->kn;
    if (is_rough(law) && force < pair->threshold)
        return pair->factor * pow(force, pair->exponent);
    return pair->cube * cbrt(force);
}

void contact_spring_press(const struct contact_law *law, const struct contact_pair *pair, double overlap,
                          struct contact_spring *spring)
{
    if (law->kind == LAW_LINEAR) {
        spring->fn = pair->kn * overlap;
        spring->stiffness = pair->kn;
        spring->peak = fmax(spring->peak, spring->fn);
        return;
    }
    if (law->kind == LAW_POHRT_POPOV_PLASTIC && spring->peak > 0) {
        double below = contact_pair_overlap(law, pair, spring->peak) - overlap;
        if (below > 0) {
            spring->fn = hertz_force(pair, hertz_reach(pair, spring->peak) - below);
            spring->stiffness = pair->cube * cbrt(spring->fn);
            return;
        }
    }
    spring->fn = contact_pair_force(law, pair, overlap);
    spring->stiffness = contact_pair_stiffness(law, pair, spring->fn);
    spring->peak = fmax(spring->peak, spring->fn);
}

void contact_spring_slide(const struct contact_law *law, double before, double dut, struct contact_spring *spring)
{
    /* Unloading lowers the tangential stiffness: at an unchanged force its spring would hold more energy. */
    if (law->kind != LAW_LINEAR && law->kind != LAW_HERTZ_PFC && spring->stiffness < before)
        spring->ft *= spring->stiffness / before;
    spring->ft -= law->kt_over_kn * spring->stiffness * dut;
}

/* Work of the normal spring from force 0: closed forms of the integral of F dx. */
static double normal_energy(const struct contact_law *law, const struct contact_pair *pair, double overlap,
                            const struct contact_spring *spring)
{
    double f = spring->fn;
    if (law->kind == LAW_LINEAR)
        return 0.5 * f * overlap;
    if (law->kind != LAW_POHRT_POPOV)
        return 0.4 * f * hertz_reach(pair, f); /* what unloading along Hertz's curve gives back */
    double a = pair->exponent;
    if (f < pair->threshold)
        return f * overlap * (1 - a) / (2 - a);
    double at_threshold = pair->threshold * pair->threshold_overlap * (1 - a) / (2 - a);
    return at_threshold + 0.4 * (f * hertz_reach(pair, f) - pair->threshold * hertz_reach(pair, pair->threshold));
}

double contact_spring_energy(const struct contact_law *law, const struct contact_pair *pair, double overlap,
                             const struct contact_spring *spring)
{
    double kt = law->kt_over_kn * spring->stiffness;
    return normal_energy(law, pair, overlap, spring) + (kt > 0 ? 0.5 * spring->ft * spring->ft / kt : 0);
}
