#include "pipeline/packing/loads.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/files/input_file.h"
#include "pipeline/files/number.h"

enum kind { BY_WALL, BY_STRESS, BY_CORNER };
static const char *const headers[] = {"index,wall,fx_N,fy_N", "index,sxx_Pa,syy_Pa,sxy_Pa", "index,corner,fx_N,fy_N"};

/* Sides and corners, both counter-clockwise (y up), so that side k ends at the corners k and k + 1. */
static const char *const sides[] = {"bottom", "right", "top", "left"};
static const char *const corners[] = {"bottom-left", "bottom-right", "top-right", "top-left"};
enum { FIELDS = 4 };

/* What the file says about one photo. */
struct rows {
    int given[4];         /* which sides or corners; [0] for a stress */
    struct vec force[4];  /* N */
    double sxx, syy, sxy; /* Pa */
};

/* One line of the file. */
struct row {
    long index, line;
    int where; /* side or corner; 0 for a stress */
    double value[3];
};

/* A file of loads in memory. */
struct table {
    enum kind kind;
    struct row *rows; /* by index, then by line */
    size_t count;
};

/* Where the reader is, for errors with file and line. */
struct reader {
    const char *path;
    FILE *file;
    char *line;
    size_t room;
    long number; /* of the line */
};

/* ---- lines ---- */

/* In place; blanks at both ends. */
static char *trim(char *text)
{
    text += strspn(text, " \t");
    size_t length = strlen(text);
    while (length > 0 && strchr(" \t\r\n", text[length - 1]))
        text[--length] = '\0';
    return text;
}

/* The next line that holds anything, trimmed; NULL at the end, or with *failed. */
static char *next_line(struct reader *reader, int *failed)
{
    ssize_t length;
    errno = 0;
    while ((length = getline(&reader->line, &reader->room, reader->file)) >= 0) {
        reader->number++;
        if (memchr(reader->line, '\0', (size_t)length)) {
            *failed = error_input("%s:%ld: a zero byte: save the table as plain text", reader->path, reader->number);
            return NULL;
        }
        char *text = trim(reader->line);
        if (*text)
            return text;
    }
    if (ferror(reader->file) || !feof(reader->file))
        *failed = error_input("%s: %s: name a file that can be read", reader->path, strerror(errno));
    return NULL;
}

/* FIELDS fields at commas, in place; -1 with an error. */
static int split(const struct reader *reader, char *line, char *fields[FIELDS])
{
    int count = 0;
    for (char *at = line; at; count++) {
        char *comma = strchr(at, ',');
        if (comma)
            *comma++ = '\0';
        if (count < FIELDS)
            fields[count] = trim(at);
        at = comma;
    }
    if (count != FIELDS)
        return error_input("%s:%ld: %d cells: give four, separated by commas, decimals with a point", reader->path,
                           reader->number, count);
    return 0;
}

/* Its place among four; -1: none. */
static int find_word(const char *const words[4], const char *text)
{
    for (int k = 0; k < 4; k++)
        if (!strcmp(words[k], text))
            return k;
    return -1;
}

/* An empty cell is NaN: not known. */
static int read_cell(const struct reader *reader, const char *cell, double *value)
{
    *value = NAN;
    if (*cell && number_parse(cell, value))
        return error_input("%s:%ld: '%.40s' is not a number: write for example -1500.5, or leave the cell empty",
                           reader->path, reader->number, cell);
    return 0;
}

/* ---- rows ---- */

/* The header tells the kind: by wall, by corner or by stress. */
static int read_header(struct reader *reader, enum kind *kind)
{
    int failed = 0;
    char *line = next_line(reader, &failed), *fields[FIELDS], joined[200] = "";
    if (failed)
        return -1;
    if (line && strlen(line) < sizeof joined / 2 && split(reader, line, fields) == 0)
        snprintf(joined, sizeof joined, "%s,%s,%s,%s", fields[0], fields[1], fields[2], fields[3]);
    for (int k = 0; k < 3; k++)
        if (!strcmp(joined, headers[k])) {
            *kind = (enum kind)k;
            return 0;
        }
    if (line && strchr(line, ';'))
        return error_input("%s:%ld: the cells are separated by ';': save the table with ',' and decimal points",
                           reader->path, reader->number);
    return error_input("%s:%ld: the first line must be one of '%s', '%s', '%s': write it there", reader->path,
                       reader->number ? reader->number : 1, headers[0], headers[1], headers[2]);
}

