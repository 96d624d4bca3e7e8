/* Homogenised quantities of a packing. Stresses are compression-positive. */
#ifndef PIPELINE_STRESS_H
#define PIPELINE_STRESS_H

#include "pipeline/packing/packing.h"

/* Weber stress sigma_ab = (1/V) sum_c f_a l_b (thesis eq. 3.5), f the force on j, l the branch from i to j; wall
 * contacts with the branch from the grain's centre to its foot on the wall. V = area * length_m (Pa), or area alone
 * when the length is NaN (N/m). Contacts whose fn or ft is NaN are left out. NaN everywhere when the area is. */
void stress_weber(const struct packing *packing, const double *fn, const double *ft, double area, double sigma[2][2]);
/* Area of the specimen: between the walls when all four are there, else of the convex hull of the rims; m2. NaN where
 * no grain has finite numbers. 0, or -1 when out of memory. */
int packing_area(const struct packing *packing, double *area);
/* Stress that the loads on walls and grains apply: sigma_ab = -(1/V) sum F_a x_b over the walls' middles and the
 * grains' centres, its shear part made symmetric; equal to Weber's stress in equilibrium between upright walls without
 * friction. One wall per axis may lack its load: its reaction follows from the balance of forces. NaN in xx (yy) and
 * in the shear part when two walls along x (y) lack theirs. */
void stress_applied(const struct packing *packing, double area, double sigma[2][2]);

/* Mean stress of the overlaps times kn (candidates left out) over the applied mean stress: 1 where scale, stiffness and
 * loads are right and overlaps are more than their errors. Scales with the square of a wrong scale where loads are
 * stresses, with the scale itself where they are forces. NaN where the loads do not say. */
double stress_overlaps_over_loads(const struct packing *packing, double kn);

#endif
