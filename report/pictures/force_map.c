/* The width of a line is in proportion to the normal force, w = 0.22 r fn / <fn>, r being the mean radius of the grains
 * and <fn> the mean over loaded contacts of this state or of all that are compared: chains stand out as they do in
 * photoelastic pictures. From 8 <fn> on lines are as wide as there; the legend says how many those are. The map lies in
 * metres with y upwards, the picture in px with y downwards: across() and down() lead from one to the other. */
#include "report/pictures/force_map.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/draw/pen.h"
#include "pipeline/draw/photo_background.h"

/* Of the mean radius: the width of the line of a mean force. */
static const double MEAN_WIDTH = 0.22;
/* Of the unit: from here on all lines are as wide, so that one absurd force does not cover the others. */
static const double WIDEST = 8;

/* ---- the view ----
 *
 * A margin of 3 % of the longer side lies around the box that is shown; below the view is room for the legend, an
 * eighth of the width. A packing that is more than 20 times as high as wide would be a thread. */

/* By a circle; one without a place or a size is left out. */
static void widen(struct force_map_box *box, double x, double y, double r)
{
    if (!isfinite(x) || !isfinite(y) || !isfinite(r))
        return;
    box->x0 = fmin(box->x0, x - r);
    box->y0 = fmin(box->y0, y - r);
    box->x1 = fmax(box->x1, x + r);
    box->y1 = fmax(box->y1, y + r);
}

void force_map_box_add(struct force_map_box *box, const struct packing *packing)
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

