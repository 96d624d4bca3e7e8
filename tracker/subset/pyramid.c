/* Means over 2 x 2 pixels are what a sensor with larger pixels would have seen: speckle that is finer than a coarse
 * pixel averages out instead of appearing as another pattern. */
#include "tracker/subset/pyramid.h"

#include <stdlib.h>

#include "pipeline/speak/error.h"

/* Means of 2 x 2 pixels, rounded; `factor` 256 gives 8-bit photos room for the fractions. */
static int halve(const struct photo *from, unsigned factor, struct photo *to)
{
    *to = (struct photo){.width = from->width / 2, .height = from->height / 2, .bits = 16};
    to->pixels = malloc((size_t)to->width * (size_t)to->height * sizeof *to->pixels);
    if (!to->pixels)
        return error_memory("a smaller copy of a photo");
    for (int y = 0; y < to->height; y++) {
        const uint16_t *above = photo_row(from, 2 * y), *below = photo_row(from, 2 * y + 1);
        uint16_t *row = to->pixels + (size_t)y * (size_t)to->width;
        for (int x = 0; x < to->width; x++) {
            unsigned sum = (unsigned)above[2 * x] + above[2 * x + 1] + below[2 * x] + below[2 * x + 1];
            row[x] = (uint16_t)((sum * factor + 2) / 4);
        }
    }
    return 0;
}

int pyramid_build(const struct photo *photo, struct pyramid *pyramid)
{
    *pyramid = (struct pyramid){.count = 1, .levels = {*photo}};
    while (pyramid->count < PYRAMID_LEVELS) {
        const struct photo *last = &pyramid->levels[pyramid->count - 1];
        if (last->width < 16 || last->height < 16)
            break;
        if (halve(last, last->bits == 8 ? 256 : 1, &pyramid->levels[pyramid->count])) {
            pyramid_free(pyramid);
            return -1;
        }
        pyramid->count++;
    }
    return 0;
}

void pyramid_free(struct pyramid *pyramid)
{
    for (int level = 1; level < pyramid->count; level++)
        free(pyramid->levels[level].pixels);
    *pyramid = (struct pyramid){0};
}
