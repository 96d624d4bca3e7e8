#include "report/pictures/force_map.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/draw/canvas.h"
#include "report/pictures/draw_photo.h"

/* Of the mean radius: the width of the line of a mean force. */
static const double MEAN_WIDTH = 0.22;
/* Of the unit: from here on all lines are as wide, so that one absurd force does not cover the others. */
static const double WIDEST = 8;
static const double FULL_TURN = 6.283185307179586;

/* ---- the view ---- */

static void widen(struct map_box *box, double x, double y, double r)
{
    if (!isfinite(x) || !isfinite(y) || !isfinite(r))
        return;
    box->x0 = fmin(box->x0, x - r);
    box->y0 = fmin(box->y0, y - r);
    box->x1 = fmax(box->x1, x + r);
    box->y1 = fmax(box->y1, y + r);
}

void map_box_add(struct map_box *box, const struct packing *packing)
{
    const struct grains *grains = &packing->grains;
    const struct walls *walls = &packing->walls;
    for (size_t k = 0; k < grains->count; k++)
        widen(box, grains->x[k], grains->y[k], grains->radius[k]);
    for (size_t w = 0; w < walls->count; w++) {
        widen(box, walls->x0[w], walls->y0[w], wall_is_disc(walls, w) ? walls->radius[w] : 0);
        if (!wall_is_disc(walls, w))
            widen(box, walls->x1[w], walls->y1[w], 0);
    }
}

int map_measure(struct map *map)
{
    struct map_box box = MAP_BOX_NONE;
    if (map->box)
        box = *map->box;
    else
        map_box_add(&box, map->packing);
    double across = box.x1 - box.x0, up = box.y1 - box.y0;
    if (!(across > 0) || !(up > 0))
        return error_input("no grain has a place: there is nothing to draw");
    if (!(map->width >= 100))
        map->width = MAP_WIDTH;
    double margin = 0.03 * fmax(across, up);
    map->scale = map->width / (across + 2 * margin);
    map->x0 = box.x0 - margin;
    map->y1 = box.y1 + margin;
    map->margin = map->scale * margin;
    map->view_height = map->scale * (up + 2 * margin);
    map->height = ceil(map->view_height + 0.125 * map->width);
    if (map->height > 20 * map->width)
        return error_input("the packing is more than 20 times as high as wide: it cannot be drawn");
    return 0;
}

static double across(const struct map *map, double x)
{
    return map->scale * (x - map->x0);
}

static double down(const struct map *map, double y)
{
    return map->scale * (map->y1 - y);
}

/* ---- grains and walls ---- */

static int is_drawn(const struct grains *grains, size_t k)
{
    return isfinite(grains->x[k]) && isfinite(grains->y[k]) && isfinite(grains->radius[k]) && grains->radius[k] > 0;
}

static void trace_grain(const struct map *map, cairo_t *cairo, size_t k, double part)
{
    const struct grains *grains = &map->packing->grains;
    cairo_new_path(cairo);
    cairo_arc(cairo, across(map, grains->x[k]), down(map, grains->y[k]), part * map->scale * grains->radius[k], 0,
              FULL_TURN);
}

static void draw_circles(const struct map *map, cairo_t *cairo)
{
    const struct grains *grains = &map->packing->grains;
    cairo_set_line_width(cairo, map->width / 2000);
    for (size_t k = 0; k < grains->count; k++) {
        if (!is_drawn(grains, k))
            continue;
        int rattler = (grains->flags[k] & GRAIN_RATTLER) != 0;
        trace_grain(map, cairo, k, 1);
        cairo_set_source_rgb(cairo, rattler ? 1 : 0.925, rattler ? 1 : 0.925, rattler ? 1 : 0.915);
        cairo_fill_preserve(cairo);
        cairo_set_source_rgb(cairo, COLOUR_GREY);
        cairo_stroke(cairo);
    }
}

