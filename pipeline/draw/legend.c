/* A ring of 7 px in a sample of 22 px leaves room for its line, up to 3 px wide, at the height of a row of words. */
#include "pipeline/draw/legend.h"

void legend_sample(struct canvas *canvas, const struct legend_entry *entry, double x, double y)
{
    double length = entry->length;
    if (entry->sample == LEGEND_RING)
        pen_circle(canvas, &entry->pen, x + 0.5 * length, y, length * 7 / 22);
    else if (entry->sample == LEGEND_PATCH)
        pen_rectangle(canvas, &entry->pen, x, y - 5, length, 10);
    else
        pen_segment(canvas, &entry->pen, x, y, x + length, y);
}

void legend_draw(struct canvas *canvas, const struct legend_entry *entry, double x, double y, double drop)
{
    legend_sample(canvas, entry, x, y);
    words_draw(canvas, x + entry->length + entry->gap, y + drop, 0, entry->size, 0, entry->text);
}

void legend_scale(struct canvas *canvas, double right, double y, double length, double width, double drop, double size,
                  const char *text)
{
    pen_segment(canvas, &(struct pen){COLOUR_INK, .width = width}, right - length, y, right, y);
    words_draw(canvas, right - 0.5 * length, y + drop, 0.5, size, 0, text);
}