int force_map_measure(struct force_map *map)
{
    struct force_map_box box = FORCE_MAP_BOX_NONE;
    if (map->box)
        box = *map->box;
    else
        force_map_box_add(&box, map->packing);
    double across = box.x1 - box.x0, up = box.y1 - box.y0;
    if (!(across > 0) || !(up > 0))
        return error_input("no grain has a place: there is nothing to draw");
    if (!(map->width >= 100))
        map->width = FORCE_MAP_WIDTH;
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

/* px of a place in m. */
static double across(const struct force_map *map, double x)
{
    return map->scale * (x - map->x0);
}

/* From metres upwards to the picture's ordinate, which goes down. */
static double down(const struct force_map *map, double y)
{
    return map->scale * (map->y1 - y);
}

/* ---- grains and walls ---- */

/* Has the grain a place and a size? Those that were lost have none. */
static int is_drawn(const struct grains *grains, size_t k)
{
    return isfinite(grains->x[k]) && isfinite(grains->y[k]) && isfinite(grains->radius[k]) && grains->radius[k] > 0;
}

/* A circle of `part` of the grain's radius. */
static void draw_grain(const struct force_map *map, struct canvas *canvas, const struct pen *pen, size_t k, double part)
{
    const struct grains *grains = &map->packing->grains;
    pen_circle(canvas, pen, across(map, grains->x[k]), down(map, grains->y[k]), part * map->scale * grains->radius[k]);
}

/* Grains as discs: grey when they bear forces, white when they are rattlers. */
static void draw_circles(const struct force_map *map, struct canvas *canvas)
{
    const struct grains *grains = &map->packing->grains;
    const struct pen face = {.colour = COLOUR_GRAIN}, idle = {.colour = COLOUR_WHITE},
                     rim = {COLOUR_GREY, .width = map->width / 2000};
    for (size_t k = 0; k < grains->count; k++)
        if (is_drawn(grains, k)) {
            draw_grain(map, canvas, grains->flags[k] & GRAIN_RATTLER ? &idle : &face, k, 1);
            draw_grain(map, canvas, &rim, k, 1);
        }
}

/* Rings for what a reader must know before trusting a force. */
static void draw_flags(const struct force_map *map, struct canvas *canvas)
{
    const struct grains *grains = &map->packing->grains;
    double u = map->width / 1000;
    const struct pen rattler = {COLOUR_GREEN, .width = 1.2 * u, .dash = {3 * u, 3 * u}, .round_ends = 1};
    const struct pen distrust = {COLOUR_PURPLE, .width = 3 * u, .round_ends = 1};
    const struct pen floating = {COLOUR_ORANGE, .width = 3 * u, .round_ends = 1};
    for (size_t k = 0; k < grains->count; k++) {
        uint32_t flags = grains->flags[k];
        if (!is_drawn(grains, k))
            continue;
        if (flags & GRAIN_RATTLER)
            draw_grain(map, canvas, &rattler, k, 0.8);
        if (flags & (GRAIN_DISTRUST | GRAIN_FLOATING))
            draw_grain(map, canvas, flags & GRAIN_DISTRUST ? &distrust : &floating, k, 0.9);
    }
}

/* Straight walls as lines, corner discs as circles. */
static void draw_walls(const struct force_map *map, struct canvas *canvas)
{
    const struct walls *walls = &map->packing->walls;
    const struct pen pen = {COLOUR_INK, .width = 2.5 * map->width / 1000, .round_ends = 1};
    for (size_t w = 0; w < walls->count; w++) {
        double x0 = across(map, walls->x0[w]), y0 = down(map, walls->y0[w]);
        if (wall_is_disc(walls, w))
            pen_circle(canvas, &pen, x0, y0, map->scale * walls->radius[w]);
        else
            pen_segment(canvas, &pen, x0, y0, across(map, walls->x1[w]), down(map, walls->y1[w]));
    }
}

/* ---- forces ---- */

struct line {
    double fn;
    size_t contact;
};

/* Ties by number, so that the picture does not depend on the sort. */
static int by_force(const void *left, const void *right)
{
    const struct line *p = left, *q = right;
    if (p->fn != q->fn)
        return p->fn < q->fn ? -1 : 1;
    return (p->contact > q->contact) - (p->contact < q->contact);
}

/* m; NaN without grains. */
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

double force_map_mean_fn(const struct forces *forces)
{
    return forces_mean(forces->contact.fn, forces->contact.count, 1, NULL);
}

double force_map_unit_fn(const struct force_map *map)
{
    return map->forces && isnan(map->mean_fn) ? force_map_mean_fn(map->forces) : map->mean_fn;
}

double force_map_line_width(const struct force_map *map, double fn)
{
    double times = fmin(fn / force_map_unit_fn(map), WIDEST);
    return MEAN_WIDTH * mean_radius(&map->packing->grains) * map->scale * times;
}

size_t force_map_cut_lines(const struct force_map *map)
{
    size_t cut = 0;
    double widest = WIDEST * force_map_unit_fn(map);
    for (size_t c = 0; map->forces && c < map->forces->contact.count; c++)
        cut += isfinite(map->forces->contact.fn[c]) && map->forces->contact.fn[c] > widest;
    return cut;
}

/* As the file says; without a status, where the tangential force is the limit mu fn but for 0.1 %. */
static int slips(const struct forces *forces, size_t c)
{
    if (forces->contact.ft[c] == 0) /* nothing to slip with: a frictionless wall */
        return 0;
    if (forces->contact.status)
        return forces->contact.status[c] == STATUS_SLIP;
    return fabs(forces->contact.ft[c]) >= 0.999 * forces->mu * forces->contact.fn[c];
}

/* From centre to centre, or to the wall. */
static void draw_contact(const struct force_map *map, struct canvas *canvas, struct pen pen, size_t c)
{
    size_t i = (size_t)map->packing->contacts.i[c];
    struct vec end = packing_partner(map->packing, c);
    size_t wall;
    int at_wall = packing_is_wall(map->packing, c, &wall);
    if (at_wall && wall_is_disc(&map->packing->walls, wall))
        end = vec(map->packing->contacts.x[c], map->packing->contacts.y[c]);
    pen.round_ends = !at_wall; /* a wide round end would stand out of the wall */
    pen_segment(canvas, &pen, across(map, map->packing->grains.x[i]), down(map, map->packing->grains.y[i]),
                across(map, end.x), down(map, end.y));
}

/* Over a photo on a pale halo, which is drawn below all lines. */
static void draw_lines(const struct force_map *map, struct canvas *canvas, const struct line *lines, size_t count)
{
    double u = map->width / 1000, unit = force_map_unit_fn(map);
    double widest = force_map_line_width(map, WIDEST * unit);
    for (int halo = map->photo ? 1 : 0; halo >= 0; halo--)
        for (size_t k = 0; k < count; k++) {
            double width = fmax(widest * fmin(lines[k].fn / (WIDEST * unit), 1), 0.5 * u);
            struct pen pen = {COLOUR_BLUE, .width = width + halo * 3 * u};
            if (halo)
                pen.colour = COLOUR_WHITE, pen.clear = 0.45;
            else if (slips(map->forces, lines[k].contact))
                pen.colour = COLOUR_VERMILLION;
            draw_contact(map, canvas, pen, lines[k].contact);
        }
}

/* Small forces first, so that chains lie on top; contacts without a force, or with one that is not finite, are left
 * out. */
static int draw_forces(const struct force_map *map, struct canvas *canvas)
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
    /* Walls and rims: a wide line may stand out of them. */
    canvas_clip(canvas, map->margin, map->margin, map->width - 2 * map->margin, map->view_height - 2 * map->margin);
    draw_lines(map, canvas, lines, count);
    canvas_restore(canvas);
    free(lines);
    return 0;
}

