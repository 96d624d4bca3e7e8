#include "pipeline/packing/vtk.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/state/state_hdf.h"

enum { CELL_LINE = 3 }; /* VTK_LINE */

/* Points (grains, then one per wall contact) and lines (contacts) as VTKHDF has them. */
struct view {
    size_t points, cells;
    double *xyz;
    int64_t *connectivity, *offsets;
    uint8_t *types;
};

static void view_free(struct view *view)
{
    free(view->xyz);
    free(view->connectivity);
    free(view->offsets);
    free(view->types);
}

/* -1 without memory; view_free() accepts what is there. */
static int view_alloc(const struct packing *packing, struct view *view)
{
    size_t wall;
    memset(view, 0, sizeof *view);
    view->points = packing->grains.count;
    view->cells = packing->contacts.count;
    for (size_t c = 0; c < view->cells; c++)
        view->points += (size_t)packing_is_wall(packing, c, &wall);
    view->xyz = calloc(3 * view->points + 1, sizeof *view->xyz);
    view->connectivity = calloc(2 * view->cells + 1, sizeof *view->connectivity);
    view->offsets = calloc(view->cells + 1, sizeof *view->offsets);
    view->types = calloc(view->cells + 1, sizeof *view->types);
    if (view->xyz && view->connectivity && view->offsets && view->types)
        return 0;
    view_free(view);
    return error_memory("the VTKHDF view");
}

/* A line per contact, from centre to centre or to the wall. */
static void view_fill(const struct packing *packing, struct view *view)
{
    size_t next = packing->grains.count, wall;
    for (size_t k = 0; k < packing->grains.count; k++) {
        view->xyz[3 * k] = packing->grains.x[k];
        view->xyz[3 * k + 1] = packing->grains.y[k];
    }
    for (size_t c = 0; c < view->cells; c++) {
        view->connectivity[2 * c] = packing->contacts.i[c];
        view->connectivity[2 * c + 1] = packing->contacts.j[c];
        view->offsets[c + 1] = 2 * (int64_t)(c + 1);
        view->types[c] = CELL_LINE;
        if (!packing_is_wall(packing, c, &wall))
            continue;
        struct vec end = packing_partner(packing, c);
        view->xyz[3 * next] = end.x;
        view->xyz[3 * next + 1] = end.y;
        view->connectivity[2 * c + 1] = (int64_t)next++;
    }
}

/* One dataset; rank 1: `rows` values, rank 2: rows x 3. */
static int put(struct state_writer *writer, hid_t group, const char *name, hid_t file_type, hid_t memory_type, int rank,
               hsize_t rows, const void *values)
{
    hsize_t dims[2] = {rows, 3};
    hid_t dataset = state_dataset(writer, group, name, file_type, memory_type, rank, dims, values);
    if (dataset < 0)
        return -1;
    return H5Dclose(dataset) < 0 ? state_write_failed(writer, name) : 0;
}

static int put_geometry(struct state_writer *writer, hid_t group, const struct view *view)
{
    const int64_t points = (int64_t)view->points, cells = (int64_t)view->cells, ids = 2 * (int64_t)view->cells;
    hid_t file = H5T_STD_I64LE, memory = H5T_NATIVE_INT64;
    return put(writer, group, "NumberOfPoints", file, memory, 1, 1, &points) ||
                   put(writer, group, "NumberOfCells", file, memory, 1, 1, &cells) ||
                   put(writer, group, "NumberOfConnectivityIds", file, memory, 1, 1, &ids) ||
                   put(writer, group, "Points", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, 2, view->points, view->xyz) ||
                   put(writer, group, "Connectivity", file, memory, 1, (hsize_t)ids, view->connectivity) ||
                   put(writer, group, "Offsets", file, memory, 1, view->cells + 1, view->offsets) ||
                   put(writer, group, "Types", H5T_STD_U8LE, H5T_NATIVE_UINT8, 1, view->cells, view->types)
               ? -1
               : 0;
}

/* Readers of VTK want the type as a fixed-length ASCII string and the version as two integers. */
static int put_header(struct state_writer *writer, hid_t group)
{
    const int64_t version[2] = {1, 0};
    const hsize_t two = 2;
    hid_t space = H5Screate_simple(1, &two, NULL);
    hid_t attribute = H5Acreate2(group, "Version", H5T_STD_I64LE, space, H5P_DEFAULT, H5P_DEFAULT);
    int failed = attribute < 0 || H5Awrite(attribute, H5T_NATIVE_INT64, version) < 0;
    if (attribute >= 0)
        failed |= H5Aclose(attribute) < 0;
    if (space >= 0)
        H5Sclose(space);
    if (failed)
        return state_write_failed(writer, "VTKHDF/Version");
    return state_write_text(writer, "VTKHDF", "Type", "UnstructuredGrid");
}

