/* Inside of bench_forces: one function per table, and what they share. */
#ifndef BENCH_FORCE_TABLES_H
#define BENCH_FORCE_TABLES_H

#include "tests/bench/force_states.h"

struct bench {
    double kappa[8], grains;
    int kappas;
    long steps;
    double strain;                  /* of a step */
    uint64_t seed;                  /* of the errors */
    uint64_t sample;                /* of the packing */
    long draws;                     /* of the errors, with seeds one after the other */
    const char *folder;             /* of kept states; NULL: none */
    const struct packing *previous; /* state before this one, with its true forces; NULL: none */
};

/* Errors as in the table of the joint estimate: s px with <fn> = 66 N, kn = 1e7 N/m and 6e-5 m/px. */
#define PIXEL (1e7 * 6e-5 / 66)

struct force_options bench_options(void); /* kn = 1.09e7 N/m, mu = 0.5 */

/* One run, one line; counted under that name, NULL: the label and the method. */
int bench_measure(const struct packing *truth, const struct packing *packing, const struct force_options *options,
                  enum force_method method, const char *label, const char *name);

/* The tables, each for one state. */
typedef int table(const struct bench *bench, const struct packing *truth, const char *label);
table table_speed, table_along, table_warm, table_range, table_stability; /* force_tables_speed.c */
table table_noise, table_network, table_lost, table_interval, table_kn;   /* force_tables_errors.c */
#endif
