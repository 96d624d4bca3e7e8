/* The contact problem for other solvers: read back with plain HDF5 and held against W = A' M^-1 A and q = A' M^-1 b,
 * worked out by hand for two grains side by side on a fixed floor. */
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include <hdf5.h>

#include "forces/questions/fclib.h"
#include "pipeline/speak/error.h"
#include "tests/unit/discs.h"

static void read_numbers(hid_t file, const char *name, hid_t type, hsize_t expected, void *values)
{
    hid_t data = H5Dopen2(file, name, H5P_DEFAULT);
    if (data < 0)
        fail_msg("%s is missing", name);
    hid_t space = H5Dget_space(data);
    assert_int_equal(H5Sget_simple_extent_npoints(space), expected);
    assert_true(H5Dread(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
    H5Sclose(space), H5Dclose(data);
}

static int read_integer(hid_t file, const char *name)
{
    int value;
    read_numbers(file, name, H5T_NATIVE_INT, 1, &value);
    return value;
}

/* Grains 0 and 1 of radius r and masses m and 3 m (the inertia is m r^2 / 2 each), both under their weight. Contacts:
 * 0: 0-1, normal (1, 0); 1: 0-floor; 2: 1-floor, normal (0, -1). Masses in the mean 2 m, lengths in r. */
static void two_grains(struct packing *packing)
{
    const double r = 0.01, m = 0.2;
    discs_begin(packing, 2);
    for (size_t k = 0; k < 2; k++) {
        disc_put(packing, k, 0.02 + 2 * r * (double)k, r, r);
        packing->grains.mass[k] = k ? 3 * m : m;
        packing->grains.inertia[k] = packing->grains.mass[k] * r * r / 2;
        packing->grains.load_y[k] = -9.81 * packing->grains.mass[k];
    }
    discs_box(packing, 1, 1, 0);
    discs_touch(packing, 1e-9);
    assert_int_equal(packing->contacts.count, 3);
}

/* What one unit of force in row 2 c (normal) or 2 c + 1 (tangential) does: on x, y, rotation (moments over r) of grain
 * 0, then of grain 1. A force on i is the opposite; t is n turned by +90 degrees. */
static const double acts[6][6] = {
    {-1, 0, 0, 1, 0, 0},   /* n = (1, 0) */
    {0, -1, -1, 0, 1, -1}, /* t = (0, 1): on 0 at its right side -1, on 1 at its left side +1 upwards */
    {0, 1, 0, 0, 0, 0},    /* n = (0, -1): the floor lifts grain 0 */
    {-1, 0, -1, 0, 0, 0},  /* t = (1, 0): on grain 0 the force (-1, 0) at its lowest point turns it by -1 */
    {0, 0, 0, 0, 1, 0},    {0, 0, 0, -1, 0, -1},
};
static const double inverse[6] = {2, 2, 4, 2.0 / 3, 2.0 / 3, 4.0 / 3}; /* 2 m / m, 2 m r^2 / (m r^2 / 2) ... */

static void check_matrix(hid_t file)
{
    int start[7], row[36], entries = read_integer(file, "/fclib_local/W/nzmax");
    double value[36], dense[6][6] = {{0}};
    assert_true(entries > 0 && entries <= 36);
    read_numbers(file, "/fclib_local/W/p", H5T_NATIVE_INT, 7, start);
    read_numbers(file, "/fclib_local/W/i", H5T_NATIVE_INT, (hsize_t)entries, row);
    read_numbers(file, "/fclib_local/W/x", H5T_NATIVE_DOUBLE, (hsize_t)entries, value);
    assert_int_equal(start[0], 0);
    assert_int_equal(start[6], entries);
    for (int column = 0; column < 6; column++)
        for (int at = start[column]; at < start[column + 1]; at++) {
            assert_true(row[at] >= 0 && row[at] < 6);
            assert_true(at == start[column] || row[at] > row[at - 1]);
            dense[row[at]][column] = value[at];
        }
    for (int a = 0; a < 6; a++)
        for (int b = 0; b < 6; b++) {
            double expected = 0;
            for (int d = 0; d < 6; d++)
                expected += acts[a][d] * inverse[d] * acts[b][d];
            check_near(dense[a][b], expected, 1e-12);
        }
}

static void matrix_by_hand(void **state)
{
    (void)state;
    struct packing packing;
    struct force_options options = FORCE_OPTIONS_DEFAULT;
    char path[] = "/tmp/test_fclib.XXXXXX";
    int handle = mkstemp(path);
    assert_true(handle >= 0);
    close(handle);
    options.law.mu = 0.4, options.law.mu_wall = 0.3;
    two_grains(&packing);
    check_done(fclib_write(path, &packing, &options));
    hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
    assert_true(file >= 0);
    assert_int_equal(read_integer(file, "/fclib_local/spacedim"), 2);
    assert_int_equal(read_integer(file, "/fclib_local/W/m"), 6);
    assert_int_equal(read_integer(file, "/fclib_local/W/n"), 6);
    assert_int_equal(read_integer(file, "/fclib_local/W/nz"), -1);
    check_matrix(file);

    /* q: gravity gives both grains the same velocity, -g in units of force over 2 m; only the floor contacts close. */
    double q[6], mu[3], fall;
    read_numbers(file, "/fclib_local/vectors/q", H5T_NATIVE_DOUBLE, 6, q);
    read_numbers(file, "/fclib_local/vectors/mu", H5T_NATIVE_DOUBLE, 3, mu);
    char text[600] = {0};
    double newton = 0, metre = 0;
    hid_t data = H5Dopen2(file, "/fclib_local/info/description", H5P_DEFAULT), type = H5Dget_type(data);
    assert_true(H5Tget_size(type) < sizeof text);
    assert_true(H5Dread(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text) >= 0);
    assert_int_equal(
        sscanf(strstr(text, "Units:"), "Units: r in %lf N, lengths (so rotations) in %lf m", &newton, &metre), 2);
    check_near(metre, 0.01, 1e-15);
    fall = 9.81 * 0.4 / newton;
    const double expected[6] = {0, 0, -fall, 0, -fall, 0};
    for (int k = 0; k < 6; k++)
        check_near(q[k], expected[k], 1e-12 * fall);
    check_near(mu[0], 0.4, 0);
    check_near(mu[1], 0.3, 0);
    H5Tclose(type), H5Dclose(data), H5Fclose(file);
    remove(path);
    packing_free(&packing);
}

/* 50000 contacts of one wall: W would have 10^10 entries, which is said before they are counted. */
static void wall_of_too_many_contacts(void **state)
{
    (void)state;
    enum { CONTACTS_OF_WALL = 50000 };
    double load = 1, inverse_mass = 1;
    struct network network = {.count = CONTACTS_OF_WALL, .dofs = 1, .load = &load, .inverse_mass = &inverse_mass};
    struct local_problem problem;
    network.contact = calloc(network.count, sizeof *network.contact);
    assert_non_null(network.contact);
    for (size_t c = 0; c < network.count; c++)
        network.contact[c] = (struct network_contact){.dof = {0, -1, -1, -1, -1, -1}, .n = {1}};
    assert_int_equal(local_problem_build(&network, &problem), -1);
    assert_int_equal(error_status(), EXIT_INPUT);
    free(network.contact);
}

/* With one loaded wall: a wall is a body that all its contacts share, of wall_mass mean masses. */
static void wall_joins_its_contacts(void **state)
{
    (void)state;
    struct packing packing;
    struct network network;
    struct local_problem problem;
    struct contact_law law = {.kn = NAN, .kt_over_kn = 1, .mu = 0.5};
    struct network_options options = {.wall_mass = 50};
    discs_square_lattice(&packing, 2, 2, 0.01, 30, 40);
    check_done(network_build(&packing, &law, &options, &network));
    check_done(local_problem_build(&network, &problem));
    int joined = 0;
    for (int column = 0; column < problem.rows; column += 2)
        for (int at = problem.start[column]; at < problem.start[column + 1]; at++) {
            size_t a = network.contact[column / 2].row, b = network.contact[problem.row[at] / 2].row;
            size_t top = 4 + (size_t)walls_find(&packing.walls, "top");
            if (a != b && problem.row[at] % 2 == 0 && packing.contacts.j[a] == (int64_t)top &&
                packing.contacts.j[b] == (int64_t)top) {
                check_near(problem.value[at], 1.0 / 50, 1e-15);
                joined++;
            }
        }
    assert_int_equal(joined, 2);
    local_problem_free(&problem);
    network_free(&network);
    packing_free(&packing);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(matrix_by_hand),
        cmocka_unit_test(wall_of_too_many_contacts),
        cmocka_unit_test(wall_joins_its_contacts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
