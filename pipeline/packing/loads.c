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
    enum kind kind;
    int given[4];         /* which sides or corners; [0] for a stress */
    struct vec force[4];  /* N */
    double sxx, syy, sxy; /* Pa */
};

struct reader {
    const char *path;
    FILE *file;
    char *line;
    size_t room;
    long number; /* of the line */
};

/* ---- lines ---- */

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
        char *text = reader->line;
        if (reader->number == 1 && !strncmp(text, "\xEF\xBB\xBF", 3))
            text += 3; /* spreadsheets write a byte order mark */
        text = trim(text);
        if (*text)
            return text;
    }
    if (ferror(reader->file) || !feof(reader->file))
        *failed = error_input("%s: %s: name a file that can be read", reader->path, strerror(errno));
    return NULL;
}

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

/* One row; it counts when it belongs to the wanted photo. */
static int read_row(const struct reader *reader, char *line, int64_t wanted, struct rows *rows)
{
    char *fields[FIELDS];
    long index;
    double value[3] = {0};
    int where = 0, stress = rows->kind == BY_STRESS;
    if (split(reader, line, fields))
        return -1;
    if (number_parse_integer(fields[0], &index) || index < 0)
        return error_input("%s:%ld: '%.40s' is no index: give the number of a photo", reader->path, reader->number,
                           fields[0]);
    for (int k = stress ? 0 : 1; k < 3; k++)
        if (read_cell(reader, fields[k + 1], &value[k]))
            return -1;
    const char *const *words = rows->kind == BY_CORNER ? corners : sides;
    if (!stress && (where = find_word(words, fields[1])) < 0)
        return error_input("%s:%ld: unknown %s '%.40s': give one of: %s, %s, %s, %s", reader->path, reader->number,
                           rows->kind == BY_CORNER ? "corner" : "wall", fields[1], words[0], words[1], words[2],
                           words[3]);
    if (index != wanted)
        return 0;
    if (rows->given[where]++)
        return error_input("%s:%ld: photo %ld has this load twice: keep one of them", reader->path, reader->number,
                           index);
    rows->force[where] = vec(value[1], value[2]);
    if (stress) {
        rows->sxx = value[0];
        rows->syy = value[1];
        rows->sxy = value[2];
    }
    return 0;
}

static int read_rows(struct reader *reader, int64_t index, struct rows *rows)
{
    int failed = 0;
    char *line;
    if (read_header(reader, &rows->kind))
        return -1;
    while ((line = next_line(reader, &failed)))
        if (read_row(reader, line, index, rows))
            return -1;
    if (failed)
        return -1;
    if (!rows->given[0] && !rows->given[1] && !rows->given[2] && !rows->given[3])
        return error_input("%s: no row for photo %lld: add its loads", reader->path, (long long)index);
    return 0;
}

/* ---- loads of the walls ---- */

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

static double known_or_zero(double value)
{
    return isnan(value) ? 0 : value;
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

static int apply(const char *path, struct rows *rows, double length_m, struct walls *walls)
{
    if (table_add(&WALLS, walls, "fx") || table_add(&WALLS, walls, "fy"))
        return -1;
    if (rows->kind == BY_STRESS)
        return apply_stress(path, rows, length_m, walls);
    if (rows->kind == BY_CORNER)
        return apply_corners(path, rows, walls);
    for (int k = 0; k < 4; k++)
        if (rows->given[k] && set_load(path, walls, k, rows->force[k]))
            return -1;
    return 0;
}

static int read_file(const char *path, int64_t index, struct rows *rows)
{
    struct reader reader = {.path = path, .file = input_file_open(path, INPUT_FILE_TEXT)};
    if (!reader.file)
        return -1;
    int status = read_rows(&reader, index, rows);
    free(reader.line);
    fclose(reader.file);
    return status;
}

int loads_check(const char *path, int64_t index)
{
    struct rows rows = {0};
    return read_file(path, index, &rows);
}

int loads_apply(const char *path, int64_t index, double length_m, struct walls *walls)
{
    struct rows rows = {0};
    return read_file(path, index, &rows) ? -1 : apply(path, &rows, length_m, walls);
}
