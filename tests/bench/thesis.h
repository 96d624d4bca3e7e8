/* The figures of the thesis (Tolomeo 2018, chapters 2 and 3) made again with this program, each as a table and a
 * picture (docs/thesis.md). */
#ifndef BENCH_THESIS_H
#define BENCH_THESIS_H

#include <stdio.h>

#include "pipeline/draw/chart.h"
#include "tests/bench/force_states.h"

struct thesis {
    const char *folder; /* of tables, pictures and cached states */
    const char *figure; /* "3.14" */
    FILE *table;
};

struct figure {
    const char *number, *what;
    int (*make)(struct thesis *thesis);
};
/* Each ends with a row of NULL. */
extern const struct figure FIGURES_THREE_DISCS[], FIGURES_THREE_PATHS[], FIGURES_CEM[], FIGURES_STARTS[],
    FIGURES_SERIES[], FIGURES_NETWORK[], FIGURES_VARIABILITY[];

/* A line of the figure's table, also to the standard output. */
__attribute__((format(printf, 2, 3))) void thesis_line(struct thesis *thesis, const char *format, ...);
/* Charts side by side in FOLDER/figure-N.png; they are freed whatever happens. */
int thesis_picture(const struct thesis *thesis, struct chart *charts, size_t count);
/* Force maps side by side. */
int thesis_maps(const struct thesis *thesis, const struct packing *const *packings, const struct forces *const *forces,
                const char *const *titles, size_t count);
/* A line of separate points. */
struct chart_line *thesis_scatter(struct chart *chart, const char *name, size_t capacity);
void thesis_point(struct chart_line *line, double x, double y);

/* States of a vertical biaxial test (grading of the thesis, kn = kt = 1.09e7 N/m, mu = 0.5): made by simulate, or read
 * when the folder has them. patience: steps of one relaxation; 0: until every state is static to 1e-8 of <fn>. */
struct thesis_test {
    double grains, kappa;
    long steps;
    double strain; /* from one to the next */
    uint64_t seed;
    long patience;
};
int thesis_states(const struct thesis *thesis, const struct thesis_test *test, struct states *states);
double thesis_strain(const struct states *states, size_t s); /* of the height, since state 0; compression positive */
double thesis_indeterminacy(const struct packing *packing);  /* h: unknown forces less equations */

/* One estimate against the truth. */
struct trial {
    double rn, rt;       /* Pearson with the truth; rn with the walls */
    double strong, weak; /* of fn above and below the mean */
    double distance;     /* mean length of the difference, over <fn> */
    struct forces forces;
};
struct force_options thesis_options(enum force_start start);
int thesis_try(const struct packing *truth, const struct packing *measured, const struct force_options *options,
               enum force_method method, struct trial *trial);
void trial_free(struct trial *trial);
/* Give the packing one more set of forces, which it takes over (zeroed after). */
int thesis_keep(struct packing *packing, struct forces *forces);

#endif
