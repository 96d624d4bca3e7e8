/* What error of the contact forces to expect before anyone goes to the lab. */
#ifndef REPORT_BUDGET_H
#define REPORT_BUDGET_H

#include "report/compare/figures.h"

/* What is known of the experiment; NaN: not given, and every figure that needs it is NaN. */
struct budget {
    double scale;    /* m/px */
    double diameter; /* m: mean of the grains */
    double length;   /* m: of the rods */
    double kn;       /* N/m */
    double pressure; /* Pa: mean stress */
    double z, solid; /* coordination number, packing fraction */
    double s_centre; /* px: standard error of a centre in the reference, per axis */
    double s_radius; /* px */
    double s_motion; /* px: standard error of a tracked motion, per axis */
};
/* Errors: what findgrains and tracker reach on good photos; structure: a dense packing. */
#define BUDGET_DEFAULT                                                                                                 \
    {                                                                                                                  \
        .scale = NAN, .diameter = NAN, .length = NAN, .kn = NAN, .pressure = NAN, .z = 3.6, .solid = 0.84,             \
        .s_centre = 0.05, .s_radius = 0.05, .s_motion = 0.005                                                          \
    }

/* <fn> = pi P L d / (z phi): Weber's mean stress of equal discs, P = (1/2V) sum fn d, with N_c = z N_p / 2 contacts in
 * the volume V = N_p L pi d^2 / (4 phi). The overlap is <fn> / kn. From one photo its variance is
 * s^2 = 2 s_centre^2 + 2 s_radius^2; its change since the reference has 2 s_motion^2 (rotations do not matter along the
 * normal). All of them times kn are forces, before equilibrium improves them. */
void budget_figures(const struct budget *budget, struct figures *figures);

#endif
