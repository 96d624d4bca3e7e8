/* Lists by hand: "x y radius" of grains that were missed, "x y" of circles that are none. Lines may be empty or end
 * with a comment after #. A circle that is added is measured like any other from where it was clicked; it is kept even
 * when no edge is found there, and flagged. */
#include "findgrains/corrections.h"

#include "pipeline/speak/error.h"
#include "pipeline/files/input_file.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BY_HAND_SPREAD 0.05 /* of the radius: how well a person clicks */
#define MOST_OUTSIDE 0.5    /* of the radius: how far the centre of a cut grain may lie outside the photo */

/* One correction more; the list doubles when it is full. */
static int add(struct corrections *corrections, struct correction item)
{
    if (corrections->count == corrections->room) {
        size_t room = corrections->room ? 2 * corrections->room : 16;
        struct correction *items = realloc(corrections->items, room * sizeof *items);
        if (!items)
            return error_memory("list of corrections");
        corrections->items = items;
        corrections->room = room;
    }
    corrections->items[corrections->count++] = item;
    return 0;
}

/* Up to three numbers of a line into values; -1: something else stands there. */
static int read_numbers(const char *line, double values[3])
{
    int count = 0;
    for (;;) {
        line += strspn(line, " \t\r\n");
        if (*line == '\0' || *line == '#')
            return count;
        char *end;
        double value = strtod(line, &end);
        if (end == line || count == 3 || !isfinite(value))
            return -1;
        values[count++] = value;
        line = end;
    }
}

static int read_list(const char *path, int columns, const char *format, struct corrections *corrections)
{
    FILE *file = input_file_open(path, INPUT_FILE_TEXT);
    char *line = NULL;
    size_t room = 0;
    int status = 0;
    if (!file)
        return -1;
    for (int number = 1; !status && getline(&line, &room, file) > 0; number++) {
        double values[3] = {0};
        int count = read_numbers(line, values);
        if (count == 0)
            continue;
        if (count != columns || (columns == 3 && !(values[2] > 0)))
            status = error_input("%s:%d: not \"%s\" in px: correct the line", path, number, format);
        else
            status = add(corrections, (struct correction){values[0], values[1], values[2], path, number});
    }
    if (!status && !feof(file))
        status = error_failed("%s: %s", path, strerror(errno));
    free(line);
    fclose(file);
    return status;
}

int corrections_read_added(const char *path, struct corrections *corrections)
{
    return read_list(path, 3, "x y radius", corrections);
}

int corrections_read_removed(const char *path, struct corrections *corrections)
{
    return read_list(path, 2, "x y", corrections);
}

void corrections_free(struct corrections *corrections)
{
    free(corrections->items);
    *corrections = (struct corrections){0};
}

int corrections_check(const struct corrections *corrections, int width, int height)
{
    for (size_t k = 0; corrections && k < corrections->count; k++) {
        const struct correction *item = &corrections->items[k];
        double out_x = fmax(-0.5 - item->x, item->x - (width - 0.5));
        double out_y = fmax(-0.5 - item->y, item->y - (height - 0.5));
        if (item->radius > 0 && fmax(out_x, out_y) > MOST_OUTSIDE * item->radius)
            return error_input("%s:%d: (%g, %g) is outside the photo of %d x %d px: give px of the photo",
                               item->path ? item->path : "correction", item->line, item->x, item->y, width, height);
    }
    return 0;
}

/* Candidates whose circle holds the place, px. */
static int take_away(const struct correction *item, struct candidates *found)
{
    size_t kept = 0;
    for (size_t k = 0; k < found->count; k++) {
        const struct rim *rim = &found->items[k].rim;
        if (hypot(rim->x - item->x, rim->y - item->y) > rim->radius)
            found->items[kept++] = found->items[k];
    }
    if (kept == found->count)
        return error_input("no grain was found at (%g, %g): correct the list of grains to remove (px of the photo)",
                           item->x, item->y);
    found->count = kept;
    return 0;
}

int corrections_apply(const struct corrections *corrections, struct candidates *found)
{
    for (size_t k = 0; corrections && k < corrections->count; k++) {
        const struct correction *item = &corrections->items[k];
        struct candidate grain = {.rim = {.x = item->x, .y = item->y, .radius = item->radius}, .by_hand = 1};
        grain.captured = grain.rim;
        grain.spread = fmax(1, BY_HAND_SPREAD * item->radius);
        if (item->radius > 0 ? candidates_add(found, &grain) : take_away(item, found))
            return -1;
    }
    return 0;
}
