/* Text files of the original programs: grains and earlier motions, read or refused with one line. */
#include <stdlib.h>

#include "pipeline/speak/error.h"
#include "tests/fuzz/target.h"
#include "tracker/original.h"

static int refused_properly(int failed)
{
    return !failed || ((error_status() == EXIT_INPUT || error_status() == EXIT_FAILED) && *error_message());
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const char *path = fuzz_file(data, size);
    struct photo_grains grains = {0}, previous = {0};
    error_clear();
    original_is_text(path);
    int failed = original_read_grains(path, &grains);
    if (!refused_properly(failed))
        abort();
    for (size_t k = 0; !failed && k < grains.count; k++)
        if (grains.radius_px[k] <= 0)
            abort();
    if (!failed && !refused_properly(original_read_motion(path, 0, &grains, &previous)))
        abort();
    table_free(&PHOTO_GRAINS, &grains);
    table_free(&PHOTO_GRAINS, &previous);
    return 0;
}
