/* Inside of series: the states, what was measured in them, and the unknown constants q that they share.
 *
 * q holds standardised errors, each N(0, 1), that are the same in every photo: place and radius of each grain, each
 * wall, an offset of all radii, the stiffness, rim shapes, and one constant per tangential segment. In state s
 *
 *     fn + (B q)_n + r_n = m_n     m_n = kn overlap                  r of variance `slack`: this photo's own errors
 *     ft + (B q)_t + r_t = m_t     m_t = -kt (motion in the segment)
 *
 * per contact, lines without a measurement left out, and A f + b = 0 up to an error of variance `softness`. */
#ifndef FORCES_SERIES_STATE_H
#define FORCES_SERIES_STATE_H

#include "forces/algebra/sparse.h"
#include "forces/network/force_options.h"
#include "forces/network/network.h"
#include "forces/series/series_summary.h"

enum { NORMAL, TANGENTIAL };

/* The places of the shared unknowns in q; -1: there is none of this kind. */
struct series_shared {
    long grain;     /* 3 per grain: x, y, radius */
    long wall;      /* 1 per wall */
    long offset;    /* of all radii */
    long stiffness; /* relative */
    long shape;     /* 2 SERIES_HARMONICS per grain: cos and sin of harmonics 2, 3, ... */
    long segment;   /* 1 per tangential segment */
    size_t segments, count, allocated;
};
enum { SERIES_HARMONICS = 4, SERIES_WIDTH = 8 + 4 * SERIES_HARMONICS };

struct series_state {
    const struct packing *packing;
    uint32_t *flags; /* of its contacts: those left out are flagged */
    struct network network;
    struct sparse *matrix;    /* pattern of A A' */
    double mean;              /* <fn> that the loads ask for, in units */
    double softness;          /* variance of an equation of equilibrium, as asked for */
    double *soft;             /* of each: more where a contact seems to be missing */
    unsigned char *changed;   /* since the last solution */
    unsigned char *open;      /* carries nothing, and its gap costs nothing */
    double *store;            /* all arrays of doubles below */
    double (*measured)[2];    /* m; NaN: none */
    double (*variance)[2];    /* of r, as this photo was measured */
    double (*slack)[2];       /* of r in this stage */
    int *place, width;        /* B of the normal lines: `width` entries per contact, ended by -1 */
    double *share;            /* their values */
    long *segment;            /* per contact; -1: none */
    double *y, (*l)[2];       /* multipliers of equilibrium and of the measurements */
    double *dy, (*dl)[2];     /* their steps */
    double *gy, (*gl)[2];     /* gradient of the dual */
    double (*relative)[2];    /* A' y */
    double (*error)[2];       /* B q */
    double (*drelative)[2];   /* A' dy */
    double (*derror)[2];      /* B dq */
    double (*f)[2], (*df)[2]; /* forces; of an open contact -gap, 0 */
    double (*side)[2];        /* how far from the edges of the cone, > 0: mu fn -+ ft; fn alone without friction */
    double (*press)[2];       /* multipliers of the sides, > 0 */
    double (*dpress)[2];      /* their steps */
    double (*pull)[2];        /* what the edges add to the right-hand side: df = C (A' dy + dl + pull) */
    double (*curve)[3];       /* C = (1 / V + G' (press / side) G)^-1: nn, nt, tt */
    double (*gain)[3];        /* D = (C + slack)^-1 on the measured lines */
    double (*take)[2][2];     /* G = C D */
    double *work, *solution;  /* per degree of freedom */
    const double (*gathered)[2];
    double *sum; /* per shared unknown but segments: B' gathered */
};

