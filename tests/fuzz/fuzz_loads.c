/* Loads of a square frame: applied or refused with one line. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/packing/loads.h"
#include "tests/fuzz/target.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const char *const names[] = {"bottom", "right", "top", "left"};
    static const double x[] = {0, 1, 1, 0}, y[] = {0, 0, 1, 1};
    struct walls walls = {0};
    error_clear();
    if (table_alloc(&WALLS, &walls, 4, NULL))
        abort();
    for (int k = 0; k < 4; k++) {
        strncpy(walls.name[k], names[k], NAME_LENGTH);
        walls.x0[k] = x[k], walls.y0[k] = y[k], walls.radius[k] = 0;
        walls.x1[k] = x[(k + 1) % 4], walls.y1[k] = y[(k + 1) % 4];
    }
    if (loads_apply(fuzz_file(data, size), 0, 0.06, &walls) && (error_status() != EXIT_INPUT || !*error_message()))
        abort();
    for (int k = 0; k < 4; k++)
        if (isinf(walls.fx[k]) || isinf(walls.fy[k]))
            abort();
    table_free(&WALLS, &walls);
    return 0;
}
