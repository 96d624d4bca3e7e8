/* Memory that runs out when a test says so. The program is linked with -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc,
 * so that our own code asks here; cJSON, a shared library, asks here after failing_memory_of_json(). */
#ifndef TESTS_FAILING_MEMORY_H
#define TESTS_FAILING_MEMORY_H

#include <stdatomic.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/files/json.h"
#include "pipeline/state/columns.h"

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *old, size_t size);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *old, size_t size);

/* Allocations until the one that fails; below 0: none fails (any more). */
static atomic_long allocations_left = -1;

static int allocation_fails(void)
{
    return atomic_load(&allocations_left) >= 0 && atomic_fetch_sub(&allocations_left, 1) == 0;
}

void *__wrap_malloc(size_t size)
{
    return allocation_fails() ? NULL : __real_malloc(size);
}

void *__wrap_calloc(size_t count, size_t size)
{
    return allocation_fails() ? NULL : __real_calloc(count, size);
}

void *__wrap_realloc(void *old, size_t size)
{
    return allocation_fails() ? NULL : __real_realloc(old, size);
}

/* Has the allocation that was to fail been asked for? Ends the trial. */
static inline int allocation_failed(void)
{
    return atomic_exchange(&allocations_left, -1) < 0;
}

static inline void failing_memory_of_json(void)
{
    cJSON_Hooks hooks = {__wrap_malloc, free};
    cJSON_InitHooks(&hooks);
}

/* Do two tables hold the same columns, bit by bit? */
static inline int same_columns(const struct table_kind *kind, const void *a, const void *b)
{
    size_t rows = table_rows(kind, a);
    for (size_t c = 0; c < kind->column_count; c++) {
        const void *x = *table_array(&kind->columns[c], a), *y = *table_array(&kind->columns[c], b);
        size_t width = kind->columns[c].type == COLUMN_UINT32 ? 4
                       : kind->columns[c].type == COLUMN_NAME ? NAME_LENGTH
                                                              : 8;
        if (!x != !y || (x && memcmp(x, y, rows * width)))
            return 0;
    }
    return rows == table_rows(kind, b);
}

#endif
