/* What forces can be asked for: the options of every method and question in one struct, below all of them. */
#ifndef FORCES_FORCE_OPTIONS_H
#define FORCES_FORCE_OPTIONS_H

#include <math.h>

#include "pipeline/laws/contact_law.h"
#include "pipeline/packing/packing.h"

/* START_DEFAULT: overlap where a stiffness is known, else zero. START_FILE is `previous` from a file of any state. */
enum force_start { START_DEFAULT, START_ZERO, START_MEAN, START_OVERLAP, START_CEM, START_PREVIOUS, START_FILE };

/* Which components keep the start's values: with FIX_NORMAL every fn, with FIX_TANGENTIAL every ft. */
enum force_fix { FIX_NONE, FIX_NORMAL, FIX_TANGENTIAL };

struct force_options {
    struct contact_law law; /* of all contacts; kn may be NaN for methods that do not need it */
    enum force_start start;
    const struct packing *previous; /* with its forces: for START_PREVIOUS and cem; NULL: none */
    const struct packing *from;     /* with its forces: for START_FILE; NULL: none */
    enum force_fix fix;             /* which components of the start are held */
    int rescale;                    /* scale forces from overlaps to the loads' virial: 0 keeps kn as given */
    double tolerance;               /* largest unbalanced component over <fn> */
    int iterations;                 /* limit; 0: the method's own */
    int samples;                    /* map: draws for s_fn, s_ft and the 90 % interval; 0: none, else 2 or more */
    int walk;                       /* jumps of a random walk after the estimate; 0: none (forces/questions/walk.h) */
    const char *range; /* contacts whose fn_low and fn_high are wanted; NULL: none (forces/questions/range.h) */
    int stability;     /* 1: the smallest eigenvalue of K is wanted (forces/questions/buckling.h) */
    /* cdm */
    double relaxation; /* 1: Gauss-Seidel; up to 1.5 */
    double thickness;  /* graph thickness: relative velocity below which a contact is left alone, in <fn> / mean mass */
    double wall_mass;  /* of a free wall, in mean grain masses */
    int block;         /* sweeps between two of Anderson's accelerations; 0: none */
    int colours; /* contacts that share no grain are visited at the same time, by all threads; 0: in their order */
    /* qsm */
    int candidates; /* take in the contacts that are only candidates, as map does; default 0: those that are decided */
    int orthogonal; /* project onto the Coulomb cone orthogonally (associated flow) instead of vertically */
    int anderson;   /* columns of Anderson's acceleration, also of cdm's; 0: none */
};
/* Defaults. */
#define FORCE_TOLERANCE 1e-6
#define FORCE_WALL_MASS 100
#define FORCE_ANDERSON 5
#define FORCE_OPTIONS_DEFAULT                                                                                          \
    {                                                                                                                  \
        .law = {.kn = NAN, .kt_over_kn = 1, .mu = NAN}, .tolerance = FORCE_TOLERANCE, .relaxation = 1,                 \
        .wall_mass = FORCE_WALL_MASS, .anderson = FORCE_ANDERSON                                                       \
    }

#endif
