/* The legend of a force map: what state this is, how wide which force, which colour means what, how long is what. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "pipeline/packing/structure.h"
#include "pipeline/draw/axis.h"
#include "pipeline/draw/legend.h"
#include "report/pictures/force_map.h"

/* Name, grains, contacts and z, state and method: four rows. u is a thousandth of the width: all lengths are in it. */
static void legend_title(const struct force_map *map, struct canvas *canvas, double x, double y, double u)
{
    const double width = (map->forces ? 340 : 575) * u;
    char text[200], force[64] = "";
    const struct state_info *info = &map->packing->info;
    struct fabric fabric;
    words_within(canvas, x, y + 22 * u, width, 19 * u, 1, map->title ? map->title : "");
    packing_fabric(map->packing, NAN, &fabric);
    snprintf(text, sizeof text, "%zu grains, %zu rattlers", map->packing->grains.count, fabric.rattlers);
    words_within(canvas, x, y + 46 * u, width, 15 * u, 0, text);
    snprintf(text, sizeof text, "%zu contacts, z = %.2f", fabric.contacts, fabric.z);
    words_within(canvas, x, y + 68 * u, width, 15 * u, 0, text);
    if (map->forces)
        snprintf(force, sizeof force, "   %.15s from %.15s", map->forces->method,
                 map->forces->start[0] ? map->forces->start : "?");
    if (info->index >= 0 && isfinite(info->time_s))
        snprintf(text, sizeof text, "state %lld, %g s%s", (long long)info->index, info->time_s, force);
    else if (info->index >= 0)
        snprintf(text, sizeof text, "state %lld%s", (long long)info->index, force);
    else
        snprintf(text, sizeof text, "%s", force);
    words_within(canvas, x, y + 90 * u, width, 15 * u, 0, text);
}

/* What the widths do not say: <fn> of this state where another one is the unit, and lines that were cut. */
static void legend_notes(const struct force_map *map, struct canvas *canvas, double x, double y, double u)
{
    char text[100] = "";
    size_t cut = force_map_cut_lines(map), used = 0;
    double here = force_map_mean_fn(map->forces);
    if (fabs(here / force_map_unit_fn(map) - 1) > 1e-9)
        used = (size_t)snprintf(text, sizeof text, "in this state %.4g N%s", here, cut ? ";  " : "");
    if (cut)
        snprintf(text + used, sizeof text - used, "8⟨fn⟩ and more: %zu", cut);
    words_within(canvas, x, y, 232 * u, 14 * u, 0, text);
}

/* One, two and four units of force as wide as they are on the map. */
static void legend_widths(const struct force_map *map, struct canvas *canvas, double x, double y, double u)
{
    static const double times[] = {1, 2, 4};
    static const char *const names[] = {"⟨fn⟩", "2⟨fn⟩", "4⟨fn⟩"};
    char text[100];
    for (int k = 0; k < 3; k++) {
        double left = x + 75 * u * k, width = force_map_line_width(map, times[k] * force_map_unit_fn(map));
        pen_segment(canvas, &(struct pen){COLOUR_BLUE, .width = width}, left, y + 22 * u, left + 55 * u, y + 22 * u);
        words_draw(canvas, left + 27 * u, y + 55 * u, 0.5, 15 * u, 0, names[k]);
    }
    snprintf(text, sizeof text, "⟨fn⟩ = %.4g N", force_map_unit_fn(map));
    words_draw(canvas, x, y + 80 * u, 0, 15 * u, 1, text);
    legend_notes(map, canvas, x, y + 101 * u, u);
}

/* In two columns: lines, then rings. Without forces every line is a contact. */
static void legend_key(const struct force_map *map, struct canvas *canvas, double x, double y, double u)
{
    const struct legend_entry entries[] = {
        {LEGEND_LINE, {COLOUR_BLUE, .width = 6 * u}, .text = "sticking contact"},
        {LEGEND_LINE, {COLOUR_VERMILLION, .width = 6 * u}, .text = "slipping contact"},
        {LEGEND_RING, {COLOUR_PURPLE, .width = 3 * u}, .text = "do not trust"},
        {LEGEND_RING, {COLOUR_ORANGE, .width = 3 * u}, .text = "floating"},
        {LEGEND_RING, {COLOUR_GREEN, .width = 1.2 * u, .dash = {3 * u, 3 * u}}, .text = "rattler"}};
    for (int k = map->forces ? 0 : 1; k < 5; k++) {
        struct legend_entry entry = entries[k];
        int row = k < 2 ? k : k - 2;
        if (k == 1 && !map->forces) {
            entry.pen.colour = COLOUR_BLUE;
            entry.text = "contact";
        }
        entry.length = 22 * u, entry.gap = 8 * u, entry.size = 14 * u;
        legend_draw(canvas, &entry, x + (k < 2 ? 0 : 150 * u), y + (14 + 22 * row) * u, 5 * u);
    }
}

/* A round length of some 9 % of the width, at most. */
static void legend_bar(const struct force_map *map, struct canvas *canvas, double right, double y, double u)
{
    double length = axis_round_down(0.09 * map->width / map->scale), pixels = length * map->scale;
    char text[32];
    if (length >= 1)
        snprintf(text, sizeof text, "%g m", length);
    else
        snprintf(text, sizeof text, "%g mm", 1000 * length);
    legend_scale(canvas, right, y + 22 * u, pixels, 4 * u, 26 * u, 15 * u, text);
}

/* A picture of forces that are void must not pass for a result, wherever it is copied to. */
static void legend_void(const struct force_map *map, struct canvas *canvas, double u)
{
    char text[200];
    const char *reasons = map->forces->reasons;
    snprintf(text, sizeof text, "%.*s", (int)strcspn(reasons, ";:"), reasons); /* the first one, without its remedy */
    pen_rectangle(canvas, &(struct pen){.colour = COLOUR_VERMILLION}, 0, 0, map->width, 58 * u);
    words_within(canvas, 12 * u, 24 * u, 976 * u, 20 * u, 1,
                 "NOT IN EQUILIBRIUM: these are not the forces of this packing");
    words_within(canvas, 12 * u, 48 * u, 976 * u, 17 * u, 0, text);
}

void force_map_legend(const struct force_map *map, struct canvas *canvas)
{
    double u = map->width / 1000, top = map->view_height + 12 * u;
    pen_rectangle(canvas, &(struct pen){.colour = COLOUR_WHITE}, 0, map->view_height, map->width,
                  map->height - map->view_height);
    legend_title(map, canvas, 25 * u, top, u);
    if (map->forces && force_map_unit_fn(map) > 0)
        legend_widths(map, canvas, 385 * u, top, u);
    legend_key(map, canvas, 622 * u, top, u);
    legend_bar(map, canvas, 975 * u, top, u);
    if (map->forces && map->forces->verdict == VERDICT_VOID)
        legend_void(map, canvas, u);
}
