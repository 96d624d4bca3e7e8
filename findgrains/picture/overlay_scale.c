#include "findgrains/picture/overlay_scale.h"

#include "findgrains/picture/overlay.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define LEAST_TEXT 12.0    /* px: letters of the smallest pictures */
#define SIDE_PER_TEXT 90.0 /* longer side of larger ones over the letters: legible when it fills a screen */
#define LETTER 0.6         /* of the letters' size: width of a mean one, rather more */
#define LEAST_WIDTH 26.0   /* of the picture, in sizes of letters: room for the longest part of the caption */
#define NUMBER_SPACING 5.0 /* sizes of letters between two numbers, at least */
#define TICK 0.5           /* length of a tick with a number, in sizes of letters; others half of it */
#define LEAST_NUMBER 9.0   /* px: smaller numbers in circles are not legible */
#define DIGIT 0.65         /* of the letters' size: width of a digit */
#define LINE 1.4           /* from line to line */

/* ---- layout ---- */

/* The smallest of 1, 2, 5 times a power of ten that is not below the value, nor below 1. */
static double round_up(double value)
{
    double power = pow(10, floor(log10(fmax(value, 1)))), digit = value / power;
    return power * (digit <= 1 ? 1 : digit <= 2 ? 2 : digit <= 5 ? 5 : 10);
}

static double count_digits(double number)
{
    return 1 + floor(log10(fmax(number, 1)));
}

void overlay_layout_make(int width, int height, struct overlay_layout *layout)
{
    double side = width > height ? width : height;
    double zoom = fmin(OVERLAY_ZOOM, OVERLAY_SIDE / side);
    *layout = (struct overlay_layout){.zoom = zoom >= 1 ? floor(zoom) : 1 / ceil(1 / zoom)};
    layout->photo_width = (int)fmax(1, width * layout->zoom);
    layout->photo_height = (int)fmax(1, height * layout->zoom);
    layout->text = fmax(LEAST_TEXT, round(side * layout->zoom / SIDE_PER_TEXT));
    layout->step = round_up(NUMBER_SPACING * layout->text / layout->zoom);
    double numbers = 2 * TICK + LETTER * count_digits(height) + 0.5;
    layout->width = (int)fmax(layout->photo_width + ceil(numbers * layout->text), LEAST_WIDTH * layout->text);
    layout->height = layout->photo_height + (int)ceil((2 * TICK + LINE) * layout->text);
}

/* Append a part to the last line, or begin a new one where it would become too long. */
static void __attribute__((format(printf, 2, 3))) put(struct overlay_layout *layout, const char *format, ...)
{
    static const char joint[] = " · ";
    char part[OVERLAY_CAPTION_LENGTH];
    va_list list;
    va_start(list, format);
    vsnprintf(part, sizeof part, format, list);
    va_end(list);
    int last = 0;
    while (last + 1 < OVERLAY_CAPTION_LINES && layout->caption[last + 1][0])
        last++;
    char *line = layout->caption[last];
    size_t length = strlen(line), longer = length + strlen(part) + sizeof joint;
    if (length && LETTER * (double)longer > layout->width / layout->text - 1 && last + 1 < OVERLAY_CAPTION_LINES) {
        line = layout->caption[last + 1];
        length = 0;
    }
    snprintf(line + length, OVERLAY_CAPTION_LENGTH - length, "%s%s", length ? joint : "", part);
}

void overlay_layout_caption(const struct overlay_facts *facts, struct overlay_layout *layout)
{
    memset(layout->caption, 0, sizeof layout->caption);
    put(layout, "%zu grains, %zu flagged (dashed)", facts->grains, facts->flagged);
    if (facts->has_frame)
        put(layout, "yellow: frame");
    if (facts->numbered)
        put(layout, "in the circles: rows of the file");
    put(layout, "ticks: px of the photo");
    if (layout->zoom > 1)
        put(layout, "drawn %g times as large", layout->zoom);
    else if (layout->zoom < 1)
        put(layout, "drawn at 1/%g of its size", round(1 / layout->zoom));
    else
        put(layout, "drawn in its own size");
    int lines = 0;
    while (lines < OVERLAY_CAPTION_LINES && layout->caption[lines][0])
        lines++;
    layout->height = layout->photo_height + (int)ceil((2 * TICK + LINE * (lines + 1) + 0.5) * layout->text);
}

