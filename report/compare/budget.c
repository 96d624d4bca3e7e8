#include "report/compare/budget.h"

#include <math.h>

/* Share of a normal distribution above `value` standard deviations. */
static double above(double value)
{
    return 0.5 * erfc(value / sqrt(2));
}

void budget_figures(const struct budget *b, struct figures *figures)
{
    double fn = M_PI * b->pressure * b->length * b->diameter / (b->z * b->solid), overlap = fn / b->kn;
    double s_overlap = b->scale * sqrt(2 * b->s_centre * b->s_centre + 2 * b->s_radius * b->s_radius);
    double s_change = b->scale * sqrt(2) * b->s_motion;
    figures_add(figures, "diameter_px", b->diameter / b->scale, "px", "mean diameter");
    figures_add(figures, "kappa", b->kn / (b->pressure * b->length), "1", "stiffness level kappa = kn / (P L)");
    figures_add(figures, "mean_fn_N", fn, "N", "mean normal force, pi P L d / (z phi)");
    figures_add(figures, "mean_overlap_px", overlap / b->scale, "px", "overlap at the mean force");
    figures_add(figures, "s_overlap_px", s_overlap / b->scale, "px", "standard error of an overlap, from one photo");
    figures_add(figures, "overlap_force_error", s_overlap / overlap, "1",
                "force from the overlap alone: error over <fn>");
    figures_add(figures, "mean_contact_missed", above(overlap / s_overlap), "1",
                "chance that a contact of mean force looks like a gap");
    figures_add(figures, "change_force_error", s_change / overlap, "1",
                "force from the motion since the reference: error over <fn>");
    figures_add(figures, "s_change_N", b->kn * s_change, "N", "the same as a force");
    figures_add(figures, "scale_for_10_percent", b->scale * 0.1 / (s_overlap / overlap), "m/px",
                "scale at which the overlap alone gives 10 % of <fn>");
    figures_add(figures, "pressure_for_10_percent_Pa", b->pressure * (s_overlap / overlap) / 0.1, "Pa",
                "mean stress at which it does");
}