static int read_row(const struct reader *reader, enum kind kind, char *line, struct row *row)
{
    char *fields[FIELDS];
    int stress = kind == BY_STRESS;
    *row = (struct row){.line = reader->number};
    if (split(reader, line, fields))
        return -1;
    if (number_parse_integer(fields[0], &row->index) || row->index < 0)
        return error_input("%s:%ld: '%.40s' is no index: give the number of a photo", reader->path, reader->number,
                           fields[0]);
    for (int k = stress ? 0 : 1; k < 3; k++)
        if (read_cell(reader, fields[k + 1], &row->value[k]))
            return -1;
    const char *const *words = kind == BY_CORNER ? corners : sides;
    if (!stress && (row->where = find_word(words, fields[1])) < 0)
        return error_input("%s:%ld: unknown %s '%.40s': give one of: %s, %s, %s, %s", reader->path, reader->number,
                           kind == BY_CORNER ? "corner" : "wall", fields[1], words[0], words[1], words[2], words[3]);
    return 0;
}

static int by_index(const void *left, const void *right)
{
    const struct row *a = left, *b = right;
    if (a->index != b->index)
        return a->index < b->index ? -1 : 1;
    return a->line < b->line ? -1 : a->line > b->line;
}

static int read_table(struct reader *reader, struct table *table)
{
    int failed = 0;
    size_t room = 0;
    char *line;
    if (read_header(reader, &table->kind))
        return -1;
    while ((line = next_line(reader, &failed))) {
        if (table->count == room) {
            room = room ? 2 * room : 64;
            struct row *grown = realloc(table->rows, room * sizeof *grown);
            if (!grown)
                return error_memory("loads");
            table->rows = grown;
        }
        if (read_row(reader, table->kind, line, &table->rows[table->count++]))
            return -1;
    }
    if (table->count)
        qsort(table->rows, table->count, sizeof *table->rows, by_index);
    return failed;
}

static int table_open(const char *path, struct table *table)
{
    struct reader reader = {.path = path, .file = input_file_open(path, INPUT_FILE_TEXT)};
    *table = (struct table){0};
    if (!reader.file)
        return -1;
    int status = read_table(&reader, table);
    free(reader.line);
    fclose(reader.file);
    if (status)
        free(table->rows);
    return status;
}

/* ---- one photo ---- */

/* The rows of a photo; *at, the first row that may be one, moves behind them. */
static int take_photo(const char *path, const struct table *table, int64_t index, size_t *at, struct rows *rows)
{
    *rows = (struct rows){0};
    while (*at < table->count && table->rows[*at].index < index)
        ++*at;
    if (*at == table->count || table->rows[*at].index > index)
        return error_input("%s: no row for photo %lld: add its loads", path, (long long)index);
    for (; *at < table->count && table->rows[*at].index == index; ++*at) {
        const struct row *row = &table->rows[*at];
        if (rows->given[row->where]++)
            return error_input("%s:%ld: photo %ld has this load twice: keep one of them", path, row->line, row->index);
        rows->force[row->where] = vec(row->value[1], row->value[2]);
        if (table->kind == BY_STRESS)
            rows->sxx = row->value[0], rows->syy = row->value[1], rows->sxy = row->value[2];
    }
    return 0;
}

/* For sums in which a load that is not known weighs nothing. */
static double known_or_zero(double value)
{
    return isnan(value) ? 0 : value;
}

/* How hard a photo's loads press inwards: the mean of the normal components that are known (Pa or N); below 0 they
 * pull.
 */