double overlay_number_size(const struct overlay_layout *layout, double radius_px, size_t number)
{
    double radius = radius_px * layout->zoom;
    double size = fmin(fmin(layout->text, 0.6 * radius), 1.5 * radius / (DIGIT * count_digits((double)number)));
    return size >= LEAST_NUMBER ? size : 0;
}

/* ---- drawing ---- */

double overlay_text_width(cairo_t *cairo, double size, const char *text)
{
    cairo_text_extents_t extents;
    cairo_select_font_face(cairo, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cairo, size);
    cairo_text_extents(cairo, text, &extents);
    return extents.x_advance;
}

static void line(cairo_t *cairo, double x, double y, double dx, double dy)
{
    cairo_move_to(cairo, x, y);
    cairo_line_to(cairo, x + dx, y + dy);
    cairo_stroke(cairo);
}

/* A tick at `at` px of the photo on both sides: on the paper, and along the photo's border across, white on dark. */
static void draw_tick(const struct overlay_layout *layout, cairo_t *cairo, int down, double at, double length)
{
    double place = (at + 0.5) * layout->zoom, width = fmax(2, layout->text / 12);
    double dx = down ? length : 0, dy = down ? 0 : length;
    cairo_set_line_width(cairo, 2.5 * width);
    cairo_set_source_rgb(cairo, OVERLAY_INK);
    line(cairo, down ? 0 : place, down ? place : 0, dx, dy);
    cairo_set_line_width(cairo, width);
    line(cairo, down ? layout->photo_width : place, down ? place : layout->photo_height, dx, dy);
    cairo_set_source_rgb(cairo, 1, 1, 1);
    line(cairo, down ? 0 : place, down ? place : 0, dx, dy);
}

static void draw_number(const struct overlay_layout *layout, cairo_t *cairo, int down, double at)
{
    char text[32];
    double place = (at + 0.5) * layout->zoom, em = layout->text;
    snprintf(text, sizeof text, "%.0f", at);
    double width = overlay_text_width(cairo, em, text);
    cairo_set_source_rgb(cairo, OVERLAY_INK);
    if (down)
        cairo_move_to(cairo, layout->photo_width + 1.5 * TICK * em, fmax(0.75 * em, place + 0.36 * em));
    else
        cairo_move_to(cairo, fmax(0, place - 0.5 * width), layout->photo_height + TICK * em + em);
    cairo_show_text(cairo, text);
}

/* Along the lower side, or down the right one: short ticks between two numbers are 10 px, 2 px ... apart. */
static void draw_ticks(const struct overlay_layout *layout, cairo_t *cairo, int down)
{
    double end = (down ? layout->photo_height : layout->photo_width) / layout->zoom;
    int parts = round(layout->step / pow(10, count_digits(layout->step) - 1)) == 2 ? 4 : 5;
    for (int k = 0; k * layout->step / parts < end; k++) {
        double at = k * layout->step / parts;
        draw_tick(layout, cairo, down, at, (k % parts ? 0.5 : 1) * TICK * layout->text);
        if (k % parts == 0)
            draw_number(layout, cairo, down, at);
    }
}

void overlay_layout_draw(const struct overlay_layout *layout, cairo_t *cairo)
{
    double em = layout->text, top = layout->photo_height + (2 * TICK + LINE) * em;
    cairo_set_source_rgb(cairo, 1, 1, 1);
    cairo_rectangle(cairo, layout->photo_width, 0, layout->width, layout->height);
    cairo_rectangle(cairo, 0, layout->photo_height, layout->photo_width, layout->height);
    cairo_fill(cairo);
    cairo_set_dash(cairo, NULL, 0, 0);
    draw_ticks(layout, cairo, 0);
    draw_ticks(layout, cairo, 1);
    cairo_set_source_rgb(cairo, OVERLAY_INK);
    for (int k = 0; k < OVERLAY_CAPTION_LINES && layout->caption[k][0]; k++) {
        double room = layout->width - em, wide = overlay_text_width(cairo, em, layout->caption[k]);
        if (wide > room)
            cairo_set_font_size(cairo, em * room / wide);
        cairo_move_to(cairo, 0.5 * em, top + (1 + LINE * k) * em);
        cairo_show_text(cairo, layout->caption[k]);
    }
}
