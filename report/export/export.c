/* One state as text. Numbers have 17 digits, which give the same double again; NaN is an empty cell in CSV and "nan" in
 * the original programs' files. */
#include "report/export/export.h"

#include <ctype.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"

/* ---- CSV ---- */

/* A table, or several of equal length side by side. */
struct sheet {
    const struct table_kind *kind;
    const void *table;
    const char *prefix;
};

/* What stands before a column's name comes from the file: letters and digits alone. */
static void put_prefix(const char *prefix, FILE *stream)
{
    for (const char *c = prefix; *c; c++)
        fputc(isalnum((unsigned char)*c) ? *c : '_', stream);
    if (*prefix)
        fputc('_', stream);
}

/* "prefix_name [unit]" for each column that the table has; flags are followed by a column of their names. *first: no
 * comma before the next cell; it is kept across sheets. */
static void put_heading(const struct sheet *sheet, FILE *stream, int *first)
{
    for (size_t c = 0; c < sheet->kind->column_count; c++) {
        const struct column *column = &sheet->kind->columns[c];
        if (!*table_array(column, sheet->table))
            continue;
        fputs(*first ? "" : ",", stream);
        put_prefix(sheet->prefix, stream);
        fprintf(stream, "%s [%s]", column->name, column->units);
        if (!strcmp(column->name, "flags") && sheet->kind->flag_names)
            fputs(",flag_names", stream);
        *first = 0;
    }
}

/* The number, then the names joined by "|": both in one go, since the names say nothing to a program and the number
 * nothing to a person. */
static void put_flags(const struct table_kind *kind, uint32_t flags, FILE *stream)
{
    int some = 0;
    fprintf(stream, "%" PRIu32 ",", flags);
    for (int bit = 0; bit < 32; bit++)
        if (flags >> bit & 1) {
            const char *name = kind->flag_names[bit];
            fprintf(stream, "%s%s", some++ ? "|" : "", name ? name : "?");
        }
}

/* Quoted, so that no name can end its cell; behind an apostrophe where a spreadsheet would take it for a formula. */
static void put_name(const char *name, FILE *stream)
{
    fputs(strchr("=+-@", *name) && *name ? "\"'" : "\"", stream);
    for (int k = 0; k < NAME_LENGTH && name[k]; k++) {
        if (name[k] == '"')
            fputc('"', stream);
        fputc((unsigned char)name[k] < 0x20 ? '?' : name[k], stream);
    }
    fputc('"', stream);
}

/* One cell, without commas around it; NaN is empty. */
static void put_cell(const struct table_kind *kind, const struct column *column, const void *array, size_t row,
                     FILE *stream)
{
    switch (column->type) {
    case COLUMN_DOUBLE:
        if (!isnan(((const double *)array)[row]))
            fprintf(stream, "%.17g", ((const double *)array)[row]);
        break;
    case COLUMN_INT64:
        fprintf(stream, "%" PRId64, ((const int64_t *)array)[row]);
        break;
    case COLUMN_UINT32:
        if (!strcmp(column->name, "flags") && kind->flag_names)
            put_flags(kind, ((const uint32_t *)array)[row], stream);
        else
            fprintf(stream, "%" PRIu32, ((const uint32_t *)array)[row]);
        break;
    case COLUMN_NAME:
        put_name((const char *)array + row * NAME_LENGTH, stream);
        break;
    }
}

/* Row `row` of one sheet; the comma before it when something stands there. */
static void put_row(const struct sheet *sheet, size_t row, FILE *stream, int *first)
{
    for (size_t c = 0; c < sheet->kind->column_count; c++) {
        const void *array = *table_array(&sheet->kind->columns[c], sheet->table);
        if (!array)
            continue;
        if (!*first)
            fputc(',', stream);
        put_cell(sheet->kind, &sheet->kind->columns[c], array, row, stream);
        *first = 0;
    }
}

/* Sheets side by side; all have as many rows as the first. */
static void put_sheets(const struct sheet *sheets, size_t count, FILE *stream)
{
    int first = 1;
    for (size_t s = 0; s < count; s++)
        put_heading(&sheets[s], stream, &first);
    fputc('\n', stream);
    for (size_t row = 0; row < table_rows(sheets[0].kind, sheets[0].table); row++) {
        first = 1;
        for (size_t s = 0; s < count; s++)
            put_row(&sheets[s], row, stream, &first);
        fputc('\n', stream);
    }
}

int export_csv(const struct loaded *loaded, const char *table, FILE *stream)
{
    const struct packing *packing = &loaded->packing;
    struct sheet *sheets;
    size_t count = 1;
    if (!loaded->is_si && strcmp(table, "grains"))
        return error_input("%s: is a photo-side file without a table '%s': export grains", loaded->path, table);
    if (!(sheets = malloc((1 + packing->force_count) * sizeof *sheets)))
        return error_memory("an export");
    sheets[0] = (struct sheet){&PHOTO_GRAINS, &loaded->grains, ""};
    if (loaded->is_si && !strcmp(table, "grains"))
        sheets[0] = (struct sheet){&GRAINS, &packing->grains, ""};
    if (!strcmp(table, "walls"))
        sheets[0] = (struct sheet){&WALLS, &packing->walls, ""};
    if (!strcmp(table, "contacts")) {
        sheets[0] = (struct sheet){&CONTACTS, &packing->contacts, ""};
        for (size_t f = 0; f < packing->force_count; f++)
            sheets[count++] = (struct sheet){&CONTACT_FORCES, &packing->forces[f].contact, packing->forces[f].method};
    }
    put_sheets(sheets, count, stream);
    free(sheets);
    return 0;
}

