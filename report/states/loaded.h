/* A state file of any stage in memory. */
#ifndef REPORT_LOADED_H
#define REPORT_LOADED_H

#include "pipeline/packing/grains.h"
#include "pipeline/packing/packing.h"

struct loaded {
    char *path;
    int is_si;                  /* else photo side */
    struct photo_grains grains; /* photo side */
    struct packing packing;     /* SI side */
    struct state_info info;     /* photo side; packing.info on the SI side */
};

int loaded_read(const char *path, struct loaded *loaded);
void loaded_free(struct loaded *loaded); /* accepts a zeroed struct */
const struct state_info *loaded_info(const struct loaded *loaded);

#endif
