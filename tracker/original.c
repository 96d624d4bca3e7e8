#include "tracker/original.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/error.h"
#include "pipeline/number.h"

enum { COLUMNS_MAX = 13, CONF_LONG = 6, SHORT = 4, ROWS_MAX = 10000000 };

struct text {
    const char *path;
    size_t rows;
    int columns; /* 0 before the first row */
    int conf;    /* a #CORNERS line follows the rows, or there are six columns */
    double *values;
};

int original_is_text(const char *path)
{
    FILE *file = fopen(path, "r");
    int first = ' ';
    while (file && (first == ' ' || first == '\t' || first == '\r' || first == '\n'))
        first = fgetc(file);
    if (file)
        fclose(file);
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

static int first_row(struct text *text, int columns)
{
    if (columns != SHORT && columns != CONF_LONG && columns != COLUMNS_MAX)
        return error_input("%s: rows of %d numbers: grains.txt and CONF have 4 or 6, dic_out has 13", text->path,
                           columns);
    text->columns = columns;
    text->conf = columns == CONF_LONG;
    text->values = calloc(text->rows, (size_t)columns * sizeof *text->values);
    return text->values ? 0 : error_memory("a text file");
}

static int read_count(struct text *text, char *line, double values[COLUMNS_MAX])
{
    int count = parse_line(line, values);
    if (count != 1 || !(values[0] >= 1 && values[0] <= ROWS_MAX && values[0] == floor(values[0])))
        return error_input("%s: does not begin with the number of grains: give a state file (.hdf), or grains.txt, "
                           "dic_out or CONF",
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
    int status = 0;
    while (!status && getline(&line, &room, file) >= 0) {
        double values[COLUMNS_MAX];
        number++;
        if (text->rows && row == text->rows) {
            text->conf |= !strncmp(line, "#CORNERS", 8);
            continue;
        }
        if (line[strspn(line, " \t\r\n")] == '\0')
            continue;
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
    if (!status && (!text->rows || row < text->rows))
        status = error_input("%s: ends after %zu of %zu grains", text->path, row, text->rows);
    return status;
}

static int text_read(const char *path, const struct scene *scene, struct text *text)
{
    *text = (struct text){.path = path};
    FILE *file = fopen(path, "r");
    if (!file)
        return error_input("%s: %s: check the path", path, strerror(errno));
    int status = read_lines(file, text);
    fclose(file);
    if (!status && text->conf && !(scene->scale > 0))
        status = error_input("%s: is in metres: give the scene a \"scale_m_per_px\"", path);
    return status;
}

static const double *row_of(const struct text *text, size_t k)
{
    return text->values + k * (size_t)text->columns;
}

static double radius_of(const struct text *text, const struct scene *scene, const double *row)
{
    return text->columns == CONF_LONG ? row[2] / scene->scale : row[3];
}

static struct vec place_of(const struct text *text, const struct scene *scene, const double *row)
{
    if (!text->conf)
        return vec(row[0], row[1]);
    return scene_pixels(scene, vec(row[0], row[1]));
}

int original_read_grains(const char *path, const struct scene *scene, struct photo_grains *grains)
{
    static const char *const names[] = {"x_px", "y_px", "radius_px", "flags", NULL};
    struct text text;
    int status = text_read(path, scene, &text);
    if (!status)
        status = table_alloc(&PHOTO_GRAINS, grains, text.rows, names);
    for (size_t k = 0; !status && k < text.rows; k++) {
        struct vec place = place_of(&text, scene, row_of(&text, k));
        grains->x_px[k] = place.x;
        grains->y_px[k] = place.y;
        grains->radius_px[k] = radius_of(&text, scene, row_of(&text, k));
    }
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

static void take_conf(const struct text *text, const struct scene *scene, size_t k, struct photo_grains *previous)
{
    const double *row = row_of(text, k);
    struct vec place = place_of(text, scene, row);
    previous->x_seen_px[k] = place.x;
    previous->y_seen_px[k] = place.y;
    previous->angle_seen[k] = text->columns == CONF_LONG ? row[3] : row[2];
}

int original_read_motion(const char *path, const struct scene *scene, const struct photo_grains *reference,
                         struct photo_grains *previous)
{
    static const char *const names[] = {"x_px",       "y_px",  "angle", "x_seen_px", "y_seen_px",
                                        "angle_seen", "dx_px", "dy_px", "dangle",    NULL};
    struct text text;
    int status = text_read(path, scene, &text), corrected = scene->lens || scene->drift_patch_count;
    if (!status && text.columns == SHORT && !text.conf)
        status = error_input("%s: has no motions: give tracks, dic_out or CONF", path);
    if (!status && text.rows != reference->count)
        status = error_input("%s: %zu grains, the reference has %zu: give a file of the same grains", path, text.rows,
                             reference->count);
    if (!status)
        status = table_alloc(&PHOTO_GRAINS, previous, text.rows, names);
    for (size_t k = 0; !status && k < text.rows; k++) {
        if (text.conf)
            take_conf(&text, scene, k, previous);
        else
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
