/* The legend of a force map: what state this is, how wide which force, which colour means what, how long is what. */
#include <math.h>
#include <stdio.h>

#include "pipeline/packing/structure.h"
#include "pipeline/draw/canvas.h"
#include "report/pictures/force_map.h"

static void legend_title(const struct map *map, cairo_t *cairo, double x, double y, double u)
{
    const double width = (map->forces ? 340 : 575) * u;
    char text[200], force[64] = "";
    const struct state_info *info = &map->packing->info;
    struct fabric fabric;
    cairo_set_source_rgb(cairo, COLOUR_INK);
    canvas_text_within(cairo, x, y + 22 * u, width, 19 * u, 1, map->title ? map->title : "");
    packing_fabric(map->packing, NAN, &fabric);
    snprintf(text, sizeof text, "%zu grains, %zu rattlers", map->packing->grains.count, fabric.rattlers);
    canvas_text_within(cairo, x, y + 46 * u, width, 15 * u, 0, text);
    snprintf(text, sizeof text, "%zu contacts, z = %.2f", fabric.contacts, fabric.z);
    canvas_text_within(cairo, x, y + 68 * u, width, 15 * u, 0, text);
    if (map->forces)
        snprintf(force, sizeof force, "   %.15s from %.15s", map->forces->method,
                 map->forces->start[0] ? map->forces->start : "?");
    if (info->index >= 0 && isfinite(info->time_s))
        snprintf(text, sizeof text, "state %lld, %g s%s", (long long)info->index, info->time_s, force);
    else if (info->index >= 0)
        snprintf(text, sizeof text, "state %lld%s", (long long)info->index, force);
    else
        snprintf(text, sizeof text, "%s", force);
    canvas_text_within(cairo, x, y + 90 * u, width, 15 * u, 0, text);
}

/* What the widths do not say: <fn> of this state where another one is the unit, and lines that were cut. */
static void legend_notes(const struct map *map, cairo_t *cairo, double x, double y, double u)
{
    char text[100] = "";
    size_t cut = map_cut_lines(map), used = 0;
    double here = map_mean_fn(map->forces);
    if (fabs(here / map_unit_fn(map) - 1) > 1e-9)
        used = (size_t)snprintf(text, sizeof text, "in this state %.4g N%s", here, cut ? ";  " : "");
    if (cut)
        snprintf(text + used, sizeof text - used, "8⟨fn⟩ and more: %zu", cut);
    canvas_text_within(cairo, x, y, 232 * u, 14 * u, 0, text);
}

static void legend_widths(const struct map *map, cairo_t *cairo, double x, double y, double u)
{
    static const double times[] = {1, 2, 4};
    static const char *const names[] = {"⟨fn⟩", "2⟨fn⟩", "4⟨fn⟩"};
    char text[100];
    cairo_set_line_cap(cairo, CAIRO_LINE_CAP_BUTT);
    for (int k = 0; k < 3; k++) {
        double left = x + 75 * u * k;
        cairo_set_line_width(cairo, map_line_width(map, times[k] * map_unit_fn(map)));
        cairo_set_source_rgb(cairo, COLOUR_BLUE);
        cairo_move_to(cairo, left, y + 22 * u);
        cairo_line_to(cairo, left + 55 * u, y + 22 * u);
        cairo_stroke(cairo);
        cairo_set_source_rgb(cairo, COLOUR_INK);
        canvas_text(cairo, left + 27 * u, y + 55 * u, 0.5, 15 * u, 0, names[k]);
    }
    snprintf(text, sizeof text, "⟨fn⟩ = %.4g N", map_unit_fn(map));
    canvas_text(cairo, x, y + 80 * u, 0, 15 * u, 1, text);
    legend_notes(map, cairo, x, y + 101 * u, u);
}

struct key_entry {
    double red, green, blue;
    int ring;
    const char *text;
};

static void legend_key(const struct map *map, cairo_t *cairo, double x, double y, double u)
{
    static const struct key_entry entries[] = {{COLOUR_BLUE, 0, "sticking contact"},
                                               {COLOUR_VERMILLION, 0, "slipping contact"},
                                               {COLOUR_PURPLE, 1, "do not trust"},
                                               {COLOUR_ORANGE, 1, "floating"},
                                               {COLOUR_GREEN, 2, "rattler"}};
    const double dashes[] = {3 * u, 3 * u};
    for (int k = map->forces ? 0 : 1; k < 5; k++) {
        const struct key_entry *entry = &entries[k];
        double left = x + (k < 2 ? 0 : 150 * u), top = y + (k < 2 ? 14 + 22 * k : 14 + 22 * (k - 2)) * u;
        cairo_set_source_rgb(cairo, entry->red, entry->green, entry->blue);
        cairo_new_path(cairo);
        cairo_set_line_width(cairo, (entry->ring == 2 ? 1.2 : entry->ring ? 3 : 6) * u);
        cairo_set_dash(cairo, dashes, entry->ring == 2 ? 2 : 0, 0);
        if (entry->ring)
            cairo_arc(cairo, left + 11 * u, top, 7 * u, 0, 2 * M_PI);
        else
            cairo_move_to(cairo, left, top), cairo_line_to(cairo, left + 22 * u, top);
        cairo_stroke(cairo);
        cairo_set_dash(cairo, NULL, 0, 0);
        cairo_set_source_rgb(cairo, COLOUR_INK);
        if (k > 0 || map->forces)
            canvas_text(cairo, left + 30 * u, top + 5 * u, 0, 14 * u, 0,
                        map->forces || k != 1 ? entry->text : "contact");
    }
}

static void legend_bar(const struct map *map, cairo_t *cairo, double right, double y, double u)
{
    double length = canvas_round_number(0.09 * map->width / map->scale), pixels = length * map->scale;
    char text[32];
    if (length >= 1)
        snprintf(text, sizeof text, "%g m", length);
    else
        snprintf(text, sizeof text, "%g mm", 1000 * length);
    cairo_set_source_rgb(cairo, COLOUR_INK);
    cairo_set_line_width(cairo, 4 * u);
    cairo_set_line_cap(cairo, CAIRO_LINE_CAP_BUTT);
    cairo_move_to(cairo, right - pixels, y + 22 * u);
    cairo_line_to(cairo, right, y + 22 * u);
    cairo_stroke(cairo);
    canvas_text(cairo, right - 0.5 * pixels, y + 48 * u, 0.5, 15 * u, 0, text);
}

void map_legend(const struct map *map, cairo_t *cairo)
{
    double u = map->width / 1000, top = map->view_height + 12 * u;
    cairo_set_source_rgb(cairo, 1, 1, 1);
    cairo_rectangle(cairo, 0, map->view_height, map->width, map->height - map->view_height);
    cairo_fill(cairo);
    legend_title(map, cairo, 25 * u, top, u);
    if (map->forces && map_unit_fn(map) > 0)
        legend_widths(map, cairo, 385 * u, top, u);
    legend_key(map, cairo, 622 * u, top, u);
    legend_bar(map, cairo, 975 * u, top, u);
}
