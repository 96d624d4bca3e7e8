/* Levels of 16 bits are taken by their upper 8, those of 8 bits as they are: 256 bins either way. */
#include "report/pictures/histogram.h"

#include <string.h>

/* Is the pixel's centre inside the quadrilateral? y points down, corners go round clockwise as seen. */
static int is_inside(const struct vec corners[4], double x, double y)
{
    for (int k = 0; k < 4; k++) {
        struct vec side = vec_sub(corners[(k + 1) % 4], corners[k]);
        if (vec_cross(side, vec_sub(vec(x, y), corners[k])) < 0)
            return 0;
    }
    return 1;
}

void histogram_make(const struct photo *photo, const struct scene *scene, struct histogram *histogram)
{
    size_t count[HISTOGRAM_BINS] = {0};
    int shift = photo->bits == 8 ? 0 : 8, framed = scene && scene->frame.given;
    memset(histogram, 0, sizeof *histogram);
    histogram->most = photo->bits == 8 ? 255 : 65535;
    for (int y = 0; y < photo->height; y++) {
        const uint16_t *row = photo_row(photo, y);
        for (int x = 0; x < photo->width; x++)
            if (!framed || is_inside(scene->frame.corners_px, x, y)) {
                count[row[x] >> shift & 255]++;
                histogram->pixels++;
            }
    }
    for (int b = 0; b < HISTOGRAM_BINS && histogram->pixels; b++)
        histogram->density[b] = (double)count[b] / (double)histogram->pixels;
}
