/* Reading text of the 1gamma2epsilon programs: a count, then that many rows of the same length. What is not understood
 * is refused with its line; rows are never left out, since row k is grain k for ever. */
#include "tracker/original.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/files/input_file.h"
#include "pipeline/files/number.h"

enum { DIC = 13, CIRCLES = 4, COLUMNS_MAX = DIC, ROWS_MAX = 10000000 };

/* One file of the original programs; `values`, rows x columns, is owned. */
struct text {
    const char *path;
    size_t rows;
    int columns; /* 0 before the first row */
    int conf;    /* a #CORNERS line follows the rows */
    double *values;
};

int original_is_text(const char *path)
{
    FILE *file = input_file_open(path, INPUT_FILE_TEXT);
    int first = ' ';
    while (file && (first == ' ' || first == '\t' || first == '\r' || first == '\n'))
        first = fgetc(file);
    if (file)
        fclose(file);
    else
        error_clear(); /* whoever reads it says so */
    return first >= '0' && first <= '9';
}

/* Numbers of a line, -1 when one is none. Lost grains stand as nan. */
static int parse_line(char *line, double values[COLUMNS_MAX])
{
    int count = 0;
    char *rest = NULL;
    for (char *word = strtok_r(line, " \t\r\n", &rest); word; word = strtok_r(NULL, " \t\r\n", &rest)) {
        if (count == COLUMNS_MAX)
            return -1;
        if (!strcmp(word, "nan") || !strcmp(word, "-nan"))
            values[count] = NAN;
        else if (number_parse(word, &values[count]))
            return -1;
        count++;
    }
    return count;
}

/* The number of columns tells which kind of file it is. */
static int first_row(struct text *text, int columns)
{
    if (columns != CIRCLES && columns != DIC)
        return error_input("%s: rows of %d numbers: grains.txt has 4, dic_out has 13", text->path, columns);
    text->columns = columns;
    text->values = calloc(text->rows, (size_t)columns * sizeof *text->values);
    return text->values ? 0 : error_memory("a text file");
}

/* The first line: the number of rows, a whole number from 1 to ROWS_MAX. */
static int read_count(struct text *text, char *line, double values[COLUMNS_MAX])
{
    int count = parse_line(line, values);
    if (count != 1 || !(values[0] >= 1 && values[0] <= ROWS_MAX && values[0] == floor(values[0])))
        return error_input("%s: does not begin with the number of grains: give a state file (.hdf), grains.txt or "
                           "dic_out",
                           text->path);
    text->rows = (size_t)values[0];
    return 0;
}

/* Count, rows, and a look at what follows. */
static int read_lines(FILE *file, struct text *text)
{
    char *line = NULL;
    size_t room = 0, row = 0;
    long number = 0;
    int status = 0, rows_end = 0;
    while (!status && getline(&line, &room, file) >= 0) {
        double values[COLUMNS_MAX];
        number++;
        if (line[strspn(line, " \t\r\n")] == '\0')
            continue;
        if (text->rows && row == text->rows) {
            text->conf |= !strncmp(line, "#CORNERS", 8);
            rows_end |= *line == '#'; /* blocks of the original programs, which are not read */
            if (!rows_end)
                status = error_input("%s: line %ld: there are more grains than the %zu that its first line counts: "
                                     "correct the count",
                                     text->path, number, text->rows);
            continue;
        }
        if (!text->rows) {
            status = read_count(text, line, values);
            continue;
        }
        int count = parse_line(line, values);
        if (!text->columns && count >= 0)
            status = first_row(text, count);
        if (!status && count != text->columns)
            status = error_input("%s: line %ld: %d numbers are needed", text->path, number, text->columns);
        if (!status)
            memcpy(text->values + row++ * (size_t)text->columns, values, (size_t)count * sizeof *values);
    }
    free(line);
    if (!status && !feof(file)) /* a failing disk, or memory gone */
        return error_failed("%s: %s", text->path, strerror(errno));
    if (!status && (!text->rows || row < text->rows))
        status = error_input("%s: ends after %zu of %zu grains", text->path, row, text->rows);
    return status;
}

/* 0, or -1 with an error; text->values is to be freed either way. */
static int text_read(const char *path, struct text *text)
{
    *text = (struct text){.path = path};
    FILE *file = input_file_open(path, INPUT_FILE_TEXT);
    if (!file)
        return -1;
    int status = read_lines(file, text);
    fclose(file);
    if (!status && text->conf)
        status = error_input("%s: is a CONF file, in metres: give grains.txt or dic_out, in px", path);
    return status;
}

