/* Static hypothesis: contacts lie in all directions alike, and the mean stress sends through each the force that its
 * direction asks for; their displacements by the tangent stiffnesses kn, ks add up to the strain. This gives the moduli
 * of the header. Hertz's kn at the mean force and Mindlin's ks / kn make them functions of E*, nu*, inverted here.
 * Since kn ~ E*^2/3 fn^1/3, E goes with E*^2/3 at a fixed pressure. */
#include "calibration/hertz/hertz.h"

#include <math.h>

#include "pipeline/speak/error.h"

double hertz_volume_per_contact(int dimensions, double radius, double porosity, double coordination)
{
    double solid = (1 - porosity) * coordination;
    return dimensions == HERTZ_2D ? 2 * M_PI * radius * radius / solid : 8 * M_PI * pow(radius, 3) / (3 * solid);
}

double hertz_mean_force(const struct hertz_packing *packing)
{
    double factor = packing->dimensions == HERTZ_2D ? 1 : 1.5;
    return factor * packing->volume_per_contact * packing->confinement / packing->radius;
}

/* E = prefactor * kn ks / (a kn + 3 ks), nu = (kn - ks) / (a kn + 3 ks). */
static void coefficients(const struct hertz_packing *packing, double *prefactor, double *a)
{
    double r2 = packing->radius * packing->radius;
    *prefactor = (packing->dimensions == HERTZ_2D ? 8.0 : 20.0 / 3.0) * r2 / packing->volume_per_contact;
    *a = packing->dimensions == HERTZ_2D ? 1 : 2;
}

void hertz_moduli(const struct hertz_packing *packing, double kn, double ks, double *young, double *poisson)
{
    double prefactor, a;
    coefficients(packing, &prefactor, &a);
    *young = prefactor * kn * ks / (a * kn + 3 * ks);
    *poisson = (kn - ks) / (a * kn + 3 * ks);
}

void hertz_stiffness(double radius, double shear, double poisson, double fn, double *kn, double *ks)
{
    double g = shear / (1 - poisson);
    *kn = cbrt(3 * radius * g * g * fn);
    *ks = 2 * (1 - poisson) / (2 - poisson) * *kn;
}

double hertz_poisson(int dimensions, double grain_poisson)
{
    return dimensions == HERTZ_2D ? grain_poisson / (8 - 7 * grain_poisson) : grain_poisson / (10 - 8 * grain_poisson);
}

double hertz_grain_poisson(int dimensions, double poisson)
{
    return dimensions == HERTZ_2D ? 8 * poisson / (1 + 7 * poisson) : 10 * poisson / (1 + 8 * poisson);
}

int hertz_start(const struct hertz_packing *packing, double young, double poisson, double *grain_young,
                double *grain_poisson)
{
    double nu = hertz_grain_poisson(packing->dimensions, poisson), prefactor, a;
    double fn = hertz_mean_force(packing);
    if (!(young > 0) || !(fn > 0))
        return error_input("young's modulus and confinement must be positive");
    if (!(nu >= 0 && nu <= 0.5))
        return error_input("Poisson's ratio %g of the packing would need grains with %g: outside 0 to 0.5", poisson,
                           nu);
    coefficients(packing, &prefactor, &a);
    double ratio = 2 * (1 - nu) / (2 - nu); /* ks / kn */
    double kn = young * (a + 3 * ratio) / (prefactor * ratio);
    double shear = (1 - nu) * sqrt(kn * kn * kn / (3 * packing->radius * fn));
    *grain_young = 2 * (1 + nu) * shear;
    *grain_poisson = nu;
    return 0;
}
