/* A photo is read whole or refused with one line; nothing is printed, no more memory is taken than the limit says. */
#include <stdlib.h>

#include "pipeline/speak/error.h"
#include "pipeline/scene/photo.h"
#include "tests/fuzz/target.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const enum photo_channel channels[] = {PHOTO_GREY_ONLY, PHOTO_BLUE, PHOTO_GREY_OF_RGB};
    const char *path = fuzz_file(data, size);
    photo_limit_pixels(1 << 20);
    for (int k = 0; k < 3; k++) {
        struct photo_request request = {.channel = channels[k]};
        struct photo photo;
        error_clear();
        if (photo_read(path, &request, &photo)) {
            if (photo.pixels || !*error_message() || error_status() != EXIT_INPUT)
                abort();
            continue;
        }
        for (size_t p = 0; p < (size_t)photo.width * (size_t)photo.height; p++)
            if (photo.pixels[p] > (photo.bits == 8 ? 255 : 65535))
                abort();
        photo_free(&photo);
    }
    return 0;
}
