/* A contact loads along its law's virgin curve. Below the largest force so far (the peak) a plastic law comes back
 * along another curve, shifted so that both meet at the peak: with x_b the overlap of that curve,
 * F(x) = F_b(x_b(peak) - (x(peak) - x)). The tangential spring is elastic with kt = k kt_over_kn. */
#include "pipeline/laws/contact_spring.h"

#include <math.h>

struct contact_pair contact_pair_of(const struct contact_law *law, double reduced_radius)
{
    return contact_law_row(law)->pair(law, reduced_radius);
}

double contact_pair_force(const struct contact_law *law, const struct contact_pair *pair, double overlap)
{
    return overlap > 0 ? contact_law_row(law)->force(pair, overlap) : 0;
}

double contact_pair_overlap(const struct contact_law *law, const struct contact_pair *pair, double force)
{
    return force > 0 ? contact_law_row(law)->overlap(pair, force) : 0;
}

double contact_pair_stiffness(const struct contact_law *law, const struct contact_pair *pair, double force)
{
    return contact_law_row(law)->stiffness(pair, force);
}

double contact_pair_work(const struct contact_law *law, const struct contact_pair *pair, double overlap, double force)
{
    return contact_law_row(law)->work(pair, overlap, force);
}

int contact_pair_advance(const struct contact_law *law, const struct contact_pair *pair, double mu, double dun,
                         double dut, double *fn, double *ft)
{
    if (contact_law_row(law)->linear) { /* needs no overlap: exact also from a force that is no overlap's */
        *fn -= pair->kn * dun;
        *ft -= law->kt_over_kn * pair->kn * dut;
        return coulomb_clip(mu, fn, ft);
    }
    double overlap = contact_pair_overlap(law, pair, *fn) - dun;
    double before = contact_pair_stiffness(law, pair, *fn);
    struct contact_spring spring = {.fn = *fn, .ft = *ft, .stiffness = before, .peak = *fn};
    if (!(overlap > 0)) {
        *fn = *ft = 0;
        return STATUS_OPEN;
    }
    contact_spring_press(law, pair, overlap, &spring);
    contact_spring_slide(law, before, dut, &spring);
    *fn = spring.fn, *ft = spring.ft;
    return coulomb_clip(mu, fn, ft);
}

void contact_spring_press(const struct contact_law *law, const struct contact_pair *pair, double overlap,
                          struct contact_spring *spring)
{
    const struct law *row = contact_law_row(law), *back = row->back;
    if (back && spring->peak > 0) {
        double below = contact_pair_overlap(law, pair, spring->peak) - overlap;
        if (below > 0) {
            spring->fn = back->force(pair, back->overlap(pair, spring->peak) - below);
            spring->stiffness = back->stiffness(pair, spring->fn);
            return;
        }
    }
    spring->fn = contact_pair_force(law, pair, overlap);
    spring->stiffness = row->stiffness(pair, spring->fn);
    spring->peak = fmax(spring->peak, spring->fn);
}

void contact_spring_slide(const struct contact_law *law, double before, double dut, struct contact_spring *spring)
{
    /* Unloading lowers the tangential stiffness: at an unchanged force its spring would hold more energy. */
    if (!contact_law_row(law)->keeps_ft && spring->stiffness < before)
        spring->ft *= spring->stiffness / before;
    spring->ft -= law->kt_over_kn * spring->stiffness * dut;
}

double contact_spring_energy(const struct contact_law *law, const struct contact_pair *pair, double overlap,
                             const struct contact_spring *spring)
{
    const struct law *row = contact_law_row(law), *gives = row->back ? row->back : row;
    double kt = law->kt_over_kn * spring->stiffness;
    return gives->work(pair, overlap, spring->fn) + (kt > 0 ? 0.5 * spring->ft * spring->ft / kt : 0);
}
