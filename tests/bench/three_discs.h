/* The three discs of thesis Fig. 2.11: 1 and 2 fixed, 3 rests on both under P, branches at 45 degrees. Symmetric: one
 * pair (fn, ft) stands for both contacts, and the vertical motion is the only freedom. */
#ifndef BENCH_THREE_DISCS_H
#define BENCH_THREE_DISCS_H

#include "tests/bench/thesis.h"

#define THREE_P 1530.0 /* N */
#define THREE_KN 5e7   /* N/m */
#define THREE_R 5.7e-3 /* m */
enum { THREE_LIMIT = 400 };

struct three_path {
    int count; /* iterations done */
    double fn[THREE_LIMIT + 1], ft[THREE_LIMIT + 1], fy[THREE_LIMIT + 1];
};
double three_fy(double p, double fn, double ft);         /* N: resultant on disc 3, upwards */
double three_mobilised(double mu, double fn, double ft); /* thesis (2.55) */
/* Random start number k: fn in [0, spread P cos 45], |ft| < mu spread P cos 45. Thesis (2.59) prints a spread of 1; its
 * ends, with <fn> about 1080 N and m near 0 in the mean, are those of 2, where starts push too much as often as too
 * little. */
#define THREE_SPREAD 2.0
void three_start(double spread, double mu, size_t k, double *fn, double *ft);
/* Until |Fy| < 1e-15 P (thesis 2.58, 2.67), or it no longer shrinks. plastic_first: the projection onto the cone comes
 * first. */
void three_dynamics(double mu, double fn, double ft, struct three_path *path);
void three_projections(double p, double mu, double fn, double ft, int plastic_first, struct three_path *path);
/* The same by the program's own qsm on the packing, in three degrees of freedom. */
int three_by_program(enum force_method method, double mu, double fn, double ft, double *fn_end, double *ft_end);
/* Molecular dynamics of thesis 2.2.1: impulse of an upward force `noise` during the first step, then P; dashpots of
 * damping sqrt(m kn) along the normals. The path of (fn, ft) at contact 1-3, every fourth step, goes into the line
 * (NULL: none). The thesis prints 0.9, with which the disc swings; its results are those of a disc that does not: 3.6.
 */
#define THREE_DAMPING 3.6
struct three_rest {
    double fn, ft, down; /* N, N, m: vertical displacement */
    int rests;
};
struct three_rest three_molecular(double damping, double noise, struct chart_line *line);

#endif
