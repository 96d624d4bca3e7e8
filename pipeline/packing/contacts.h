/* Contacts between grains i < j, or between grain i and wall j - N (N: number of grains). The normal points from i to
 * j; the tangent is the normal turned by +90 degrees. */
#ifndef PIPELINE_CONTACTS_H
#define PIPELINE_CONTACTS_H

#include "pipeline/state/columns.h"

enum contact_flag {
    CONTACT_NOT_FINITE = 1u << 0, /* an input number of this row was missing */
    CONTACT_NEW = 1u << 16,       /* not in contact in the previous state: its increments are NaN */
    CONTACT_CANDIDATE = 1u << 17, /* too unlikely to be a contact by itself: only map and series use it */
    CONTACT_PROMOTED = 1u << 18,  /* taken in because a grain could not stand without it */
    CONTACT_WALL = 1u << 19,      /* j is a wall */
    CONTACT_OPENED = 1u << 20     /* a candidate that was in contact in the previous state */
};
extern const char *const CONTACT_FLAG_NAMES[32];

struct contacts {
    size_t count;
    int64_t *i, *j;
    double *nx, *ny;             /* 1 */
    double *x, *y;               /* m: contact point, the middle of the overlap */
    double *overlap, *s_overlap; /* m: R_i + R_j - d, may be negative (a gap) */
    double *probability;         /* 1: that the true overlap is positive */
    double *un, *ut;             /* m: relative motion since the reference (docs/theory.md 1) */
    double *dun, *dut;           /* m: since the previous state */
    double *s_un, *s_ut, *s_dun, *s_dut;
    uint32_t *flags;
};
extern const struct table_kind CONTACTS;

#endif
