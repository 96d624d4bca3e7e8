/* Packings: written and read back, the view for ParaView consistent with the tables, broken ones refused. */
#include "tests/check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <hdf5.h>

#include "pipeline/speak/error.h"
#include "pipeline/packing/packing_file.h"

static char folder[] = "/tmp/test_packing.XXXXXX";

static char *place(const char *name)
{
    static char path[4][256];
    static int next;
    next = (next + 1) % 4;
    snprintf(path[next], sizeof path[next], "%s/%s", folder, name);
    return path[next];
}

/* Three grains in a corner: contacts 0-1, 1-2, 0-bottom, 2-disc. */
static void make_packing(struct packing *p, int with_walls)
{
    static const int64_t i[] = {0, 1, 0, 2}, j[] = {1, 2, 3, 4};
    static const double nx[] = {1, 0.6, 0, 0.8}, ny[] = {0, 0.8, -1, 0.6};
    size_t contacts = with_walls ? 4 : 2;
    memset(p, 0, sizeof *p);
    p->length_m = 0.06;
    check_done(table_alloc(&GRAINS, &p->grains, 3, NULL));
    check_done(table_alloc(&WALLS, &p->walls, with_walls ? 2 : 0, NULL));
    check_done(table_alloc(&CONTACTS, &p->contacts, contacts, NULL));
    for (int k = 0; k < 3; k++) {
        p->grains.x[k] = 0.02 * k - (k == 2) * 0.008;
        p->grains.y[k] = (k == 2) * 0.016;
        p->grains.radius[k] = 0.01;
        p->grains.mass[k] = 0.1;
        p->grains.inertia[k] = 1e-5;
    }
    for (size_t c = 0; c < contacts; c++) {
        p->contacts.i[c] = i[c], p->contacts.j[c] = j[c];
        p->contacts.nx[c] = nx[c], p->contacts.ny[c] = ny[c];
        p->contacts.x[c] = p->grains.x[i[c]] + 0.01 * nx[c], p->contacts.y[c] = p->grains.y[i[c]] + 0.01 * ny[c];
        p->contacts.overlap[c] = 1e-5;
    }
    if (with_walls) {
        strcpy(p->walls.name[0], "bottom");
        p->walls.x0[0] = -0.1, p->walls.y0[0] = -0.01, p->walls.x1[0] = 0.1, p->walls.y1[0] = -0.01;
        p->walls.radius[0] = 0;
        strcpy(p->walls.name[1], "bottom-right");
        p->walls.x0[1] = 0.056, p->walls.y0[1] = 0.034, p->walls.radius[1] = 0.02;
    }
    p->forces = calloc(2, sizeof *p->forces);
    p->force_count = 2;
    for (int f = 0; f < 2; f++) {
        struct forces *forces = &p->forces[f];
        strcpy(forces->method, f ? "qsm" : "cem");
        strcpy(forces->start, "zero");
        forces->iterations = 17 + f;
        forces->converged = 1;
        forces->imbalance = 1e-9;
        forces->stress[0][1] = 4;
        forces->kn = 1e7, forces->kt = 2e7, forces->mu = 0.5;
        forces->misfit[0] = f ? -2.5 : NAN, forces->misfit[1] = f ? 0 : NAN;
        forces->data_misfit = f ? 1.75 : 0;
        check_done(table_alloc(&CONTACT_FORCES, &forces->contact, contacts, NULL));
        check_done(table_alloc(&RESIDUALS, &forces->residual, 3, NULL));
        for (size_t c = 0; c < contacts; c++)
            forces->contact.fn[c] = 100 * f + (double)c, forces->contact.ft[c] = -(double)c;
        forces->residual.residual_x[1] = 0.25;
        if (f) {
            check_done(table_alloc(&SOFTEST, &forces->softest, 3, NULL));
            forces->softest.soft_m[2] = -0.5, forces->stability[0] = 0.01, forces->stability[1] = -0.002;
        }
    }
}

static int write_packing(const char *path, const struct packing *p)
{
    struct provenance provenance = PROVENANCE_DEFAULT;
    provenance.stage = "forces";
    return packing_write(path, p, &provenance);
}

