/* Probes by discrete elements in the plane behind hertz_search(): a consolidated packing, its record, threads. */
#ifndef CALIBRATION_HERTZ_PROBES_H
#define CALIBRATION_HERTZ_PROBES_H

#include "calibration/hertz/hertz_search.h"
#include "calibration/hertz/probe.h"
#include "calibration/hertz/probe_record.h"

struct hertz_probes {
    const struct simulation *simulation; /* the packing; the law's E* and nu* are replaced */
    struct probe_options probe;
    int cold; /* 1: every probe consolidates its packing anew (the paper); 0: warm, from one consolidated packing */
    struct probe_packing base; /* warm */
    struct probe_record record;
};

/* Consolidate at about the right stiffness and give the closed-form start of the goal from the packing's own S / N_c
 * and d50: fills goal->grain_young, and goal->grain_poisson unless it is given (not NaN). */
int hertz_probes_open(const struct simulation *simulation, const struct probe_options *probe, int cold,
                      const char *record_path, struct hertz_goal *goal, struct hertz_probes *probes);
void hertz_probes_close(struct hertz_probes *probes);
/* A hertz_evaluate: rows that the record has are taken from it; the others run side by side. */
int hertz_probes_evaluate(struct hertz_trial *trials, size_t count, void *probes);

#endif
