/* Rank of a sparse symmetric matrix whose unknowns lie in the plane. */
#ifndef PIPELINE_RANK_H
#define PIPELINE_RANK_H

#include <stddef.h>

#include "pipeline/numbers/geometry.h"

enum { RANK_WIDTH = 6 };

/* A column of the matrix A: its entries, in the rows row[0], ..., row[count - 1]. */
struct rank_column {
    int count;
    size_t row[RANK_WIDTH];
    double value[RANK_WIDTH];
};

/* Rank of A, whose entries are of size 1, `rows` x `count`, from its columns; place[r] is where row r lies in the
 * plane, NaN for the few rows whose entries lie anywhere: columns should join places that are near each other, else the
 * cost grows to rows^3. Rows that depend on the others to within some 1e-5 count as dependent. 0, or -1 when out of
 * memory. */
int rank_of(const struct rank_column *columns, size_t count, const struct vec *place, size_t rows, size_t *rank);

#endif