/* Rings for what a reader must know before trusting a force. */
static void draw_flags(const struct map *map, cairo_t *cairo)
{
    const struct grains *grains = &map->packing->grains;
    double u = map->width / 1000;
    for (size_t k = 0; k < grains->count; k++) {
        uint32_t flags = grains->flags[k];
        if (!is_drawn(grains, k))
            continue;
        if (flags & GRAIN_RATTLER) {
            const double dashes[] = {3 * u, 3 * u};
            trace_grain(map, cairo, k, 0.8);
            cairo_set_dash(cairo, dashes, 2, 0);
            cairo_set_source_rgb(cairo, COLOUR_GREEN);
            cairo_set_line_width(cairo, 1.2 * u);
            cairo_stroke(cairo);
            cairo_set_dash(cairo, NULL, 0, 0);
        }
        if (flags & (GRAIN_DISTRUST | GRAIN_FLOATING)) {
            trace_grain(map, cairo, k, 0.9);
            if (flags & GRAIN_DISTRUST)
                cairo_set_source_rgb(cairo, COLOUR_PURPLE);
            else
                cairo_set_source_rgb(cairo, COLOUR_ORANGE);
            cairo_set_line_width(cairo, 3 * u);
            cairo_stroke(cairo);
        }
    }
}

static void draw_walls(const struct map *map, cairo_t *cairo)
{
    const struct walls *walls = &map->packing->walls;
    cairo_set_source_rgb(cairo, COLOUR_INK);
    cairo_set_line_cap(cairo, CAIRO_LINE_CAP_ROUND);
    cairo_set_line_width(cairo, 2.5 * map->width / 1000);
    for (size_t w = 0; w < walls->count; w++) {
        double x0 = across(map, walls->x0[w]), y0 = down(map, walls->y0[w]);
        cairo_new_path(cairo);
        if (wall_is_disc(walls, w)) {
            cairo_arc(cairo, x0, y0, map->scale * walls->radius[w], 0, FULL_TURN);
        } else {
            cairo_move_to(cairo, x0, y0);
            cairo_line_to(cairo, across(map, walls->x1[w]), down(map, walls->y1[w]));
        }
        cairo_stroke(cairo);
    }
}

/* ---- forces ---- */

struct line {
    double fn;
    size_t contact;
};

static int by_force(const void *left, const void *right)
{
    const struct line *p = left, *q = right;
    if (p->fn != q->fn)
        return p->fn < q->fn ? -1 : 1;
    return (p->contact > q->contact) - (p->contact < q->contact);
}

static double mean_radius(const struct grains *grains)
{
    double sum = 0;
    size_t count = 0;
    for (size_t k = 0; k < grains->count; k++)
        if (is_drawn(grains, k)) {
            sum += grains->radius[k];
            count++;
        }
    return sum / (double)count;
}

double map_mean_fn(const struct forces *forces)
{
    return forces_mean(forces->contact.fn, forces->contact.count, 1, NULL);
}

double map_unit_fn(const struct map *map)
{
    return map->forces && isnan(map->mean_fn) ? map_mean_fn(map->forces) : map->mean_fn;
}

double map_line_width(const struct map *map, double fn)
{
    double times = fmin(fn / map_unit_fn(map), WIDEST);
    return MEAN_WIDTH * mean_radius(&map->packing->grains) * map->scale * times;
}

size_t map_cut_lines(const struct map *map)
{
    size_t cut = 0;
    double widest = WIDEST * map_unit_fn(map);
    for (size_t c = 0; map->forces && c < map->forces->contact.count; c++)
        cut += isfinite(map->forces->contact.fn[c]) && map->forces->contact.fn[c] > widest;
    return cut;
}

static int slips(const struct forces *forces, size_t c)
{
    if (forces->contact.ft[c] == 0) /* nothing to slip with: a frictionless wall */
        return 0;
    if (forces->contact.status)
        return forces->contact.status[c] == STATUS_SLIP;
    return fabs(forces->contact.ft[c]) >= 0.999 * forces->mu * forces->contact.fn[c];
}

static void stroke_contact(const struct map *map, cairo_t *cairo, size_t c)
{
    size_t i = (size_t)map->packing->contacts.i[c];
    struct vec end = packing_partner(map->packing, c);
    size_t wall;
    int at_wall = packing_is_wall(map->packing, c, &wall);
    if (at_wall && wall_is_disc(&map->packing->walls, wall))
        end = vec(map->packing->contacts.x[c], map->packing->contacts.y[c]);
    cairo_set_line_cap(cairo, at_wall ? CAIRO_LINE_CAP_BUTT : CAIRO_LINE_CAP_ROUND);
    cairo_new_path(cairo);
    cairo_move_to(cairo, across(map, map->packing->grains.x[i]), down(map, map->packing->grains.y[i]));
    cairo_line_to(cairo, across(map, end.x), down(map, end.y));
    cairo_stroke(cairo);
}

