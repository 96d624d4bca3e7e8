/* A loading test on a virtual packing (docs/simulate.md): discs are placed by their grading, compressed to a pressure,
 * relaxed to static equilibrium, then strained step by step; every saved state is a packing whose contact forces
 * (method "dem") are in equilibrium.
 *
 *     struct simulation simulation = SIMULATION_DEFAULT;
 *     simulation.grading = (struct grade[]){{52, 8e-3}, {28, 12e-3}};
 *     simulation.grade_count = 2;
 *     simulation.law = (struct contact_law){.kind = LAW_LINEAR, .kn = 1.09e7, .kt_over_kn = 1, .mu = 0.53};
 *     simulation.kappa = 200;
 *     simulate(&simulation, save, user);      // save() is called with each state */
#ifndef SIMULATION_SIMULATE_H
#define SIMULATION_SIMULATE_H

#include <stddef.h>
#include <stdint.h>

#include "pipeline/packing.h"
#include "pipeline/scene.h"

/* Discs of one diameter. */
struct grade {
    long count;
    double diameter; /* m */
};

/* So many saved states, each this much strain (compression positive) further. */
struct strain_steps {
    long count;
    double strain;
};

enum loading_test { TEST_ISOTROPIC, TEST_BIAXIAL_VERTICAL };

struct simulation {
    uint64_t seed;
    const struct grade *grading;
    size_t grade_count;
    double aspect;  /* width over height of the empty box */
    double kappa;   /* kn / p; p the stress in the plane, N/m */
    double density; /* kg/m3 */
    double length;  /* m: of the rods */
    struct contact_law law;
    double preparation_mu; /* friction during the compression; NaN: the law's */
    double restitution;    /* normal, of two discs that collide */
    double inertial;       /* inertial number of compression and loading */
    double tolerance;      /* static: unbalanced component over mean normal force */
    long max_steps;        /* of one relaxation */
    enum loading_test test;
    const struct strain_steps *steps;
    size_t step_count;
};
#define SIMULATION_SEED 1
#define SIMULATION_DENSITY 730.0
#define SIMULATION_LENGTH 0.06
#define SIMULATION_RESTITUTION 0.3
#define SIMULATION_RESTITUTION_MIN 0.14 /* of a critically damped contact: exp(-2) */
#define SIMULATION_INERTIAL 1e-3
#define SIMULATION_TOLERANCE 1e-7
#define SIMULATION_MAX_STEPS 1000000
#define SIMULATION_DEFAULT                                                                                             \
    {                                                                                                                  \
        .seed = SIMULATION_SEED, .aspect = 1, .kappa = NAN, .density = SIMULATION_DENSITY,                             \
        .length = SIMULATION_LENGTH, .preparation_mu = NAN, .restitution = SIMULATION_RESTITUTION,                     \
        .inertial = SIMULATION_INERTIAL, .tolerance = SIMULATION_TOLERANCE, .max_steps = SIMULATION_MAX_STEPS          \
    }

/* How one state came about. */
struct simulation_state {
    int64_t index;
    double strain[3]; /* exx, eyy, gamma since state 0; compression positive */
    double pressure;  /* N/m */
    int relaxed;      /* 1: static to the tolerance */
    long steps;       /* relaxation and time steps so far */
};

/* Called with each state; the packing is borrowed. Not 0: stop with this failure. */
typedef int simulation_save(const struct packing *packing, const struct simulation_state *state, void *user);

/* 0; 1 when a state could not be relaxed (it was saved, relaxed = 0); -1 on failure. */
int simulate(const struct simulation *simulation, simulation_save *save, void *user);

#endif
