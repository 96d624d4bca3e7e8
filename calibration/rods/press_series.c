/* Deflection = scale (l_0 - l), l the distance of the two middles, l_0 that of the first photo that shows both. Its
 * error is that of the middles projected on the line between them. Forces are interpolated between the two rows of the
 * record around the photo's time. */
#include "calibration/rods/press_series.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/files/input_file.h"
#include "pipeline/files/number.h"
#include "pipeline/state/state.h"

/* ---- the force record ---- */

void force_record_free(struct force_record *record)
{
    free(record->at);
    free(record->force);
    memset(record, 0, sizeof *record);
}

static int record_add(struct force_record *record, size_t *room, double at, double force)
{
    if (record->count == *room) {
        *room = *room ? 2 * *room : 256;
        double *moved = realloc(record->at, *room * sizeof *moved);
        if (moved)
            record->at = moved;
        double *forces = moved ? realloc(record->force, *room * sizeof *forces) : NULL;
        if (!forces)
            return error_memory("force record");
        record->force = forces;
    }
    record->at[record->count] = at;
    record->force[record->count++] = force;
    return 0;
}

static int parse_row(char *line, const char *path, long number, struct force_record *record, size_t *room)
{
    double at, force;
    char *comma = strchr(line, ',');
    if (comma)
        *comma = 0;
    if (!comma || number_parse(line, &at) || number_parse(comma + 1, &force))
        return error_input("%s:%ld: write two numbers, %s,force_N", path, number,
                           record->by_index ? "index" : "time_s");
    if (record->count && at <= record->at[record->count - 1])
        return error_input("%s:%ld: %g comes after %g: sort the rows, each time once", path, number, at,
                           record->at[record->count - 1]);
    return record_add(record, room, at, force);
}

static int parse_file(FILE *file, const char *path, struct force_record *record)
{
    char *line = NULL;
    size_t size = 0, room = 0;
    int status = 0;
    for (long number = 1; !status && getline(&line, &size, file) > 0; number++) {
        line[strcspn(line, "\r\n")] = 0;
        if (number == 1) {
            record->by_index = !strcmp(line, "index,force_N");
            if (!record->by_index && strcmp(line, "time_s,force_N"))
                status = error_input("%s:1: the header is time_s,force_N or index,force_N", path);
        } else if (*line) {
            status = parse_row(line, path, number, record, &room);
        }
    }
    free(line);
    if (!status && !feof(file)) /* a failing disk, or memory gone */
        return error_failed("%s: %s", path, strerror(errno));
    if (!status && record->count < 2)
        return error_input("%s: %zu row%s: a record needs two or more", path, record->count,
                           record->count == 1 ? "" : "s");
    return status;
}

int force_record_read(const char *path, struct force_record *record)
{
    memset(record, 0, sizeof *record);
    FILE *file = input_file_open(path, INPUT_FILE_TEXT);
    if (!file)
        return -1;
    int status = parse_file(file, path, record);
    fclose(file);
    if (status)
        force_record_free(record);
    return status;
}

double force_record_at(const struct force_record *record, double at)
{
    size_t low = 0, high = record->count - 1;
    if (!(at >= record->at[low] && at <= record->at[high]))
        return NAN;
    while (high - low > 1) {
        size_t middle = (low + high) / 2;
        if (record->at[middle] <= at)
            low = middle;
        else
            high = middle;
    }
    double share = (at - record->at[low]) / (record->at[high] - record->at[low]);
    return record->force[low] + share * (record->force[high] - record->force[low]);
}

/* ---- the photos ---- */

void press_photo_free(struct press_photo *photo)
{
    table_free(&PHOTO_GRAINS, &photo->grains);
}

int press_photo_read(const char *path, struct press_photo *photo)
{
    static const char *const needed[] = {"x_px", "y_px", NULL};
    struct state_info info = {0};
    memset(photo, 0, sizeof *photo);
    struct state *state = state_open(path);
    int status =
        !state || state_read_info(state, &info) || state_read(state, "grains", &PHOTO_GRAINS, needed, &photo->grains)
            ? -1
            : 0;
    photo->index = info.index;
    photo->time = info.time_s;
    state_info_free(&info);
    state_close(state);
    return status;
}

/* Distance of the two middles and its standard error, px; -1: one of them is not to be trusted. */
static int branch_length(const struct photo_grains *grains, const long rods[2], double *length, double *s)
{
    size_t a = (size_t)rods[0], b = (size_t)rods[1];
    double dx = grains->x_px[b] - grains->x_px[a], dy = grains->y_px[b] - grains->y_px[a];
    *length = hypot(dx, dy);
    double nx = dx / *length, ny = dy / *length, variance = 0;
    for (int e = 0; e < 2; e++) {
        double sx = nx * column_or_zero(grains->s_x, (size_t)rods[e]);
        double sy = ny * column_or_zero(grains->s_y, (size_t)rods[e]);
        variance += sx * sx + sy * sy;
    }
    *s = isfinite(variance) ? sqrt(variance) : 0;
    uint32_t flags = grains->flags ? grains->flags[a] | grains->flags[b] : 0;
    return isfinite(*length) && *length > 0 && !(flags & GRAIN_DISTRUST) ? 0 : -1;
}

static int check_overlap(const struct press_point *points, size_t count, const struct force_record *record,
                         double delay)
{
    double first = INFINITY, last = -INFINITY;
    size_t inside = 0;
    for (size_t k = 0; k < count; k++) {
        double at = record->by_index ? (double)points[k].index : points[k].time;
        first = fmin(first, at), last = fmax(last, at);
        inside += !isnan(points[k].force);
    }
    if (inside)
        return 0;
    if (!isfinite(first))
        return error_input("the photos know no time: give photos.interval_s in the scene, or a record by index");
    return error_input("no photo lies inside the force record: photos %g to %g%s, record %g to %g: check the clocks, "
                       "then give --delay",
                       first + delay, last + delay, record->by_index ? "" : " s", record->at[0],
                       record->at[record->count - 1]);
}

/* The reference photo has no error against itself: it gets that of the others, whose common part it holds. */
static void even_errors(struct press_point *points, size_t count)
{
    double squares = 0;
    size_t known = 0;
    for (size_t k = 0; k < count; k++)
        if (points[k].used && points[k].s > 0) {
            squares += points[k].s * points[k].s;
            known++;
        }
    for (size_t k = 0; k < count; k++)
        if (known && !(points[k].s > 0))
            points[k].s = sqrt(squares / (double)known);
}

int press_series_points(const struct press_photo *photos, size_t count, const struct force_record *record,
                        const struct press_series_options *options, struct press_point *points)
{
    double reference = NAN;
    for (size_t k = 0; k < count; k++) {
        double length, s;
        for (int e = 0; e < 2; e++)
            if (options->rods[e] < 0 || (size_t)options->rods[e] >= photos[k].grains.count)
                return error_input("rod %ld: photo %lld has %zu grains: give two rows with --rods", options->rods[e],
                                   (long long)photos[k].index, photos[k].grains.count);
        int lost = branch_length(&photos[k].grains, options->rods, &length, &s);
        double at = record->by_index ? (double)photos[k].index : photos[k].time;
        points[k] = (struct press_point){.index = photos[k].index, .time = photos[k].time, .deflection = NAN};
        points[k].force = force_record_at(record, at + options->delay);
        if (!lost && isnan(reference))
            reference = length;
        if (!lost)
            points[k].deflection = options->scale * (reference - length);
        points[k].s = options->scale * s;
        points[k].used = !lost && !isnan(points[k].force);
    }
    even_errors(points, count);
    return check_overlap(points, count, record, options->delay);
}
