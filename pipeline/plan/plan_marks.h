/* What lies in the folder of the results, beside them, and what it says of each one. pipeline/stage keeps the marks:
 * .running/NAME as long as it is not known whether NAME is whole, .failed/NAME and .flagged/NAME with what the program
 * said. .scene/STAGE holds the part that the results of a stage were made with (plan.part). */
#ifndef PIPELINE_PLAN_MARKS_H
#define PIPELINE_PLAN_MARKS_H

#include <stdio.h>

#include "pipeline/plan/plan.h"

/* For all results of one stage. */
struct plan_marks {
    int part_changed[PLAN_STAGES]; /* 1: .scene/STAGE says something else than the plan, or is not there */
};

int plan_marks_read(const struct plan *plan, struct plan_marks *marks);

/* 1 when a result that is there must be made again because of what is no result itself: its stage was cut off, its part
 * of the scene, its program or a file that it reads is newer than it, or (series.csv) a file that was written with it
 * is gone. 0 when not, also where it is not there at all. -1 with an error. */
int plan_is_changed(const struct plan *plan, const struct plan_marks *marks, const struct product *product);

/* Before the first stage of a run, by whoever is alone in the folder (which must be there): removes results whose stage
 * was cut off, with the marks of that and of failures, and a series.csv that no longer says what the files do; writes
 * the parts that changed and the lists of words. Nothing is written through a symbolic link. -1 with an error. */
int plan_begin(const struct plan *plan);

/* One line per result: name, tabulator, "done", "flagged", "failed", "begun" or "missing", tabulator, "there" or
 * "absent": a file can be there although its stage failed later. -1 with an error. */
int plan_print_results(const struct plan *plan, FILE *stream);

/* A table of the same for people, one row per photo, with what failed and flagged stages said. */
int plan_print_status(const struct plan *plan, FILE *stream);

#endif