static double pressing(enum kind kind, const struct rows *rows)
{
    static const struct vec inward[] = {{0, 1}, {-1, 0}, {0, -1}, {1, 0}};                     /* of sides */
    static const struct vec diagonal[] = {{0.5, 0.5}, {-0.5, 0.5}, {-0.5, -0.5}, {0.5, -0.5}}; /* of corners */
    const struct vec *towards = kind == BY_CORNER ? diagonal : inward;
    double sum = 0;
    if (kind == BY_STRESS)
        return (known_or_zero(rows->sxx) + known_or_zero(rows->syy)) / 2;
    for (int k = 0; k < 4; k++)
        if (rows->given[k])
            sum += known_or_zero(rows->force[k].x) * towards[k].x + known_or_zero(rows->force[k].y) * towards[k].y;
    return sum / 4;
}

/* What makes pressing() a mean over the components that are known. */
static double share_known(enum kind kind, const struct rows *rows)
{
    int known = 0;
    if (kind == BY_STRESS)
        return isnan(rows->sxx) || isnan(rows->syy) ? 2 : 1;
    for (int k = 0; k < 4; k++)
        known += rows->given[k] != 0;
    return 4.0 / known;
}

/* A heap of grains without glue cannot be pulled. Zeros of load cells are not exact: what is small beside the largest
 * load of the test is forgiven. */
#define PULL_FORGIVEN 0.05

static double largest_load(const struct table *table)
{
    double largest = 0;
    for (size_t k = 0; k < table->count; k++)
        for (int v = 0; v < 3; v++)
            largest = fmax(largest, fabs(known_or_zero(table->rows[k].value[v])));
    return largest;
}

/* Loads that pull are an error: loose grains bear compression only. */
static int check_sign(const char *path, const struct table *table, int64_t index, const struct rows *rows)
{
    double press = pressing(table->kind, rows);
    if (press >= -PULL_FORGIVEN / 4 * largest_load(table))
        return 0;
    return error_input(
        "%s: photo %lld: the loads pull outwards, which no packing of loose grains can stand: is the sign "
        "turned? Forces act on the walls from outside (right wall in compression: fx < 0), stresses are "
        "positive in compression",
        path, (long long)index);
}

/* ---- loads of the walls ---- */

/* N on one wall; an error when there is no such wall. */
static int set_load(const char *path, struct walls *walls, int side, struct vec force)
{
    long w = walls_find(walls, sides[side]);
    if (w < 0)
        return error_input("%s: there is no wall '%s': give the scene a frame, or leave this load out", path,
                           sides[side]);
    walls->fx[w] = force.x;
    walls->fy[w] = force.y;
    return 0;
}

/* Force from outside on a wall: -stress . outward normal . length . length_m (compression positive). A component that
 * is not known leaves the load along its own axis unknown; in the small cross term of an inclined wall it counts 0. */
static struct vec stress_load(const struct rows *rows, const struct walls *walls, size_t w, double length_m)
{
    struct vec outward = vec_scale(-1, wall_inward(walls, w));
    double area = length_m * vec_norm(vec(walls->x1[w] - walls->x0[w], walls->y1[w] - walls->y0[w]));
    double sxx = rows->sxx, syy = rows->syy, xy_of_x = rows->sxy, xy_of_y = rows->sxy;
    if (fabs(outward.x) > fabs(outward.y)) { /* a side wall: sxx along its normal, sxy along it */
        syy = known_or_zero(syy);
        xy_of_x = known_or_zero(xy_of_x);
    } else {
        sxx = known_or_zero(sxx);
        xy_of_y = known_or_zero(xy_of_y);
    }
    return vec(-(sxx * outward.x + xy_of_x * outward.y) * area, -(xy_of_y * outward.x + syy * outward.y) * area);
}

