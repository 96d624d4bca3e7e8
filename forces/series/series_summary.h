/* What series is asked for, and what it says about itself: below all of its parts. */
#ifndef FORCES_SERIES_SUMMARY_H
#define FORCES_SERIES_SUMMARY_H

#include <math.h>
#include <stddef.h>

/* Options of the method itself; those of every method (law, mass of walls) are in struct force_options. */
struct series_options {
    double softness;   /* standard error of an equation of equilibrium, in the state's <fn> */
    double shape;      /* m: rms of each grain's unknown rim shape (harmonics 2 to 5); 0: round; NaN: as in the files */
    int fit_offset;    /* 1: a global offset of the radii is unknown */
    int fit_stiffness; /* 1: so is kn */
    int tangential;    /* 1: measured tangential motions between consecutive photos count */
    int samples;       /* draws for s_fn, s_ft, fn_min, fn_max; 0: none */
};
#define SERIES_SOFTNESS 0.002
#define SERIES_OPTIONS_DEFAULT                                                                                         \
    {                                                                                                                  \
        .softness = SERIES_SOFTNESS, .shape = NAN, .fit_offset = 1, .tangential = 1                                    \
    }

/* What one photo brought. */
struct series_photo {
    double mean;           /* N: <fn> */
    size_t contacts, open; /* pairs that took part; those that carry nothing */
    size_t fresh;          /* pairs that carry, but did not in the photo before */
    size_t data;           /* measured lines */
    double misfit;         /* its part of 2 F over its data */
    double information;    /* how many of the shared unknowns it determines (trace of its part of the precision) */
};

/* How it went, and what it found about the constants. */
struct series_summary {
    int converged;              /* the gradient is small */
    double gradient;            /* largest component, in <fn> */
    int steps, products;        /* Newton steps, steps of conjugate gradients */
    double misfit;              /* 2 F over the number of data: about 1 when errors are as stated */
    size_t unknowns, segments;  /* shared ones; tangential segments */
    double offset, s_offset;    /* m: of each radius (measured less true) */
    double kn, s_kn;            /* N/m */
    struct series_photo *photo; /* one per state */
    const char *refused;        /* why the stiffness was not fitted; NULL: it was, or was not asked for */
};

#endif
