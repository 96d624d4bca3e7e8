/* Small-strain probes of a packing of spheres by LAMMPS (Debian: lammps), behind hertz_search(): periodic box, Hertz
 * and Mindlin contacts, isotropic consolidation, then a shortening of one axis at fixed sides. With the stress changes
 * s_z and s_x of an isotropic solid: nu / (1 - nu) = s_x / s_z, E = s_z / eps (1 + nu)(1 - 2 nu) / (1 - nu). */
#ifndef CALIBRATION_LAMMPS_PROBES_H
#define CALIBRATION_LAMMPS_PROBES_H

#include "calibration/hertz/hertz_search.h"
#include "calibration/hertz/probe_record.h"
#include "simulation/dem/simulate.h"

struct lammps_probes {
    const struct simulation *simulation; /* grading, density, pressure (Pa), friction of the compression, seed */
    double strain, mu;                   /* of the probe; friction while it is probed */
    double young;                        /* Pa: of the grains in the consolidated packing */
    double porosity, z, volume_per_contact, d50;
    char folder[128]; /* temporary: scripts and the packing */
    struct probe_record record;
};
#define LAMMPS_PROBE_STRAIN 1e-5

/* Is the program there? */
int lammps_is_installed(void);
/* Consolidate, and give the closed-form start of the goal (3D) as hertz_probes_open() does. */
int lammps_probes_open(const struct simulation *simulation, double strain, double mu, const char *record_path,
                       struct hertz_goal *goal, struct lammps_probes *probes);
void lammps_probes_close(struct lammps_probes *probes);
int lammps_probes_evaluate(struct hertz_trial *trials, size_t count, void *probes);

#endif
