/* Everything lies in px of the photo, y downwards, and is drawn scale px of the picture per px, from (x0, y0) on. Where
 * the lens has been undone (x_px), the photo still shows the rim where it was seen (x_seen_px): there it is drawn. */
#include "report/pictures/photo_map.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/draw/axis.h"
#include "pipeline/draw/legend.h"
#include "pipeline/draw/photo_background.h"

/* Where the rim is seen, px of the photo. */
static double place_x(const struct photo_grains *grains, size_t k)
{
    return grains->x_seen_px && isfinite(grains->x_seen_px[k]) ? grains->x_seen_px[k] : grains->x_px[k];
}

static double place_y(const struct photo_grains *grains, size_t k)
{
    return grains->y_seen_px && isfinite(grains->y_seen_px[k]) ? grains->y_seen_px[k] : grains->y_px[k];
}

/* Known grains that were lost have no place. */
static int is_placed(const struct photo_grains *grains, size_t k)
{
    return isfinite(place_x(grains, k)) && isfinite(place_y(grains, k)) && isfinite(grains->radius_px[k]);
}

/* Motion since the reference; 0 where it is not known. */
static double motion(const struct photo_grains *grains, size_t k, double *dx, double *dy)
{
    *dx = *dy = 0;
    if (!grains->x_ref_px || !grains->y_ref_px || !is_placed(grains, k) || !isfinite(grains->x_ref_px[k]) ||
        !isfinite(grains->y_ref_px[k]))
        return 0;
    *dx = grains->x_px[k] - grains->x_ref_px[k];
    *dy = grains->y_px[k] - grains->y_ref_px[k];
    return hypot(*dx, *dy);
}

/* The longest trusted motion becomes two mean radii, in round steps. */
static double choose_arrows(const struct photo_grains *grains)
{
    double longest = 0, radius = 0, dx, dy;
    size_t count = 0;
    for (size_t k = 0; k < grains->count; k++) {
        if (!is_placed(grains, k) || (grains->flags[k] & GRAIN_DISTRUST))
            continue;
        longest = fmax(longest, motion(grains, k, &dx, &dy));
        radius += grains->radius_px[k];
        count++;
    }
    return longest > 0 ? axis_round_down(2 * radius / (double)count / longest) : 0;
}

int photo_map_measure(struct photo_map *map)
{
    const struct photo_grains *grains = map->grains;
    double x0 = INFINITY, y0 = INFINITY, x1 = -INFINITY, y1 = -INFINITY;
    for (size_t k = 0; k < grains->count; k++) {
        if (!is_placed(grains, k))
            continue;
        double x = place_x(grains, k), y = place_y(grains, k), r = grains->radius_px[k];
        x0 = fmin(x0, x - r), y0 = fmin(y0, y - r);
        x1 = fmax(x1, x + r), y1 = fmax(y1, y + r);
    }
    double across = x1 - x0, down = y1 - y0;
    if (!(across > 0) || !(down > 0) || down > 20 * across)
        return error_input("no grain has a place: there is nothing to draw");
    double margin = 0.03 * fmax(across, down);
    map->scale = map->width / (across + 2 * margin);
    map->x0 = x0 - margin;
    map->y0 = y0 - margin;
    map->view_height = map->scale * (down + 2 * margin);
    map->height = ceil(map->view_height + 0.08 * map->width);
    if (isnan(map->arrows))
        map->arrows = choose_arrows(grains);
    return 0;
}

/* Rim and centre: sky blue, or purple and wider when they are not to be trusted. */
static void draw_rims(const struct photo_map *map, struct canvas *canvas)
{
    const struct photo_grains *grains = map->grains;
    double u = map->width / 1000;
    for (size_t k = 0; k < grains->count; k++) {
        int trusted = !(grains->flags[k] & GRAIN_DISTRUST);
        if (!is_placed(grains, k))
            continue;
        const struct pen rim = {trusted ? COLOUR_SKY : COLOUR_PURPLE, .width = (trusted ? 1.5 : 3) * u};
        double x = map->scale * (place_x(grains, k) - map->x0), y = map->scale * (place_y(grains, k) - map->y0);
        pen_circle(canvas, &rim, x, y, map->scale * grains->radius_px[k]);
        pen_circle(canvas, &(struct pen){.colour = rim.colour}, x, y, 1.8 * u);
    }
}

/* From where the grain was, or rather from where it is seen, back along a stretched motion. */
static void draw_arrows(const struct photo_map *map, struct canvas *canvas)
{
    double u = map->width / 1000, dx, dy;
    const struct pen pen = {COLOUR_VERMILLION, .width = 2 * u};
    for (size_t k = 0; k < map->grains->count; k++) {
        if ((map->grains->flags[k] & GRAIN_DISTRUST) || !(motion(map->grains, k, &dx, &dy) > 0))
            continue;
        double x = map->scale * (place_x(map->grains, k) - map->x0),
               y = map->scale * (place_y(map->grains, k) - map->y0);
        pen_arrow(canvas, &pen, x, y, x + map->arrows * map->scale * dx, y + map->arrows * map->scale * dy, u);
    }
}

/* Title, counts, the length of an arrow and of the scale bar, below the view. */
static void draw_legend(const struct photo_map *map, struct canvas *canvas)
{
    double u = map->width / 1000, y = map->view_height;
    size_t flagged = 0, lost = 0;
    char text[200];
    for (size_t k = 0; k < map->grains->count; k++) {
        flagged += (map->grains->flags[k] & GRAIN_DISTRUST) != 0;
        lost += !is_placed(map->grains, k);
    }
    pen_rectangle(canvas, &(struct pen){.colour = COLOUR_WHITE}, 0, y, map->width, map->height - y);
    words_within(canvas, 25 * u, y + 32 * u, 575 * u, 19 * u, 1, map->title ? map->title : "");
    snprintf(text, sizeof text, "%zu grains; %zu flagged: do not trust (purple); %zu without a place",
             map->grains->count, flagged, lost);
    words_within(canvas, 25 * u, y + 58 * u, 575 * u, 15 * u, 0, text);
    if (map->arrows > 0) {
        double length = axis_round_down(90 * u / (map->arrows * map->scale));
        pen_arrow(canvas, &(struct pen){COLOUR_VERMILLION, .width = 2 * u}, 620 * u, y + 26 * u,
                  620 * u + length * map->arrows * map->scale, y + 26 * u, u);
        snprintf(text, sizeof text, "motion of %g px (× %g)", length, map->arrows);
        words_draw(canvas, 620 * u, y + 54 * u, 0, 15 * u, 0, text);
    }
    double bar = axis_round_down(0.1 * map->width / map->scale);
    snprintf(text, sizeof text, "%g px", bar);
    legend_scale(canvas, 975 * u, y + 26 * u, bar * map->scale, 4 * u, 28 * u, 15 * u, text);
}

int photo_map_draw(const struct photo_map *map, struct canvas *canvas)
{
    if (map->photo) {
        struct photo_view view = {map->x0, map->y0, map->x0 + map->width / map->scale,
                                  map->y0 + map->view_height / map->scale};
        if (photo_background(canvas, map->photo, &view, map->width, map->view_height))
            return -1;
    }
    draw_rims(map, canvas);
    if (map->arrows > 0)
        draw_arrows(map, canvas);
    draw_legend(map, canvas);
    return 0;
}

int photo_map_write(struct photo_map *map, const char *path)
{
    struct canvas canvas;
    if (photo_map_measure(map) || canvas_begin(&canvas, path, map->width, map->height))
        return -1;
    return canvas_end(&canvas, photo_map_draw(map, &canvas));
}
