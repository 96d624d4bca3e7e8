/* State files of older versions stay readable, number for number: tests/golden/versionN holds files as that version
 * wrote them, and values.txt what h5py reads there (tests/golden/values.py). A column that is renamed, dropped, or read
 * in other units fails here. */
#include "tests/check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/packing/packing_file.h"
#include "pipeline/packing/patches.h"
#include "pipeline/speak/error.h"
#include "pipeline/state/state.h"

#define FOLDER FILM_SOURCE_DIR "/tests/golden/version1/"

/* A line of values.txt. */
struct line {
    char file[40], group[40], column[40], units[20], first[40], last[40];
    size_t rows;
    double sum;
};

/* Any table of the format: large enough for each struct of columns. */
union table {
    size_t count;
    char bytes[1024];
};

static const struct table_kind *kind_of(const struct line *line)
{
    int photo_side = !strcmp(line->file, "grains.hdf") || !strcmp(line->file, "tracks.hdf") ||
                     !strcmp(line->file, "photo-truth.hdf");
    if (!strcmp(line->group, "grains"))
        return photo_side ? &PHOTO_GRAINS : &GRAINS;
    if (!strcmp(line->group, "patches"))
        return &PATCHES;
    if (!strcmp(line->group, "walls"))
        return &WALLS;
    if (!strcmp(line->group, "contacts"))
        return &CONTACTS;
    if (!strncmp(line->column, "residual_", 9))
        return &RESIDUALS;
    return strncmp(line->column, "ray_", 4) && strncmp(line->column, "soft_", 5) ? &CONTACT_FORCES
           : *line->column == 'r'                                                ? &RAYS
                                                                                 : &SOFTEST;
}

static double number_at(const struct column *column, const void *array, size_t row)
{
    switch (column->type) {
    case COLUMN_DOUBLE:
        return ((const double *)array)[row];
    case COLUMN_INT64:
        return (double)((const int64_t *)array)[row];
    default:
        return ((const uint32_t *)array)[row];
    }
}

static void check_number(const struct line *line, double value, const char *text)
{
    double wanted = strtod(text, NULL);
    if (!(value == wanted || (isnan(value) && isnan(wanted))))
        fail_msg("%s %s/%s: %.17g, not %s", line->file, line->group, line->column, value, text);
}

static void check_values(const struct line *line, const struct column *column, const void *array)
{
    double sum = 0;
    if (column->type == COLUMN_NAME) {
        const char(*names)[NAME_LENGTH] = array;
        assert_int_equal(strncmp(names[0], line->first, NAME_LENGTH), 0);
        assert_int_equal(strncmp(names[line->rows - 1], line->last, NAME_LENGTH), 0);
        return;
    }
    check_number(line, number_at(column, array, 0), line->first);
    check_number(line, number_at(column, array, line->rows - 1), line->last);
    for (size_t k = 0; k < line->rows; k++)
        sum += isfinite(number_at(column, array, k)) ? number_at(column, array, k) : 0;
    check_near(sum, line->sum, 1e-12 * (double)line->rows * (fabs(line->sum) + 1));
}

static void check_line(const struct line *line)
{
    const struct table_kind *kind = kind_of(line);
    const struct column *column = NULL;
    union table table;
    char path[400], units[20] = "";
    for (size_t c = 0; c < kind->column_count; c++)
        if (!strcmp(kind->columns[c].name, line->column))
            column = &kind->columns[c];
    if (!column)
        fail_msg("%s: nobody knows the column %s/%s any more", line->file, line->group, line->column);
    for (size_t k = 0; column->units[k]; k++)
        units[k] = column->units[k] == ' ' ? '_' : column->units[k];
    assert_string_equal(units, line->units);
    memset(&table, 0, sizeof table);
    snprintf(path, sizeof path, FOLDER "%s", line->file);
    struct state *state = state_open(path);
    assert_non_null(state);
    check_done(state_read(state, line->group, kind, NULL, &table));
    state_close(state);
    const void *array = *table_array(column, &table);
    assert_non_null(array);
    assert_int_equal(table_rows(kind, &table), line->rows);
    check_values(line, column, array);
    table_free(kind, &table);
}

static void every_column_is_read(void **unused)
{
    (void)unused;
    struct line line;
    size_t lines = 0;
    FILE *file = fopen(FOLDER "values.txt", "r");
    assert_non_null(file);
    while (fscanf(file, "%39s %39s %39s %19s %zu %39s %39s %lf", line.file, line.group, line.column, line.units,
                  &line.rows, line.first, line.last, &line.sum) == 8) {
        check_line(&line);
        lines++;
    }
    assert_true(feof(file));
    fclose(file);
    assert_int_equal(lines, 420);
}

/* As the stages read them: with everything that is checked on reading. */
static void every_packing_is_read(void **unused)
{
    static const char *const names[] = {"contacts", "forces", "range", "walk", "series", "truth"};
    (void)unused;
    for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
        char path[400];
        struct packing packing;
        snprintf(path, sizeof path, FOLDER "%s.hdf", names[k]);
        check_done(packing_read(path, &packing));
        assert_int_equal(packing.grains.count, 13);
        assert_int_equal(packing.info.index, 1);
        packing_free(&packing);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_column_is_read),
        cmocka_unit_test(every_packing_is_read),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
