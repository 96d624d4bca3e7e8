/* Whose forces speak when nobody names a method. */
#ifndef REPORT_METHOD_H
#define REPORT_METHOD_H

#include "pipeline/packing/method_order.h"
#include "pipeline/packing/packing.h"

/* The forces of the method that comes first in that order; NULL: the packing has none. */
const struct forces *method_default(const struct packing *packing);
/* The forces of that method; of the default one when `method` is NULL, and then *forces may be NULL, too. An error that
 * names the file when it lacks the method that was named. */
int method_choose(const struct packing *packing, const char *path, const char *method, const struct forces **forces);

/* The methods of several states, in the order above. */
enum { METHODS_MOST = 16 };
struct methods {
    struct {
        char name[NAME_LENGTH + 1];
        size_t states, converged; /* that have it; in which it converged */
        double sum_fn;            /* N: of <fn> over its loaded states */
        size_t loaded;
    } list[METHODS_MOST];
    size_t count;
    size_t states; /* with forces: counted by the caller */
};

/* A state has that method, with that <fn> (N; NaN: no contact bears a force). A method too many is left out. */
void methods_add(struct methods *methods, const char *method, int converged, double mean_fn);
/* One method for all of the states: series, else map, else the first that converged in all states, else the first that
 * all have. NULL: they have none in common. */
const char *methods_common(const struct methods *methods);
/* <fn> by that method, the mean over its states; NULL: over all methods and states. NaN when none is loaded. N. */
double methods_mean_fn(const struct methods *methods, const char *method);
/* The place of a method in the list; `count` when it is not there. */
size_t methods_find(const struct methods *methods, const char *method);

#endif