static void draw_lines(const struct map *map, cairo_t *cairo, const struct line *lines, size_t count)
{
    double u = map->width / 1000, unit = map_unit_fn(map);
    double widest = map_line_width(map, WIDEST * unit);
    for (int halo = map->photo ? 1 : 0; halo >= 0; halo--)
        for (size_t k = 0; k < count; k++) {
            double width = fmax(widest * fmin(lines[k].fn / (WIDEST * unit), 1), 0.5 * u);
            cairo_set_line_width(cairo, width + halo * 3 * u);
            if (halo)
                cairo_set_source_rgba(cairo, 1, 1, 1, 0.55);
            else if (slips(map->forces, lines[k].contact))
                cairo_set_source_rgb(cairo, COLOUR_VERMILLION);
            else
                cairo_set_source_rgb(cairo, COLOUR_BLUE);
            stroke_contact(map, cairo, lines[k].contact);
        }
}

/* Small forces first, so that chains lie on top. */
static int draw_forces(const struct map *map, cairo_t *cairo)
{
    const struct contact_forces *contact = &map->forces->contact;
    struct line *lines = malloc((contact->count + 1) * sizeof *lines);
    size_t count = 0;
    if (!lines)
        return error_memory("the lines of a map");
    for (size_t c = 0; c < contact->count; c++)
        if (contact->fn[c] > 0 && isfinite(contact->fn[c]))
            lines[count++] = (struct line){contact->fn[c], c};
    qsort(lines, count, sizeof *lines, by_force);
    cairo_save(cairo);
    cairo_rectangle(cairo, map->margin, map->margin, map->width - 2 * map->margin, map->view_height - 2 * map->margin);
    cairo_clip(cairo); /* walls and rims: a wide line may stand out of them */
    draw_lines(map, cairo, lines, count);
    cairo_restore(cairo);
    free(lines);
    return 0;
}

/* Without forces: thin lines, candidates dotted. */
static void draw_contacts(const struct map *map, cairo_t *cairo)
{
    const struct contacts *contacts = &map->packing->contacts;
    double u = map->width / 1000;
    const double dots[] = {2 * u, 3 * u};
    for (size_t c = 0; c < contacts->count; c++) {
        int candidate = (contacts->flags[c] & CONTACT_CANDIDATE) != 0;
        cairo_set_dash(cairo, dots, candidate ? 2 : 0, 0);
        cairo_set_line_width(cairo, candidate ? u : 2 * u);
        cairo_set_source_rgb(cairo, COLOUR_BLUE);
        stroke_contact(map, cairo, c);
    }
    cairo_set_dash(cairo, NULL, 0, 0);
}

/* ---- all of it ---- */

static int draw_background(const struct map *map, cairo_t *cairo)
{
    if (!map->photo) {
        draw_circles(map, cairo);
        return 0;
    }
    struct vec corner = vec(map->x0, map->y1);
    struct vec opposite = vec(map->x0 + map->width / map->scale, map->y1 - map->view_height / map->scale);
    struct vec from = scene_pixels(map->scene, corner), to = scene_pixels(map->scene, opposite);
    struct photo_view view = {from.x, from.y, to.x, to.y};
    if (draw_photo(cairo, map->photo, &view, map->width, map->view_height))
        return -1;
    cairo_set_source_rgba(cairo, 1, 1, 1, 0.35); /* paler, so that the lines stand out */
    cairo_rectangle(cairo, 0, 0, map->width, map->view_height);
    cairo_fill(cairo);
    return 0;
}

int map_draw(const struct map *map, cairo_t *cairo)
{
    cairo_save(cairo);
    cairo_rectangle(cairo, 0, 0, map->width, map->height);
    cairo_clip(cairo);
    int result = draw_background(map, cairo);
    if (result == 0) {
        if (map->forces)
            result = draw_forces(map, cairo);
        else
            draw_contacts(map, cairo);
    }
    if (result == 0) {
        draw_walls(map, cairo);
        draw_flags(map, cairo);
        map_legend(map, cairo);
    }
    cairo_restore(cairo);
    return result;
}