/* Row k, borrowed. */
static const double *row_of(const struct text *text, size_t k)
{
    return text->values + k * (size_t)text->columns;
}

/* A row by where it is, px, for matching two files. */
struct place {
    double x, y;
    size_t row;
};

/* For qsort(): by x, then y, then row. */
static int by_place(const void *left, const void *right)
{
    const struct place *a = left, *b = right;
    if (a->x != b->x)
        return a->x < b->x ? -1 : 1;
    if (a->y != b->y)
        return a->y < b->y ? -1 : 1;
    return a->row < b->row ? -1 : a->row > b->row;
}

/* One grain in two rows would be followed, touched and loaded twice. */
static int check_places(const char *path, const struct photo_grains *grains)
{
    struct place *places = malloc((grains->count + 1) * sizeof *places);
    int status = places ? 0 : error_memory("the places of grains");
    for (size_t k = 0; k < grains->count && places; k++)
        places[k] = (struct place){grains->x_px[k], grains->y_px[k], k};
    if (places)
        qsort(places, grains->count, sizeof *places, by_place);
    for (size_t k = 1; k < grains->count && !status; k++)
        if (places[k].x == places[k - 1].x && places[k].y == places[k - 1].y)
            status = error_input("%s: grains %zu and %zu have the same centre: leave one of them out, and correct the "
                                 "count",
                                 path, places[k - 1].row, places[k].row);
    free(places);
    return status;
}

int original_read_grains(const char *path, struct photo_grains *grains)
{
    static const char *const names[] = {"x_px", "y_px", "radius_px", "flags", NULL};
    struct text text;
    int status = text_read(path, &text);
    if (!status)
        status = table_alloc(&PHOTO_GRAINS, grains, text.rows, names);
    for (size_t k = 0; !status && k < text.rows; k++) {
        const double *row = row_of(&text, k);
        if (!(row[3] > 0) || !isfinite(row[0]) || !isfinite(row[1]))
            status = error_input("%s: grain %zu: x, y and a radius above 0 are needed", path, k);
        grains->x_px[k] = row[0];
        grains->y_px[k] = row[1];
        grains->radius_px[k] = row[3];
    }
    status = status || check_places(path, grains) ? -1 : 0;
    if (status)
        table_free(&PHOTO_GRAINS, grains);
    free(text.values);
    return status;
}

/* The motion written is that of the material at the rounded centre (refx, refy). */
static void take_dic(const double *row, const struct photo_grains *reference, size_t k, struct photo_grains *previous)
{
    const double ox = row[0] - reference->x_px[k], oy = row[1] - reference->y_px[k], c = cos(row[6]), s = sin(row[6]);
    previous->x_seen_px[k] = row[0] + row[4] - (c * ox + s * oy);
    previous->y_seen_px[k] = row[1] + row[5] - (-s * ox + c * oy);
    previous->angle_seen[k] = row[6];
    previous->dx_px[k] = row[7];
    previous->dy_px[k] = row[8];
    previous->dangle[k] = row[9];
}

int original_read_motion(const char *path, int corrected, const struct photo_grains *reference,
                         struct photo_grains *previous)
{
    static const char *const names[] = {"x_px",       "y_px",  "angle", "x_seen_px", "y_seen_px",
                                        "angle_seen", "dx_px", "dy_px", "dangle",    NULL};
    struct text text;
    int status = text_read(path, &text);
    if (!status && text.columns == CIRCLES)
        status = error_input("%s: has no motions: give tracks or dic_out", path);
    if (!status && text.rows != reference->count)
        status = error_input("%s: %zu grains, the reference has %zu: give a file of the same grains", path, text.rows,
                             reference->count);
    if (!status)
        status = table_alloc(&PHOTO_GRAINS, previous, text.rows, names);
    for (size_t k = 0; !status && k < text.rows; k++) {
        take_dic(row_of(&text, k), reference, k, previous);
        if (corrected) /* these files know nothing of lens and camera: no motion since that photo */
            continue;
        previous->x_px[k] = previous->x_seen_px[k];
        previous->y_px[k] = previous->y_seen_px[k];
        previous->angle[k] = previous->angle_seen[k];
    }
    free(text.values);
    return status;
}
