/* The names of the force methods, in the one order in which their forces are looked at when nobody names one. */
#ifndef PIPELINE_METHOD_ORDER_H
#define PIPELINE_METHOD_ORDER_H

/* For the help of options. */
#define METHOD_DEFAULT_ORDER "the first that the file has of series, map, qsm, cdm, cem, dem, then others by name"

/* The place of a name in the order of series, map, qsm, cdm, cem, dem; 6 for any other. A name has NAME_LENGTH bytes at
 * most and needs no zero at its end. */
int method_rank(const char *method);
/* That order, then the others by name: negative when a comes before b, 0 when they are one. */
int method_order(const char *a, const char *b);

#endif
