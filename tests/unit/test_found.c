/* report found: what a file of findgrains says becomes a piece of a scene that a scene reads. */
#include "tests/check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "pipeline/speak/error.h"
#include "pipeline/packing/grains.h"
#include "pipeline/scene/scene.h"
#include "pipeline/state/state.h"
#include "report/compare/found.h"

static char folder[] = "/tmp/test_found.XXXXXX", path[64], scene_path[64];

/* Radii 7.2, 20.3 and 9 px, the first one flagged. found: NULL: no such attribute. */
static void write_grains(const char *found, const char *parameters)
{
    static const char *const names[] = {"x_px", "y_px", "radius_px", "flags", NULL};
    struct photo_grains grains;
    struct provenance provenance = PROVENANCE_DEFAULT;
    provenance.stage = "findgrains";
    provenance.coordinates = "seen";
    provenance.parameters = parameters;
    check_done(table_alloc(&PHOTO_GRAINS, &grains, 3, names));
    for (int k = 0; k < 3; k++)
        grains.x_px[k] = grains.y_px[k] = 100 * k;
    grains.radius_px[0] = 7.2, grains.radius_px[1] = 20.3, grains.radius_px[2] = 9;
    grains.flags[0] = GRAIN_CUT;
    struct state_writer *writer = state_create(path, &provenance);
    assert_non_null(writer);
    check_done(state_write(writer, "grains", &PHOTO_GRAINS, &grains));
    if (found)
        check_done(state_write_text(writer, "grains", "found", found));
    check_done(state_commit(writer));
    table_free(&PHOTO_GRAINS, &grains);
}

static void frame_and_radii(void **state)
{
    struct found found;
    struct scene scene = {0};
    (void)state;
    write_grains("{\"noise\":3,\"frame\":{\"corners_px\":[[4.004,1.5],[203.126,1],[200,99.998],[4,100]],"
                 "\"s_corners_px\":[[1,1],[1,1],[1,1],[1,1]],\"corner_radius_px\":12.34,\"touching\":[9,9,9,9]}}",
                 "{\"shape\":\"auto\"}");
    check_done(found_read(path, &found));
    assert_int_equal(found.frame_given, 0);
    char *text = found_print(&found);
    assert_string_equal(text, "\"frame\": {\"corners_px\": [[4.00, 1.50], [203.13, 1.00], [200.00, 100.00], [4.00, "
                              "100.00]], \"corner_radius_px\": 12.3},\n\"grains\": {\"radius_px\": [9, 21]}");
    FILE *file = fopen(scene_path, "w");
    assert_non_null(file);
    fprintf(file, "{\"schema\": \"film.scene/1\", \"name\": \"a\",\n%s}\n", text);
    fclose(file);
    check_done(scene_read(scene_path, &scene));
    assert_true(scene.frame.given);
    check_near(scene.frame.corners_px[1].x, 203.13, 1e-12);
    check_near(scene.frame.corner_radius_px, 12.3, 1e-12);
    check_near(scene.grains.radius_max_px, 21, 0);
    scene_free(&scene);
    free(text);
}

static void radii_alone(void **state)
{
    struct found found;
    (void)state;
    for (int given = 0; given < 2; given++) {
        write_grains("{\"noise\":3}", given ? "{\"frame\":{\"corners_px\":[]}}" : "{}");
        check_done(found_read(path, &found));
        assert_int_equal(found.has_frame, 0);
        assert_int_equal(found.frame_given, given);
        char *text = found_print(&found);
        assert_string_equal(text, "\"grains\": {\"radius_px\": [9, 21]}");
        free(text);
    }
    struct found nothing = {.least_radius = NAN, .largest_radius = NAN};
    char *text = found_print(&nothing);
    assert_string_equal(text, "");
    free(text);
}

static void other_files_are_refused(void **state)
{
    static const char *const wrong[] = {NULL, "[1", "{\"frame\":3}", "{\"frame\":{\"corners_px\":[[1,2],[3,4]]}}",
                                        "{\"frame\":{\"corners_px\":[[1,2],[3,4],[5,6],[7]]}}"};
    struct found found;
    (void)state;
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
        write_grains(wrong[k], "{}");
        assert_int_equal(found_read(path, &found), -1);
        assert_int_equal(error_status(), EXIT_INPUT);
        assert_non_null(strstr(error_message(), path));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frame_and_radii),
        cmocka_unit_test(radii_alone),
        cmocka_unit_test(other_files_are_refused),
    };
    if (!mkdtemp(folder))
        return 1;
    snprintf(path, sizeof path, "%s/a.grains.hdf", folder);
    snprintf(scene_path, sizeof scene_path, "%s/scene.json", folder);
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    remove(path);
    remove(scene_path);
    remove(folder);
    return failed;
}
