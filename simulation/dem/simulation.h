/* A loading test as data: the packing, its contact law, what the machine does, how exactly it is computed; and what one
 * saved state is like. Lengths are m, stresses in the plane N/m (force over length of an edge), compression positive.
 */
#ifndef SIMULATION_SIMULATION_H
#define SIMULATION_SIMULATION_H

#include <stddef.h>
#include <stdint.h>

#include "pipeline/laws/contact_law.h"
#include "pipeline/numbers/geometry.h"

/* Discs of one diameter. */
struct grade {
    long count;
    double diameter; /* m */
};

/* One disc, placed by hand. */
struct placed_disc {
    double x, y, radius;   /* m */
    double load_x, load_y; /* N */
    int fixed;
    double load_m; /* N m, counter-clockwise */
};

/* So many saved states, each this much further. What `amount` is depends on the test: strain (compression positive, of
 * the size in state 0), stress over the pressure of state 0, or cycles. */
struct loading_steps {
    long count;
    double amount;
};

enum loading_test {
    TEST_ISOTROPIC,          /* stress steps on both walls */
    TEST_BIAXIAL_VERTICAL,   /* strain steps of the top wall, the right wall keeps the pressure */
    TEST_BIAXIAL_HORIZONTAL, /* strain steps of the right wall, the top wall keeps the pressure */
    TEST_SIMPLE_SHEAR,       /* steps of the shear angle's tangent, side walls tilt, the top wall keeps the pressure */
    TEST_OEDOMETER,          /* strain or stress steps of the top wall, the side walls are fixed */
    TEST_CYCLIC,             /* the top wall's stress swings like a sine; steps count cycles */
    TESTS
};

struct simulation {
    uint64_t seed;
    const struct grade *grading;
    size_t grade_count;
    double aspect;                   /* width over height of the empty box */
    const struct placed_disc *discs; /* instead of a grading */
    size_t disc_count;
    double box[2];        /* m: of the box around the discs; NaN: no walls */
    double corner_radius; /* m: of the convex discs on the corners of the box; 0: none */
    double kappa;         /* kn / p; p the stress in the plane, N/m; NaN: see pressure */
    double pressure;      /* N/m; both NaN: the walls are fixed */
    double density;       /* kg/m3 */
    double length;        /* m: of the rods; NaN: 1 for masses, stresses in N/m */
    struct contact_law law;
    struct vec gravity;    /* m/s2 */
    double preparation_mu; /* friction during the compression; NaN: the law's */
    double restitution;    /* normal, of two discs that collide */
    double inertial;       /* inertial number of compression and loading */
    double time_step;      /* over sqrt(m/k) of the lightest disc */
    double tolerance;      /* static: unbalanced component over mean normal force */
    long max_steps;        /* of one relaxation */
    enum loading_test test;
    const struct loading_steps *steps;
    size_t step_count;
    int by_stress;       /* oedometer: steps are stresses */
    double amplitude;    /* cyclic: of the stress, over the pressure */
    int lateral_fixed;   /* cyclic: the side walls are fixed, else they keep the pressure */
    int relax_at_stress; /* 1: states rest at the stress that the step has reached, else at its strain */
};
#define SIMULATION_SEED 1
#define SIMULATION_DENSITY 730.0
#define SIMULATION_LENGTH 0.06
#define SIMULATION_RESTITUTION 0.3
#define SIMULATION_RESTITUTION_MIN 0.14 /* of a critically damped contact: exp(-2) */
#define SIMULATION_INERTIAL 1e-3
#define SIMULATION_TIME_STEP 0.1
#define SIMULATION_TIME_STEP_MAX 0.3
#define SIMULATION_TOLERANCE 1e-7
#define SIMULATION_MAX_STEPS 1000000
#define SIMULATION_STRESS_MIN 1e-3 /* of the pressure: stress steps go no lower, walls only push */
#define SIMULATION_DEFAULT                                                                                             \
    {                                                                                                                  \
        .seed = SIMULATION_SEED, .aspect = 1, .box = {NAN, NAN}, .kappa = NAN, .pressure = NAN,                        \
        .density = SIMULATION_DENSITY, .length = SIMULATION_LENGTH, .preparation_mu = NAN,                             \
        .restitution = SIMULATION_RESTITUTION, .inertial = SIMULATION_INERTIAL, .time_step = SIMULATION_TIME_STEP,     \
        .tolerance = SIMULATION_TOLERANCE, .max_steps = SIMULATION_MAX_STEPS                                           \
    }

/* How one state came about, and what it is like as a whole. */
struct simulation_state {
    int64_t index;
    double strain[3];          /* exx, eyy, gamma since state 0; compression positive */
    double pressure;           /* N/m: of state 0 */
    double stress[2][2];       /* N/m: Weber */
    double applied[2][2];      /* N/m: of the walls */
    double kappa;              /* mean normal stiffness of the contacts over the mean stress */
    double inertial;           /* largest strain rate on the way here, times sqrt(m / p) */
    double solid, z;           /* packing fraction, 2 Nc / Np */
    double indeterminacy;      /* h: unknown forces less equations, rattlers left out */
    double rattlers, sliding;  /* share of the grains; share of the contacts between grains */
    double stored, lost, work; /* J: in the springs; by friction and dashpots; by the walls, since the start */
    double unbalanced;         /* largest component over mean normal force */
    int relaxed;               /* 1: static to the tolerance */
    long steps;                /* relaxation and time steps so far */
};

#endif
