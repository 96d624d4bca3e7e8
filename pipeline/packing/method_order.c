#include "pipeline/packing/method_order.h"

#include <string.h>

#include "pipeline/state/columns.h"

/* The more a method uses of what is known, the earlier it stands; the truth of a simulation stands alone in its file.
 */
int method_rank(const char *method)
{
    static const char *const order[] = {"series", "map", "qsm", "cdm", "cem", "dem"};
    enum { KNOWN = sizeof order / sizeof *order };
    for (int k = 0; k < KNOWN; k++)
        if (!strncmp(order[k], method, NAME_LENGTH))
            return k;
    return KNOWN;
}

int method_order(const char *a, const char *b)
{
    int first = method_rank(a), second = method_rank(b);
    return first != second ? first - second : strncmp(a, b, NAME_LENGTH);
}
