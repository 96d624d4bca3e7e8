/* A packing that contradicts itself is refused in one line, whichever way it does. */
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <hdf5.h>

#include "pipeline/packing/packing_check.h"
#include "pipeline/packing/packing_file.h"
#include "pipeline/speak/error.h"
#include "tests/check.h"
#include "tests/touch.h"

/* Three discs of radius 1 cm in a row on a floor: 0-1, 1-2, and each on the wall. */
static void make_row(struct packing *p)
{
    static const int64_t i[] = {0, 1, 0, 1, 2}, j[] = {1, 2, 3, 3, 3};
    memset(p, 0, sizeof *p);
    p->length_m = 0.06;
    check_done(table_alloc(&GRAINS, &p->grains, 3, NULL));
    check_done(table_alloc(&WALLS, &p->walls, 1, NULL));
    check_done(table_alloc(&CONTACTS, &p->contacts, 5, NULL));
    for (int k = 0; k < 3; k++) {
        p->grains.x[k] = 0.01999 * k, p->grains.y[k] = 0.00999, p->grains.radius[k] = 0.01;
        p->grains.mass[k] = 0.1, p->grains.inertia[k] = 1e-5;
        p->grains.s_x[k] = p->grains.s_y[k] = 1e-6;
    }
    strcpy(p->walls.name[0], "bottom");
    p->walls.x0[0] = -1, p->walls.x1[0] = 1, p->walls.y0[0] = p->walls.y1[0] = p->walls.radius[0] = 0;
    p->walls.fy[0] = 10;
    for (int c = 0; c < 5; c++)
        p->contacts.i[c] = i[c], p->contacts.j[c] = j[c];
    touch(p);
}

static void twice(struct packing *p)
{
    p->contacts.i[1] = 0, p->contacts.j[1] = 1;
    touch(p);
}

static void reversed(struct packing *p)
{
    p->contacts.nx[1] *= -1, p->contacts.ny[1] *= -1;
}

static void far_point(struct packing *p)
{
    p->contacts.y[3] += 0.05;
}

static void other_overlap(struct packing *p)
{
    p->contacts.overlap[0] += 0.004; /* its point, too, else that is refused first */
    p->contacts.x[0] -= 0.002;
}

static void no_length(struct packing *p)
{
    p->length_m = 0;
}

static void negative_error(struct packing *p)
{
    p->grains.s_y[2] = -1e-6;
}

static void endless_load(struct packing *p)
{
    p->walls.fy[0] = INFINITY;
}

static void each_contradiction_is_named(void **state)
{
    static const struct {
        void (*spoil)(struct packing *p);
        const char *words;
    } cases[] = {
        {twice, "contacts 0 and 1 both join 0 and 1"},
        {reversed, "the normal of contact 1 points 180 degrees"},
        {far_point, "the point of contact 3 lies 0.05 m"},
        {other_overlap, "contact 0 has an overlap of 0.00401 m"},
        {no_length, "length of 0 m"},
        {negative_error, "column /grains/s_y has a standard error below 0 in row 2"},
        {endless_load, "column /walls/fy has an infinite load in row 0"},
    };
    struct packing p;
    (void)state;
    make_row(&p);
    check_done(packing_check("row.hdf", &p));
    packing_free(&p);
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        make_row(&p);
        cases[k].spoil(&p);
        assert_int_equal(packing_check("row.hdf", &p), -1);
        assert_int_equal(error_status(), EXIT_INPUT);
        if (!strstr(error_message(), cases[k].words) || strncmp(error_message(), "row.hdf: ", 9))
            fail_msg("'%s' does not say '%s'", error_message(), cases[k].words);
        packing_free(&p);
    }
}

/* What is flagged or not known contradicts nothing. */
static void flagged_rows_may_be_anything(void **state)
{
    struct packing p;
    (void)state;
    make_row(&p);
    p.contacts.flags[1] = CONTACT_NOT_FINITE, p.contacts.nx[1] = -1;
    p.grains.flags[0] = GRAIN_NOT_FINITE, p.grains.x[0] = 5;
    p.length_m = NAN, p.walls.fy[0] = NAN, p.grains.s_x[1] = NAN;
    check_done(packing_check("row.hdf", &p));
    packing_free(&p);
}

static void permuted_rows_are_other_grains(void **state)
{
    struct packing now, previous;
    (void)state;
    make_row(&now), make_row(&previous);
    now.grains.radius[0] = previous.grains.radius[0] = 0.02;
    check_done(packing_check_previous("before.hdf", &previous, &now));
    previous.grains.radius[0] = 0.01, previous.grains.radius[2] = 0.02;
    assert_int_equal(packing_check_previous("before.hdf", &previous, &now), -1);
    assert_non_null(strstr(error_message(), "before.hdf: 2 of 3 rows are grains of another radius"));
    previous.grains.flags[0] = previous.grains.flags[2] = GRAIN_NOT_FINITE;
    check_done(packing_check_previous("before.hdf", &previous, &now));
    packing_free(&now), packing_free(&previous);
}

/* What is read is checked, and the units of its columns with it. */
static void what_is_read_is_checked(void **state)
{
    char path[] = "/tmp/test_packing_check.XXXXXX";
    struct provenance provenance = PROVENANCE_DEFAULT;
    struct packing p, q;
    (void)state;
    close(mkstemp(path));
    provenance.stage = "contacts", provenance.coordinates = "si";
    make_row(&p);
    check_done(packing_write(path, &p, &provenance));
    check_done(packing_read(path, &q));
    packing_free(&q);
    hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT), column = H5Dopen2(file, "grains/x", H5P_DEFAULT);
    hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
    H5Tset_size(type, 2);
    assert_true(H5Adelete(column, "units") >= 0);
    hid_t units = H5Acreate2(column, "units", type, space, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(H5Awrite(units, type, "mm") >= 0);
    H5Aclose(units), H5Sclose(space), H5Tclose(type), H5Dclose(column), H5Fclose(file);
    assert_int_equal(packing_read(path, &q), -1);
    assert_non_null(strstr(error_message(), "column /grains/x is in 'mm', not in 'm'"));
    reversed(&p);
    check_done(packing_write(path, &p, &provenance));
    assert_int_equal(packing_read(path, &q), -1);
    assert_non_null(strstr(error_message(), "normal of contact 1"));
    packing_free(&p);
    unlink(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_contradiction_is_named),
        cmocka_unit_test(flagged_rows_may_be_anything),
        cmocka_unit_test(permuted_rows_are_other_grains),
        cmocka_unit_test(what_is_read_is_checked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
