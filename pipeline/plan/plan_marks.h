/* What lies in the folder of the results, beside them, and what it says of each one. pipeline/stage keeps the marks:
 * .running/NAME as long as it is not known whether NAME is whole, .failed/NAME and .flagged/NAME with what the program
 * said. .scene/STAGE holds the part that the results of a stage were made with (plan.part). */
#ifndef PIPELINE_PLAN_MARKS_H
#define PIPELINE_PLAN_MARKS_H

#include <stdio.h>

#include "pipeline/plan/plan.h"

/* 1: the folder of the results holds this file ("0001.tracks.hdf", ".failed/0001.tracks.hdf"). */
int plan_holds(const struct plan *plan, const char *folder, const char *name);

/* Into `changed`, for each stage, 1 where .scene/STAGE says something else than the plan, or is not there. */
void plan_changed_parts(const struct plan *plan, int changed[PLAN_STAGES]);

/* 1 when a result that is there must be made again because of what is no result itself: its stage was cut off, its part
 * of the scene (`parts`, as above), its program or a file that it reads changed since, or (series.csv) a file that was
 * written with it is gone. 0 when not, also where it is not there at all. As for make, what is newer by a nanosecond
 * changed. */
int plan_is_changed(const struct plan *plan, const int parts[PLAN_STAGES], const struct product *product);

/* Before the first stage of a run, by whoever is alone in the folder (which must be there): removes results whose stage
 * was cut off, with the marks of that and of failures, and a series.csv that no longer says what the files do; writes
 * the parts that changed and the lists of words. Nothing is written through a symbolic link. -1 with an error. */
int plan_begin(const struct plan *plan);

/* One line per result: name, tabulator, "done", "flagged", "failed", "begun" or "missing", tabulator, "there" or
 * "absent": a file can be there although its stage failed later. */
void plan_print_results(const struct plan *plan, FILE *stream);

/* A table of the same for people, one row per photo, with what failed and flagged stages said; -1: no memory. */
int plan_print_status(const struct plan *plan, FILE *stream);

#endif
