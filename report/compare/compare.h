/* One state file against another: A is judged, B is the truth or the other opinion. Grains may be numbered
 * differently; they are matched by position (match.h), contacts through the matched grains, walls by name. Rows of A
 * that carry a flag of distrust count as found, but not in the errors. */
#ifndef REPORT_COMPARE_H
#define REPORT_COMPARE_H

#include "pipeline/packing/grains.h"
#include "pipeline/packing/packing.h"
#include "report/compare/figures.h"

/* Photo side (px). */
struct compare_photo {
    const struct photo_grains *a, *b;
    int a_is_seen;                      /* A holds positions as seen: compare with B's x_seen_px when it has them */
    const struct photo_grains *a0, *b0; /* the same rows in the reference; NULL: A's x_ref_px, and B's */
};
int compare_photo(const struct compare_photo *pair, struct figures *figures);

/* SI side. Methods: NULL: the default one (report/states/method_choice.h); a file without forces compares its contacts
 * only. */
int compare_packings(const struct packing *a, const struct packing *b, const char *method_a, const char *method_b,
                     struct figures *figures);

/* |fn of A - fn of B| over <fn> of B for every contact of either (thesis Fig. 3.22); *errors to be freed. NULL and 0
 * when one of them lacks the method. */
int compare_force_errors(const struct packing *a, const struct packing *b, const char *method_a, const char *method_b,
                         double **errors, size_t *count);

/* Pearson's r of two samples (thesis eq. 3.3); NaN for fewer than two pairs or a constant sample. */
double pearson(const double *a, const double *b, size_t count);

#endif
