/* The photo at another pixel, its area averaged: blur and noise fall with the pixel, so that one set of rules in level
 * pixels serves grains of every size. Magnified photos are interpolated (cubic); they show nothing new, but radii of a
 * few pixels are then told apart by whole level pixels. */
#include "findgrains/look/level.h"

#include "findgrains/look/opencv_shim.h"
#include "pipeline/speak/error.h"

#include <math.h>
#include <stdlib.h>

#define MOST_TIMES 16 /* the photo magnified: radii of 1 px ask for 6 */

/* Pixels outside the frame get one grey level: no edges are found there. */
static void mask_outside(const struct zone *zone, double outside, struct level *level)
{
    if (!zone->has_frame)
        return;
    for (int y = 0; y < level->height; y++)
        for (int x = 0; x < level->width; x++)
            if (zone_depth(zone, level->x0 + x * level->scale, level->y0 + y * level->scale) <= 0)
                level->pixels[(size_t)y * (size_t)level->width + (size_t)x] = (float)outside;
}

/* The window is cut so that the level's pixels are square. */
static int choose_window(const struct zone *zone, double scale, int *width, int *height, struct level *level)
{
    int room_x = zone->x1 - zone->x0, room_y = zone->y1 - zone->y0;
    if (scale >= 1) {
        int factor = (int)scale;
        level->scale = factor;
        level->width = room_x / factor;
        level->height = room_y / factor;
        *width = level->width * factor;
        *height = level->height * factor;
    } else {
        int factor = (int)fmin(MOST_TIMES, round(1 / scale));
        level->scale = 1.0 / factor;
        level->width = room_x * factor;
        level->height = room_y * factor;
        *width = room_x;
        *height = room_y;
    }
    level->x0 = zone->x0 + 0.5 * (level->scale - 1);
    level->y0 = zone->y0 + 0.5 * (level->scale - 1);
    return level->width >= 4 && level->height >= 4;
}

int level_make(const struct photo *photo, const struct zone *zone, double scale, double outside, struct level *level)
{
    int width, height;
    *level = (struct level){0};
    if (!choose_window(zone, scale, &width, &height, level))
        return error_input("the photo (or its frame) is smaller than a few grains: check grains.radius_px and the "
                           "frame's corners");
    level->pixels = malloc((size_t)level->width * (size_t)level->height * sizeof *level->pixels);
    if (!level->pixels)
        return error_memory("scaled photo");
    if (shim_resample(photo->pixels, photo->width, zone->x0, zone->y0, width, height, level->width, level->height,
                      level->pixels)) {
        level_free(level);
        return -1;
    }
    mask_outside(zone, outside, level);
    return 0;
}

int level_shrink(const struct level *from, int factor, struct level *to)
{
    *to = (struct level){.width = from->width / factor, .height = from->height / factor, .scale = from->scale * factor};
    to->x0 = from->x0 + 0.5 * (factor - 1) * from->scale;
    to->y0 = from->y0 + 0.5 * (factor - 1) * from->scale;
    to->pixels = malloc((size_t)to->width * (size_t)to->height * sizeof *to->pixels);
    if (!to->pixels)
        return error_memory("scaled photo");
    for (int y = 0; y < to->height; y++)
        for (int x = 0; x < to->width; x++) {
            double sum = 0;
            for (int j = 0; j < factor; j++)
                for (int i = 0; i < factor; i++)
                    sum += from->pixels[(size_t)(y * factor + j) * (size_t)from->width + (size_t)(x * factor + i)];
            to->pixels[(size_t)y * (size_t)to->width + (size_t)x] = (float)(sum / (factor * factor));
        }
    return 0;
}

void level_free(struct level *level)
{
    free(level->pixels);
    *level = (struct level){0};
}
