/* A series of state files, each reduced to what a page shows; the files themselves are read one at a time. */
#ifndef REPORT_SERIES_H
#define REPORT_SERIES_H

#include "pipeline/packing/stress.h"
#include "pipeline/packing/structure.h"
#include "report/states/loaded.h"
#include "report/states/method_choice.h"
#include "pipeline/numbers/quantiles.h"

enum { SERIES_METHODS = 8 };

/* What findgrains or tracker wrote about one photo. */
struct photo_summary {
    char *path;
    size_t grains, distrusted, flags[32];
    struct quantiles zncc, s_place, s_angle, s_size; /* over trusted grains; standard errors: px, rad, px */
};

struct force_summary {
    char method[NAME_LENGTH], start[NAME_LENGTH];
    int iterations, converged, infeasible;
    double imbalance, mean_fn, slipping; /* slipping: share of the loaded contacts */
    double data_misfit;                  /* 0: the method has none */
    double overlaps_over_loads;          /* stress.h; NaN: not known */
    double weber[2][2];
    enum verdict verdict; /* packing/verdict.h; unknown in files that say none */
    char reasons[1000];
};

/* What contacts or forces wrote about one state. */
struct packing_summary {
    char *path;
    size_t grains, distrusted, flags[32], candidates, floating;
    struct fabric fabric;
    double h; /* degree of indeterminacy, with the friction of the default method */
    double applied[2][2], strain[3];
    int in_pascal;
    struct force_summary forces[SERIES_METHODS];
    size_t force_count;
};

struct series_row {
    char *name; /* what stands before the first dot of the file names: "0003" */
    int64_t index;
    double time_s;
    char taken[20];                      /* by the camera's clock; "": not known */
    struct photo_summary grains, tracks; /* path == NULL: not given */
    struct packing_summary packing;      /* of the forces file when there is one, else of contacts */
    char *contacts_path;                 /* of the file of contacts, when there is one */
};

struct series_input {
    char *file, *name, *sha256; /* state file, what it was made from */
};

struct series {
    struct series_row *rows; /* by index, then name */
    size_t count;
    struct methods methods; /* of all rows */
    const char *method;     /* the one that speaks for all states; NULL: each state's default one */
    struct series_input *inputs;
    size_t input_count;
    char versions[200]; /* of the programs that wrote the files, comma-separated */
};

int series_read(char *const paths[], size_t count, struct series *series);
void series_free(struct series *series); /* accepts a zeroed struct */
/* The style of a method in every chart of the series, 1 and up; 0 is left for what is applied. */
size_t series_style(const struct series *series, const char *method);

#endif