/* Make every column that a table has visible in VTKHDF/CellData as PREFIXname. */
static int link_cells(struct state_writer *writer, const char *group, const char *prefix, const struct table_kind *kind,
                      const void *table)
{
    char target[128], link[128];
    for (size_t c = 0; c < kind->column_count; c++) {
        if (!*table_array(&kind->columns[c], table))
            continue;
        snprintf(target, sizeof target, "/%s/%s", group, kind->columns[c].name);
        snprintf(link, sizeof link, "/VTKHDF/CellData/%s%s", prefix, kind->columns[c].name);
        if (state_hard_link(writer, target, link))
            return -1;
    }
    return 0;
}

/* A column of the grains with the points behind them filled up. */
static int put_padded(struct state_writer *writer, hid_t group, const char *name, enum column_type type,
                      const void *values, size_t rows, size_t points)
{
    size_t size = column_size(type);
    char *padded = calloc(points + 1, size);
    if (!padded)
        return error_memory("the VTKHDF view");
    if (rows)
        memcpy(padded, values, rows * size);
    for (size_t k = rows; k < points && type == COLUMN_DOUBLE; k++)
        ((double *)padded)[k] = NAN;
    hid_t file_type = state_file_type(type), memory_type = state_memory_type(type);
    int result = put(writer, group, name, file_type, memory_type, 1, points, padded);
    H5Tclose(file_type);
    H5Tclose(memory_type);
    free(padded);
    return result;
}

static int put_points(struct state_writer *writer, const char *group, const char *prefix, const struct table_kind *kind,
                      const void *table, size_t points)
{
    size_t rows = table_rows(kind, table);
    hid_t place = state_group(writer, "VTKHDF/PointData");
    int result = place < 0 ? -1 : 0;
    for (size_t c = 0; c < kind->column_count && result == 0; c++) {
        char target[128], link[128], name[64];
        const void *values = *table_array(&kind->columns[c], table);
        if (!values)
            continue;
        snprintf(name, sizeof name, "%s%s", prefix, kind->columns[c].name);
        snprintf(target, sizeof target, "/%s/%s", group, kind->columns[c].name);
        snprintf(link, sizeof link, "/VTKHDF/PointData/%s", name);
        result = rows == points ? state_hard_link(writer, target, link)
                                : put_padded(writer, place, name, kind->columns[c].type, values, rows, points);
    }
    if (place >= 0 && H5Gclose(place) < 0 && result == 0)
        result = state_write_failed(writer, "VTKHDF/PointData");
    return result;
}

static int put_data(struct state_writer *writer, const struct packing *packing, size_t points)
{
    hid_t cells = state_group(writer, "VTKHDF/CellData");
    if (cells < 0 || H5Gclose(cells) < 0)
        return -1;
    int result = link_cells(writer, "contacts", "", &CONTACTS, &packing->contacts) ||
                 put_points(writer, "grains", "", &GRAINS, &packing->grains, points);
    for (size_t f = 0; f < packing->force_count && !result; f++) {
        const struct forces *forces = &packing->forces[f];
        char group[64], prefix[32];
        snprintf(group, sizeof group, "forces/%.*s", NAME_LENGTH, forces->method);
        /* Two lines, so that method x, column s_fn and method x_s, column fn do not meet. */
        snprintf(prefix, sizeof prefix, "%.*s%s", NAME_LENGTH, forces->method,
                 memchr(forces->method, '_', strnlen(forces->method, NAME_LENGTH)) ? "__" : "_");
        result = link_cells(writer, group, prefix, &CONTACT_FORCES, &forces->contact);
        if (!result && forces->residual.count == packing->grains.count)
            result = put_points(writer, group, prefix, &RESIDUALS, &forces->residual, points);
    }
    return result ? -1 : 0;
}

int vtk_write(struct state_writer *writer, const struct packing *packing)
{
    struct view view;
    if (view_alloc(packing, &view))
        return -1;
    view_fill(packing, &view);
    hid_t group = state_group(writer, "VTKHDF");
    int result = group < 0 || put_header(writer, group) || put_geometry(writer, group, &view);
    if (group >= 0 && H5Gclose(group) < 0 && !result)
        result = state_write_failed(writer, "VTKHDF");
    if (!result)
        result = put_data(writer, packing, view.points);
    view_free(&view);
    return result ? -1 : 0;
}