static void test_round_trip(void **unused)
{
    (void)unused;
    struct packing p, q;
    make_packing(&p, 1);
    check_done(write_packing(place("a.hdf"), &p));
    check_done(packing_read(place("a.hdf"), &q));
    assert_int_equal(q.grains.count, 3);
    assert_int_equal(q.walls.count, 2);
    assert_int_equal(q.contacts.count, 4);
    assert_int_equal(q.force_count, 2);
    check_near(q.length_m, 0.06, 0);
    assert_string_equal(q.info.coordinates, "si");
    assert_memory_equal(q.contacts.j, p.contacts.j, 4 * sizeof *p.contacts.j);
    assert_memory_equal(q.walls.name, p.walls.name, 2 * NAME_LENGTH);
    assert_null(packing_forces(&q, "map"));
    const struct forces *qsm = packing_forces(&q, "qsm");
    assert_non_null(qsm);
    check_near(qsm->contact.fn[3], 103, 0);
    assert_true(isnan(qsm->contact.s_fn[3]));
    check_near(qsm->residual.residual_x[1], 0.25, 0);
    assert_int_equal(qsm->iterations, 18);
    assert_int_equal(qsm->converged, 1);
    assert_string_equal(qsm->start, "zero");
    check_near(qsm->stress[0][1], 4, 0);
    check_near(qsm->kt, 2e7, 0);
    check_near(qsm->misfit[0], -2.5, 0);
    check_near(qsm->misfit[1], 0, 0);
    check_near(qsm->data_misfit, 1.75, 0);
    assert_true(isnan(packing_forces(&q, "cem")->misfit[0]));
    assert_int_equal(packing_forces(&q, "cem")->softest.count, 0);
    assert_int_equal(qsm->softest.count, 3);
    check_near(qsm->softest.soft_m[2], -0.5, 0);
    check_near(qsm->stability[0], 0.01, 0);
    check_near(qsm->stability[1], -0.002, 0);
    packing_free(&p);
    packing_free(&q);
    packing_free(&q);
}

static void test_branches(void **unused)
{
    (void)unused;
    struct packing p;
    make_packing(&p, 1);
    static const double expected[4][2] = {{0.02, 0}, {0.012, 0.016}, {0, -0.01}, {0.056 - 0.032, 0.034 - 0.016}};
    for (size_t c = 0; c < 4; c++) {
        struct vec branch = packing_branch(&p, c);
        check_near(branch.x, expected[c][0], 1e-15);
        check_near(branch.y, expected[c][1], 1e-15);
    }
    packing_free(&p);
}