/* Pa on the sides, times their length and that of the rods. */
static int apply_stress(const char *path, const struct rows *rows, double length_m, struct walls *walls)
{
    if (!(length_m > 0))
        return error_input("%s: stresses in Pa need the length of the rods: give the scene grains.length_m", path);
    for (int side = 0; side < 4; side++) {
        long w = walls_find(walls, sides[side]);
        struct vec load = w < 0 ? vec(NAN, NAN) : stress_load(rows, walls, (size_t)w, length_m);
        if (set_load(path, walls, side, load))
            return -1;
    }
    return 0;
}

static int apply_corners(const char *path, struct rows *rows, struct walls *walls)
{
    struct vec sum = vec(0, 0);
    int missing = -1;
    for (int k = 0; k < 4; k++) {
        if (rows->given[k])
            sum = vec_add(sum, rows->force[k]);
        else if (missing >= 0)
            return error_input("%s: hinge forces '%s' and '%s' are missing: give three corners at least", path,
                               corners[missing], corners[k]);
        else
            missing = k;
    }
    if (missing >= 0)
        rows->force[missing] = vec_scale(-1, sum);
    for (int k = 0; k < 4; k++)
        if (set_load(path, walls, k, vec_scale(0.5, vec_add(rows->force[k], rows->force[(k + 1) % 4]))))
            return -1;
    return 0;
}

/* The loads of one photo, by kind, to the walls' fx and fy. */
static int apply(const char *path, enum kind kind, struct rows *rows, double length_m, struct walls *walls)
{
    if (table_add(&WALLS, walls, "fx") || table_add(&WALLS, walls, "fy"))
        return -1;
    if (kind == BY_STRESS)
        return apply_stress(path, rows, length_m, walls);
    if (kind == BY_CORNER)
        return apply_corners(path, rows, walls);
    for (int k = 0; k < 4; k++)
        if (rows->given[k] && set_load(path, walls, k, rows->force[k]))
            return -1;
    return 0;
}

int loads_check(const char *path, const int64_t *photos, size_t count, struct loads_press *press)
{
    struct table table;
    size_t at = 0;
    int status = table_open(path, &table);
    if (status)
        return -1;
    *press = (struct loads_press){.per_area = table.kind == BY_STRESS};
    for (size_t k = 0; k < count && !status; k++) {
        struct rows rows;
        status = take_photo(path, &table, photos[k], &at, &rows) || check_sign(path, &table, photos[k], &rows) ? -1 : 0;
        if (!status)
            press->most = fmax(press->most, pressing(table.kind, &rows) * share_known(table.kind, &rows));
    }
    free(table.rows);
    return status;
}

int loads_apply(const char *path, int64_t index, double length_m, struct walls *walls)
{
    struct table table;
    struct rows rows;
    size_t at = 0;
    if (table_open(path, &table))
        return -1;
    int status = take_photo(path, &table, index, &at, &rows) || apply(path, table.kind, &rows, length_m, walls) ||
                 check_sign(path, &table, index, &rows);
    free(table.rows);
    return status ? -1 : 0;
}

static int is_other(double a, double b)
{
    return isnan(a) != isnan(b) || (!isnan(a) && a != b);
}

int loads_check_same(const char *path, int64_t index, double length_m, const struct walls *walls, const char *file)
{
    struct walls now = {0};
    int status =
        table_copy(&WALLS, &now, walls) || table_add(&WALLS, &now, "fx") || table_add(&WALLS, &now, "fy") ? -1 : 0;
    for (size_t w = 0; w < now.count && !status; w++)
        now.fx[w] = now.fy[w] = NAN;
    if (!status)
        status = loads_apply(path, index, length_m, &now);
    for (size_t w = 0; w < now.count && !status; w++)
        if (is_other(now.fx[w], walls->fx ? walls->fx[w] : NAN) || is_other(now.fy[w], walls->fy ? walls->fy[w] : NAN))
            status =
                error_input("%s: was made with other loads on the %.*s wall than %s gives now ('loads'): run contacts "
                            "again",
                            file, NAME_LENGTH, walls->name[w], path);
    table_free(&WALLS, &now);
    return status;
}
