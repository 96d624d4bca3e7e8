/* `contacts` from outside on packings of touching discs that the test draws: radii read too small leave no contact, and
 * that is said; a previous state whose rows are other grains is refused. */
#include "tests/commands.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/packing/grains.h"
#include "pipeline/state/state.h"
#include "tests/discs.h"

enum { MOST = 400, SIDE = 900 };

/* Every disc touches two others. Returns how many. */
static size_t write_discs(const char *path, int side, double radius_error, int64_t index, int backwards)
{
    static struct disc discs[MOST];
    double radii[MOST];
    struct photo_grains grains = {0};
    static const char *const columns[] = {"x_px", "y_px", "radius_px", "s_x", "s_y", "s_radius", "flags", NULL};
    struct provenance provenance = PROVENANCE_DEFAULT;
    for (int k = 0; k < MOST; k++)
        radii[k] = 20 + 10 * (k % 5) / 4.0;
    size_t count = discs_pack(side, side, radii, MOST, 10, 7, discs, MOST);
    check_done(table_alloc(&PHOTO_GRAINS, &grains, count, columns));
    for (size_t k = 0; k < count; k++) {
        const struct disc *disc = &discs[backwards ? count - 1 - k : k];
        grains.x_px[k] = disc->x, grains.y_px[k] = disc->y, grains.radius_px[k] = disc->radius + radius_error;
        grains.s_x[k] = grains.s_y[k] = grains.s_radius[k] = 0.05;
    }
    provenance.stage = "tracker", provenance.coordinates = "corrected", provenance.index = index;
    struct state_writer *writer = state_create(path, &provenance);
    assert_non_null(writer);
    check_done(state_write(writer, "grains", &PHOTO_GRAINS, &grains) || state_commit(writer));
    table_free(&PHOTO_GRAINS, &grains);
    return count;
}

static void write_scene(void)
{
    file_write("scene.json",
               "{\"schema\": \"film.scene/1\", \"name\": \"discs\", \"scale_m_per_px\": 4e-4, \"contact\": "
               "{\"law\": \"linear\", \"kn_N_per_m\": 1e7, \"mu\": 0.5}}");
}

#define CONTACTS "contacts --scene scene.json "

/* The number that stands after `word` in what was said. */
static double said(const char *word)
{
    const char *at = strstr(command_err, word);
    assert_non_null(at);
    return strtod(at + strlen(word), NULL);
}

static void lost_contacts_are_said(void **state)
{
    (void)state;
    char none[60];
    write_scene();
    size_t count = write_discs("small.hdf", SIDE, -0.8, 0, 0);
    snprintf(none, sizeof none, "small.contacts.hdf: 0 contacts of %zu grains: ", count);
    command_fails(4, none, CONTACTS "--quiet small.hdf -o small.contacts.hdf");
    assert_true(file_exists("small.contacts.hdf"));
    assert_true(said("grains: ") >= (double)count); /* pairs: two for each disc, and more */
    check_near(said("median gap is "), 1.6, 0.15);
    check_near(said("radius_offset_px (about "), 0.8, 0.08);
    command_fails(3, "small.contacts.hdf: no two of", "forces --scene scene.json small.contacts.hdf -o no.hdf");
    assert_null(strstr(command_err, "frame"));
    command_done(CONTACTS "--quiet --radius-offset 0.8 small.hdf -o good.contacts.hdf");
    command_fails(3, "give the scene a frame", "forces --scene scene.json good.contacts.hdf -o no.hdf");
}

static void an_undecided_correction_is_said(void **state)
{
    (void)state;
    write_scene();
    write_discs("few.hdf", 260, 0, 0, 0);
    command_done(CONTACTS "--quiet few.hdf -o few.contacts.hdf");
    command_fails(4, "undecided (too few pairs)", CONTACTS "--radius-offset auto few.hdf -o few.contacts.hdf");
    assert_non_null(strstr(command_err, "pairs are nearer than"));
    assert_non_null(strstr(command_err, "give contacts.radius_offset_px or radius_scale"));
}

static void a_previous_state_of_other_rows_is_refused(void **state)
{
    (void)state;
    write_scene();
    write_discs("0.hdf", SIDE, 0, 0, 0);
    write_discs("1.hdf", SIDE, 0, 1, 0);
    write_discs("2.hdf", SIDE, 0, 1, 1);
    write_discs("3.hdf", 260, 0, 1, 0);
    command_done(CONTACTS "--quiet 0.hdf -o 0.contacts.hdf");
    command_done(CONTACTS "--quiet --previous 0.contacts.hdf 1.hdf -o 1.contacts.hdf");
    command_fails(3, "row k must be grain k", CONTACTS "--previous 0.contacts.hdf 2.hdf -o no.hdf");
    command_fails(3, "give a state of the same grains", CONTACTS "--previous 0.contacts.hdf 3.hdf -o no.hdf");
    assert_false(file_exists("no.hdf"));
}

static void simulate_grades(const char *folder, const char *grading)
{
    char text[600];
    snprintf(text, sizeof text,
             "{\"schema\": \"film.scene/1\", \"name\": \"grades\", \"grains\": {\"density_kg_m3\": 730}, "
             "\"contact\": {\"law\": \"linear\", \"kn_N_per_m\": 1e7, \"kt_over_kn\": 1, \"mu\": 0.5}, "
             "\"simulation\": {\"grading\": [%s], \"kappa\": 300, \"test\": \"biaxial_vertical\", "
             "\"steps\": [[1, 4e-4]]}}",
             grading);
    file_write("grades.json", text);
    command_done("simulate --quiet --scene grades.json -o %s", folder);
}

static void so_do_forces(void **state)
{
    (void)state;
    simulate_grades("small_first", "[12, 0.008], [12, 0.012]");
    simulate_grades("large_first", "[12, 0.012], [12, 0.008]");
    command_run("forces --scene grades.json --method cdm --previous small_first/0000.truth.hdf "
                "small_first/0001.truth.hdf -o good.hdf");
    assert_true(file_exists("good.hdf"));
    command_fails(3, "large_first/0000.truth.hdf: 24 of 24 rows",
                  "forces --scene grades.json --method cdm --previous large_first/0000.truth.hdf "
                  "small_first/0001.truth.hdf -o no.hdf");
    assert_false(file_exists("no.hdf"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lost_contacts_are_said),
        cmocka_unit_test(an_undecided_correction_is_said),
        cmocka_unit_test(a_previous_state_of_other_rows_is_refused),
        cmocka_unit_test(so_do_forces),
    };
    return cmocka_run_group_tests(tests, folder_enter, folder_leave);
}