static void read_dataset(hid_t file, const char *name, hid_t type, hsize_t expected, void *values)
{
    hid_t dataset = H5Dopen2(file, name, H5P_DEFAULT);
    if (dataset < 0)
        fail_msg("%s is missing", name);
    hid_t space = H5Dget_space(dataset);
    assert_int_equal(H5Sget_simple_extent_npoints(space), expected);
    assert_true(H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
    H5Sclose(space);
    H5Dclose(dataset);
}

static int same_object(hid_t file, const char *a, const char *b)
{
    H5O_info_t first, second;
    assert_true(H5Oget_info_by_name1(file, a, &first, H5P_DEFAULT) >= 0);
    assert_true(H5Oget_info_by_name1(file, b, &second, H5P_DEFAULT) >= 0);
    return first.addr == second.addr;
}

/* Points: three grains, the foot of grain 0 on the bottom wall, the corner disc's centre. */
static void test_view_with_walls(void **unused)
{
    (void)unused;
    struct packing p;
    make_packing(&p, 1);
    check_done(write_packing(place("view.hdf"), &p));
    packing_free(&p);
    hid_t file = H5Fopen(place("view.hdf"), H5F_ACC_RDONLY, H5P_DEFAULT);
    double points[5][3], radius[5];
    int64_t connectivity[8], offsets[5], count;
    uint8_t types[4];
    read_dataset(file, "/VTKHDF/Points", H5T_NATIVE_DOUBLE, 15, points);
    read_dataset(file, "/VTKHDF/Connectivity", H5T_NATIVE_INT64, 8, connectivity);
    read_dataset(file, "/VTKHDF/Offsets", H5T_NATIVE_INT64, 5, offsets);
    read_dataset(file, "/VTKHDF/Types", H5T_NATIVE_UINT8, 4, types);
    read_dataset(file, "/VTKHDF/PointData/radius", H5T_NATIVE_DOUBLE, 5, radius);
    read_dataset(file, "/VTKHDF/NumberOfConnectivityIds", H5T_NATIVE_INT64, 1, &count);
    assert_int_equal(count, 8);
    static const int64_t lines[] = {0, 1, 1, 2, 0, 3, 2, 4}, ends[] = {0, 2, 4, 6, 8};
    assert_memory_equal(connectivity, lines, sizeof lines);
    assert_memory_equal(offsets, ends, sizeof ends);
    for (int c = 0; c < 4; c++)
        assert_int_equal(types[c], 3);
    check_near(points[3][0], 0, 1e-15);
    check_near(points[3][1], -0.01, 1e-15);
    check_near(points[4][0], 0.056, 0);
    check_near(radius[2], 0.01, 0);
    assert_true(isnan(radius[3]) && isnan(radius[4]));
    assert_true(same_object(file, "/VTKHDF/CellData/qsm_fn", "/forces/qsm/fn"));
    assert_true(same_object(file, "/VTKHDF/CellData/overlap", "/contacts/overlap"));
    assert_false(same_object(file, "/VTKHDF/PointData/radius", "/grains/radius"));
    H5Fclose(file);
}

static void test_view_without_walls(void **unused)
{
    (void)unused;
    struct packing p;
    make_packing(&p, 0);
    check_done(write_packing(place("free.hdf"), &p));
    packing_free(&p);
    hid_t file = H5Fopen(place("free.hdf"), H5F_ACC_RDONLY, H5P_DEFAULT);
    assert_true(same_object(file, "/VTKHDF/PointData/radius", "/grains/radius"));
    assert_true(same_object(file, "/VTKHDF/PointData/cem_residual_x", "/forces/cem/residual_x"));
    H5Fclose(file);
    check_done(packing_read(place("free.hdf"), &p));
    assert_int_equal(p.walls.count, 0);
    packing_free(&p);
}

static void test_no_contacts(void **unused)
{
    (void)unused;
    struct packing p = {.length_m = NAN};
    check_done(table_alloc(&GRAINS, &p.grains, 0, NULL));
    check_done(table_alloc(&CONTACTS, &p.contacts, 0, NULL));
    check_done(write_packing(place("none.hdf"), &p));
    packing_free(&p);
    check_done(packing_read(place("none.hdf"), &p));
    assert_int_equal(p.contacts.count, 0);
    packing_free(&p);
}

static void assert_refused(struct packing *p, const char *word)
{
    struct packing q;
    char *path = place("broken.hdf");
    check_done(write_packing(path, p));
    packing_free(p);
    assert_int_equal(packing_read(path, &q), -1);
    assert_int_equal(error_status(), EXIT_INPUT);
    if (!strstr(error_message(), word) || !strstr(error_message(), path))
        fail_msg("'%s' is not in: %s", word, error_message());
    assert_null(q.grains.x);
}

static void test_refused(void **unused)
{
    (void)unused;
    struct packing p;
    make_packing(&p, 1);
    p.contacts.i[1] = -1;
    assert_refused(&p, "contact 1");
    make_packing(&p, 0); /* nothing was broken: reads */
    check_done(write_packing(place("whole.hdf"), &p));
    packing_free(&p);
    check_done(packing_read(place("whole.hdf"), &p));
    p.contacts.nx[1] = 0.7;
    assert_refused(&p, "unit normal");
    make_packing(&p, 1);
    p.contacts.x[2] = NAN;
    assert_refused(&p, "contact 2");
    make_packing(&p, 1);
    p.grains.radius[1] = NAN;
    assert_refused(&p, "grain 1");
    make_packing(&p, 1);
    p.forces[1].contact.count = 3;
    assert_refused(&p, "3 forces for 4 contacts");
    make_packing(&p, 1);
    free(p.grains.mass);
    p.grains.mass = NULL;
    assert_refused(&p, "/grains/mass");
    make_packing(&p, 1);
    p.grains.mass[2] = -0.1;
    assert_refused(&p, "grain 2 has a mass");
    make_packing(&p, 1);
    p.grains.inertia[0] = INFINITY;
    assert_refused(&p, "grain 0 has a mass");
    make_packing(&p, 1);
    p.walls.radius[1] = INFINITY;
    assert_refused(&p, "wall 1");
    make_packing(&p, 1);
    p.walls.x0[0] = -1e300;
    assert_refused(&p, "wall 0");
    make_packing(&p, 1);
    p.forces[1].softest.count = 2;
    assert_refused(&p, "2 motions for 3 grains");
    make_packing(&p, 1);
    check_done(table_alloc(&RAYS, &p.forces[0].ray, 4, NULL));
    assert_refused(&p, "4 rays for 3 grains");
}

/* x with s_fn, and x_s with fn: both would be x_s_fn to ParaView. */
static void test_methods_that_meet(void **unused)
{
    (void)unused;
    struct packing p, q;
    make_packing(&p, 1);
    strcpy(p.forces[0].method, "x");
    strcpy(p.forces[1].method, "x_s");
    check_done(write_packing(place("meet.hdf"), &p));
    check_done(packing_read(place("meet.hdf"), &q));
    assert_non_null(packing_forces(&q, "x_s"));
    packing_free(&p);
    packing_free(&q);
}

/* What would be refused in a plain row is data in a flagged one. */
static void test_flagged_rows(void **unused)
{
    (void)unused;
    struct packing p, q;
    make_packing(&p, 0);
    p.grains.x[1] = NAN;
    p.grains.flags[1] = GRAIN_LOST;
    p.contacts.nx[0] = NAN;
    p.contacts.flags[0] = CONTACT_NOT_FINITE;
    check_done(write_packing(place("flagged.hdf"), &p));
    check_done(packing_read(place("flagged.hdf"), &q));
    assert_true(isnan(q.grains.x[1]));
    packing_free(&p);
    packing_free(&q);
}

static int make_folder(void **unused)
{
    (void)unused;
    return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **unused)
{
    (void)unused;
    char command[300];
    snprintf(command, sizeof command, "rm -rf '%s'", folder);
    return system(command);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_round_trip),      cmocka_unit_test(test_branches),
        cmocka_unit_test(test_view_with_walls), cmocka_unit_test(test_view_without_walls),
        cmocka_unit_test(test_no_contacts),     cmocka_unit_test(test_refused),
        cmocka_unit_test(test_flagged_rows),    cmocka_unit_test(test_methods_that_meet),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
