/* A force method as a row: what it is called, what it needs, what it does and what can be asked of it.
 *
 * A new method is one file of its own, here or elsewhere, that ends with its row; a number and a declaration below; and
 * a line of the table in method.c. A program that links the library can also add its row at run time, by method_add():
 * tests/unit/test_new_method.c shows a whole method so. Nothing else asks which method it is. */
#ifndef FORCES_METHOD_H
#define FORCES_METHOD_H

#include "forces/network/force_options.h"
#include "forces/network/network.h"
#include "forces/network/network_result.h"

/* The numbers of the rows; those of rows that are added follow. */
enum force_method { METHOD_CEM, METHOD_CDM, METHOD_QSM, METHOD_MAP, METHOD_COUNT };
enum { METHODS_ADDED_MOST = 8 };

/* What a method works on. The network is in working units (equations.h); nothing of it is changed. */
struct problem {
    const struct packing *packing;
    const struct network *network;
    const struct force_options *options;
};

/* How an iteration ended. */
struct outcome {
    int iterations;
    int converged;    /* imbalance <= tolerance */
    double imbalance; /* network_judge() of the returned forces */
};

/* Which contacts a method works on: those that are decided, or also those that are candidates only. */
enum candidates { CANDIDATES_NEVER, CANDIDATES_IF_ASKED /* options->candidates */, CANDIDATES_ALWAYS };

/* What must be given; every method needs mu. */
enum { NEEDS_STIFFNESS = 1, NEEDS_OVERLAPS = 2, NEEDS_PREVIOUS = 4 };

struct method {
    const char *name; /* on the command line and in the file; less than NAME_LENGTH bytes */
    const char *says; /* one sentence for --help */
    unsigned needs;   /* NEEDS_... */
    int starts;       /* 1: it begins at the forces of options->start; 0: it knows what to begin with */
    int balances;     /* 1: it seeks equilibrium, so that grains out of balance count against it */
    int walks;        /* 1: it leads any forces back to admissible ones, so that a random walk can use it */
    int ranges;       /* 1: the exact ranges of its contacts can be asked for */
    enum candidates candidates;
    double margin; /* how near to the corner (in <fn>) and to the edges (as a share) of its cone a contact counts as
                      open or slipping; METHOD_MARGIN where forces reach the edges */
    double doubt;  /* <fn>: when it leaves more unbalanced than that, a proof that nothing balances is sought; INFINITY:
                      never */
    /* Forces (fn, ft) of each contact of the network, from those in f (zeros unless it starts). 0; -1: failed. A method
     * that stops early is no failure: the result is judged in any case. */
    int (*solve)(const struct problem *problem, double *f, struct outcome *outcome);
    /* options->samples draws of what the data leave open, from the start f; NULL: it has none. */
    int (*sample)(const struct problem *problem, const double *f, struct spread *spread);
};
#define METHOD_MARGIN 1e-9 /* far above rounding, which depends on the compiler */

extern const struct method CEM_METHOD, CDM_METHOD, QSM_METHOD, MAP_METHOD;

/* The row of that number; NULL, with an error: there is none. */
const struct method *method_row(enum force_method method);
/* The number of the row of that name (`length` bytes), or -1 without an error. */
int method_find(const char *name, size_t length);
/* The names of all rows, in their order, with commas; to be freed. NULL, with an error: out of memory. */
char *method_names(void);
/* "cem: its sentence. cdm: ..." of all rows, for --help; to be freed. NULL, with an error: out of memory. */
char *method_help(void);
/* Add a row, which must stay where it is; returns its number, or -1 when the name is taken or the table full. Not while
 * another thread infers forces. */
int method_add(const struct method *row);

/* The network that this method works on: its contacts, the options' law and mass of walls. 0 or -1. */
int method_network(const struct packing *packing, const struct force_options *options, const struct method *method,
                   struct network *network);

#endif