/* Without forces: thin lines, candidates dotted. */
static void draw_contacts(const struct force_map *map, struct canvas *canvas)
{
    const struct contacts *contacts = &map->packing->contacts;
    double u = map->width / 1000;
    const struct pen line = {COLOUR_BLUE, .width = 2 * u}, dotted = {COLOUR_BLUE, .width = u, .dash = {2 * u, 3 * u}};
    for (size_t c = 0; c < contacts->count; c++)
        draw_contact(map, canvas, contacts->flags[c] & CONTACT_CANDIDATE ? dotted : line, c);
}

/* ---- all of it ---- */

/* Discs, or the photo with the part that the map shows, under a white veil. */
static int draw_background(const struct force_map *map, struct canvas *canvas)
{
    if (!map->photo) {
        draw_circles(map, canvas);
        return 0;
    }
    struct vec corner = vec(map->x0, map->y1);
    struct vec opposite = vec(map->x0 + map->width / map->scale, map->y1 - map->view_height / map->scale);
    struct vec from = scene_pixels(map->scene, corner), to = scene_pixels(map->scene, opposite);
    struct photo_view view = {from.x, from.y, to.x, to.y};
    if (photo_background(canvas, map->photo, &view, map->width, map->view_height))
        return -1;
    /* paler, so that the lines stand out */
    pen_rectangle(canvas, &(struct pen){COLOUR_WHITE, .clear = 0.65}, 0, 0, map->width, map->view_height);
    return 0;
}

int force_map_draw(const struct force_map *map, struct canvas *canvas)
{
    canvas_clip(canvas, 0, 0, map->width, map->height);
    int result = draw_background(map, canvas);
    if (result == 0) {
        if (map->forces)
            result = draw_forces(map, canvas);
        else
            draw_contacts(map, canvas);
    }
    if (result == 0) {
        draw_walls(map, canvas);
        draw_flags(map, canvas);
        force_map_legend(map, canvas);
    }
    canvas_restore(canvas);
    return result;
}

int force_map_write(struct force_map *map, const char *path)
{
    struct canvas canvas;
    if (force_map_measure(map) || canvas_begin(&canvas, path, map->width, map->height))
        return -1;
    return canvas_end(&canvas, force_map_draw(map, &canvas));
}
