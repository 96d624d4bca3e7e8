/* Contact dynamics: the solution of one contact. */
#ifndef FORCES_CDM_H
#define FORCES_CDM_H

/* Forces that stop the relative velocity (un, ut), under Signorini's and Coulomb's laws, given the inverse mass matrix
 * w = {Wnn, Wnt, Wtt} of the contact (thesis 2.14, 2.24). (fn, ft): what acts now, and the answer, inside the cone of
 * mu. relaxation 1: stopped exactly; more: beyond. */
void cdm_contact(const double w[3], double mu, double un, double ut, double relaxation, double *fn, double *ft);

#endif
