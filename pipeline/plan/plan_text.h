/* A plan as text: for make, and as lines of JSON for people and other drivers. */
#ifndef PIPELINE_PLAN_TEXT_H
#define PIPELINE_PLAN_TEXT_H

#include <stdio.h>

struct plan;

/* A makefile (GNU make 4.3) whose goal `stages` makes every result; it is to run in the folder of the results.
 *
 * make sees the names of results only, which need no escape. What is outside, the planner looks at itself: a result
 * that is there, but older than a photo, a lens, its program or its part of the scene, or whose stage was cut off,
 * depends on the phony target `changed`. -1 with an error. */
int plan_print_make(const struct plan *plan, FILE *stream);

/* One line per result: {"product", "stage", "job", "part", "needs", "reads": [...], "command"}; the fields are those of
 * struct product, the part as SHA-256. -1 with an error. */
int plan_print_json(const struct plan *plan, FILE *stream);

#endif