struct series {
    struct series_state *state;
    size_t count;
    struct series_shared shared;
    const struct force_options *options;
    const struct series_options *series_options;
    int large;           /* enough work for several threads */
    double force;        /* N: the unit, common to all states */
    double stiffness;    /* kn in units per m */
    double s_stiffness;  /* its relative standard error beforehand */
    double *store;       /* all arrays of shared unknowns below */
    double *q, *dq;      /* the shared unknowns and their step */
    double *defect;      /* sum of B' l, less q: 0 at the optimum */
    double *vector[5];   /* of conjugate gradients */
    struct sparse *near; /* their preconditioner */
    double *diagonal;    /* of it */
    int steps, products; /* Newton steps, conjugate gradient steps so far */
    double gradient;     /* largest error of an equation, in <fn> */
    double pull;         /* largest component of `defect` */
    double gap;          /* mean of side times press */
    double aim;          /* of this step: side times press; below 0: the sides stay as they are */
    double length;       /* of this step */
    const double *v;     /* what series_product() multiplies */
};

/* What a contact without a measurement may carry: wide beliefs that hardly weigh. */
#define SERIES_PRIOR_NN 9
#define SERIES_SEGMENT 0.7 /* <fn>: standard deviation of a segment's constant */

int series_state_build(struct series *series, size_t s);
void series_state_free(struct series_state *state);
/* Median of the grains' standard errors along x (m), those not known left out; 0: none is. */
int series_median_error(const struct grains *grains, double *median);
/* B of the normal lines, and m, from the packing; `stiffness` and `offset` (m, of each radius) as fitted. */
int series_state_measure(struct series *series, size_t s, double offset, double s_offset);
/* kn as now estimated, in units per m. An error of kn acts on a line like an overlap error in proportion to fn (not to
 * the overlap, whose own error would pull kn down): after a stage this share follows the estimate. */
double series_stiffness(const struct series *series);
void series_follow_stiffness(struct series *series);

/* (B q)_n and (B q)_t of contact c. */
void series_error_at(const struct series *series, const struct series_state *state, size_t c, const double *q,
                     double out[2]);
/* Room for shared.count unknowns; new ones are 0. */
int series_shared_resize(struct series *series);
/* B' v of one state, v per contact, kept until series_add_up(): v must stay until then. */
void series_gather(const struct series *series, struct series_state *state, const double (*v)[2]);
/* out = sum of what the states have gathered, always in their order. */
void series_add_up(const struct series *series, double *out);

/* How well to solve. */
struct series_aim {
    int cold;        /* from scratch, else from where it stands */
    double loose;    /* <fn> of the most loaded state: extra error of every overlap */
    double gap;      /* mean of side times press */
    double gradient; /* <fn>: largest error of an equation of a state */
    double pull;     /* standard deviations: of the shared unknowns' equations */
};
#define SERIES_LAST_GAP 1e-3
#define SERIES_LAST_GRADIENT 1e-3
#define SERIES_LAST_PULL 1e-2
/* The optimum for the present open contacts. series->gap, gradient and pull say how well it was reached. */
int series_optimise(struct series *series, const struct series_aim *aim);
/* Factor every state at the present point; then dq from (I + sum B'(D + G' A' K^-1 A G) B) dq = right, solved by
 * conjugate gradients until the residual has shrunk to `share`. */
int series_factorise(struct series *series);
int series_solve_shared(struct series *series, const double *right, double *dq, double share);
/* out = S v, the matrix of that system; leaves each state's part in its sum. */
int series_product(struct series *series, const double *v, double *out);
/* Linearise and factorise at the present point; then df and dq for errors in the equations: gy, gl, pull (of the
 * forces' own) and defect, all of which it changes. */
int series_linearise(struct series *series);
int series_respond(struct series *series, double share);
/* V and f0 of a contact. */
void series_belief(const struct series_state *state, size_t c, double v[2], double *centre);
/* Work on every state by itself, on all threads when the series is large. What fails first, in the order of the states,
 * is the error. */
typedef int series_work(const struct series *series, struct series_state *state);
int series_for_states(struct series *series, series_work *work);
/* work += sign A G g, g on the lines of contact c; then, with u = A' solution,
 * out = lines D g + motion G' u: how the multipliers of contact c's lines react. */
void series_take(struct series_state *state, size_t c, double sign, const double g[2]);
void series_react(const struct series_state *state, size_t c, double lines, const double g[2], double motion,
                  const double u[2], double out[2]);
/* K^-1 of that state: work -> solution. */
int series_state_solve(struct series_state *state);

#endif