/* ---- extended XYZ ---- */

/* NaN for a column that the file lacks. */
static double value(const double *column, size_t row)
{
    return column ? column[row] : NAN;
}

int export_xyz(const struct loaded *loaded, FILE *stream)
{
    const struct photo_grains *photo = &loaded->grains;
    const struct grains *si = &loaded->packing.grains;
    size_t count = loaded->is_si ? si->count : photo->count;
    fprintf(stream, "%zu\nProperties=id:I:1:pos:R:3:radius:R:1:angle:R:1:flags:I:1 Units=%s Time=%.17g\n", count,
            loaded->is_si ? "m" : "px", loaded_info(loaded)->time_s);
    for (size_t k = 0; k < count; k++)
        if (loaded->is_si)
            fprintf(stream, "%zu %.17g %.17g 0 %.17g %.17g %" PRIu32 "\n", k, si->x[k], si->y[k], si->radius[k],
                    value(si->angle, k), si->flags[k]);
        else
            fprintf(stream, "%zu %.17g %.17g 0 %.17g %.17g %" PRIu32 "\n", k, photo->x_px[k], -photo->y_px[k],
                    photo->radius_px[k], value(photo->angle, k), photo->flags[k]);
    return 0;
}

/* ---- the original programs ---- */

/* Where the lines of two walls meet. */
static struct vec corner(const struct walls *walls, const char *first, const char *second)
{
    long a = walls_find(walls, first), b = walls_find(walls, second);
    if (a < 0 || b < 0)
        return vec(NAN, NAN);
    struct vec p = vec(walls->x0[a], walls->y0[a]), u = wall_direction(walls, (size_t)a);
    struct vec q = vec(walls->x0[b], walls->y0[b]), v = wall_direction(walls, (size_t)b);
    return vec_meet(p, u, q, v);
}

int export_conf(const struct loaded *loaded, FILE *stream)
{
    static const char *const corners[4][2] = {
        {"top", "left"}, {"top", "right"}, {"bottom", "right"}, {"bottom", "left"}};
    const struct grains *grains = &loaded->packing.grains;
    const double *strain = loaded->packing.info.strain;
    if (!loaded->is_si)
        return error_input("%s: is in px, CONF files are in m: give a file of contacts or forces", loaded->path);
    fprintf(stream, "%zu\n", grains->count);
    for (size_t k = 0; k < grains->count; k++)
        fprintf(stream, "%.15e %.15e %.15e %.15e 1 1\n", grains->x[k], grains->y[k], grains->radius[k],
                value(grains->angle, k));
    fputs("#CORNERS\n", stream);
    for (int c = 0; c < 4; c++) {
        struct vec at = corner(&loaded->packing.walls, corners[c][0], corners[c][1]);
        fprintf(stream, "%.15e %.15e\n", at.x, at.y);
    }
    /* Gradient and strain count extension as positive there, the state file counts compression. */
    double xx = -strain[0], yy = -strain[1], xy = -strain[2];
    const double numbers[] = {xx, yy, xy, xx, yy, 0.5 * xy, -0.5 * xy, xx + yy};
    fputs("#STRAINS Gxx Gyy Gxy Gyx Exx Eyy Exy Erot Evol\n", stream);
    for (int c = 0; c < 8; c++) /* never "-nan" */
        fprintf(stream, "%.15e%s", isnan(numbers[c]) ? NAN : numbers[c], c == 2 ? " 0 " : c < 7 ? " " : "\n");
    fputs("#SCALE\n1\n", stream);
    return 0;
}

int export_dic(const struct loaded *loaded, FILE *stream)
{
    const struct photo_grains *g = &loaded->grains;
    if (loaded->is_si || !g->x_ref_px || !g->y_ref_px)
        return error_input("%s: has no reference positions in px: give a file of tracker", loaded->path);
    fprintf(stream, "%zu\n", g->count);
    for (size_t k = 0; k < g->count; k++) {
        double rx = floor(g->x_ref_px[k] + 0.5), ry = floor(g->y_ref_px[k] + 0.5), angle = value(g->angle, k);
        double ox = rx - g->x_ref_px[k], oy = ry - g->y_ref_px[k], c = cos(angle), s = sin(angle);
        double dx = g->x_px[k] + c * ox + s * oy - rx, dy = g->y_px[k] - s * ox + c * oy - ry;
        double zncc = value(g->zncc, k);
        fprintf(stream, "%.0f %.0f 0 %.15e %.15e %.15e %.15e %.15e %.15e %.15e %.15e %.15e %.15e\n", rx, ry,
                g->radius_px[k], dx, dy, angle, value(g->dx_px, k), value(g->dy_px, k), value(g->dangle, k), zncc, zncc,
                zncc);
    }
    return 0;
}
