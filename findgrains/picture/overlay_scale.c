/* The zoom is a whole number, or one over one, so that a place can be read off; letters grow with the picture, which is
 * looked at as a whole. Right of the photo is room for a tick, a gap and the longest number; below it for ticks,
 * numbers, and the lines of the caption. */
#include "findgrains/picture/overlay_scale.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "pipeline/draw/axis.h"

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

/* Of a whole number in decimals. */
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
    layout->step = axis_round_up(fmax(1, NUMBER_SPACING * layout->text / layout->zoom));
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

/* Parts that say nothing of this photo are left out. */
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

/* As large as fits the circle: 0.6 of the radius high, 1.5 radii wide. */
double overlay_number_size(const struct overlay_layout *layout, double radius_px, size_t number)
{
    double radius = radius_px * layout->zoom;
    double size = fmin(fmin(layout->text, 0.6 * radius), 1.5 * radius / (DIGIT * count_digits((double)number)));
    return size >= LEAST_NUMBER ? size : 0;
}

/* ---- drawing ---- */

/* A tick at `at` px of the photo on both sides: on the paper, and along the photo's border across, white on dark. */
static void draw_tick(const struct overlay_layout *layout, struct canvas *canvas, int down, double at, double length)
{
    double place = (at + 0.5) * layout->zoom, width = fmax(2, layout->text / 12);
    double dx = down ? length : 0, dy = down ? 0 : length, x = down ? 0 : place, y = down ? place : 0;
    double far_x = down ? layout->photo_width : place, far_y = down ? place : layout->photo_height;
    const struct pen dark = {COLOUR_INK, .width = 2.5 * width, .round_joins = 1};
    const struct pen tick = {COLOUR_INK, .width = width, .round_joins = 1};
    const struct pen white = {COLOUR_WHITE, .width = width, .round_joins = 1};
    pen_segment(canvas, &dark, x, y, x + dx, y + dy);
    pen_segment(canvas, &tick, far_x, far_y, far_x + dx, far_y + dy);
    pen_segment(canvas, &white, x, y, x + dx, y + dy);
}

/* Centred below its tick, or to the right of it; not outside the picture. */
static void draw_number(const struct overlay_layout *layout, struct canvas *canvas, int down, double at)
{
    char text[32];
    double place = (at + 0.5) * layout->zoom, em = layout->text;
    snprintf(text, sizeof text, "%.0f", at);
    if (down)
        words_draw(canvas, layout->photo_width + 1.5 * TICK * em, fmax(0.75 * em, place + 0.36 * em), 0, em, 0, text);
    else
        words_draw(canvas, fmax(0, place - 0.5 * words_width(canvas, em, 0, text)),
                   layout->photo_height + TICK * em + em, 0, em, 0, text);
}

/* Along the lower side, or down the right one: short ticks between two numbers are 10 px, 2 px ... apart. */
static void draw_ticks(const struct overlay_layout *layout, struct canvas *canvas, int down)
{
    double end = (down ? layout->photo_height : layout->photo_width) / layout->zoom;
    int parts = round(layout->step / pow(10, count_digits(layout->step) - 1)) == 2 ? 4 : 5;
    for (int k = 0; k * layout->step / parts < end; k++) {
        double at = k * layout->step / parts;
        draw_tick(layout, canvas, down, at, (k % parts ? 0.5 : 1) * TICK * layout->text);
        if (k % parts == 0)
            draw_number(layout, canvas, down, at);
    }
}

void overlay_layout_draw(const struct overlay_layout *layout, struct canvas *canvas)
{
    double em = layout->text, top = layout->photo_height + (2 * TICK + LINE) * em;
    const struct pen paper = {.colour = COLOUR_WHITE};
    pen_rectangle(canvas, &paper, layout->photo_width, 0, layout->width, layout->height);
    pen_rectangle(canvas, &paper, 0, layout->photo_height, layout->photo_width, layout->height);
    draw_ticks(layout, canvas, 0);
    draw_ticks(layout, canvas, 1);
    for (int k = 0; k < OVERLAY_CAPTION_LINES && layout->caption[k][0]; k++)
        words_within(canvas, 0.5 * em, top + (1 + LINE * k) * em, layout->width - em, em, 0, layout->caption[k]);
}
