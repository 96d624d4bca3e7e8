/* What a method starts from (thesis 3.2, 3.5.2): nothing, the mean force, the overlaps, the measured motions, or
 * another state's forces. */
#ifndef FORCES_START_H
#define FORCES_START_H

#include "forces/methods/method.h"

/* How the method begins: as asked; where nothing was asked, from the overlaps if they and a stiffness are known, else
 * from zero. A method that begins by itself does so with the previous state where there is one, else with the overlaps.
 */
enum force_start start_meant(const struct problem *problem, const struct method *method);
/* The forces of options->start into f, in working units, all of them numbers. `method`: which of the forces of another
 * state are taken first. */
int start_forces(const struct problem *problem, const struct method *method, double *f);

#endif
