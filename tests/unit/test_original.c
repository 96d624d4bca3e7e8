/* Text files of the original programs, as they are described in their notes: which one it is is detected. */
#include "tests/check.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "tracker/original.h"

static const char *written(const char *name, const char *text)
{
    static char path[300];
    snprintf(path, sizeof path, "%s/%s", FILM_BINARY_DIR, name);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
    return path;
}

static struct photo_grains grains_of(const char *name, const char *text)
{
    struct photo_grains grains = {0};
    const char *path = written(name, text);
    assert_true(original_is_text(path));
    check_done(original_read_grains(path, &grains));
    assert_int_equal(grains.count, 2);
    return grains;
}

static void check_circle(const struct photo_grains *grains, size_t k, double x, double y, double radius)
{
    check_near(grains->x_px[k], x, 1e-9);
    check_near(grains->y_px[k], y, 1e-9);
    check_near(grains->radius_px[k], radius, 1e-9);
}

static void test_circles_from_both_files(void **state)
{
    (void)state;
    struct photo_grains plain = grains_of("grains.txt", "2\n\n310\t420\t0\t55\n1200\t900\t0\t14\n");
    check_circle(&plain, 0, 310, 420, 55);
    check_circle(&plain, 1, 1200, 900, 14);
    struct photo_grains dic = grains_of("dic_out_3.txt", "2\n"
                                                         "310 420 0 55.5 1.5 -2 0.1 0.5 0.25 0.01 0.9 0.9 0.99\n"
                                                         "1200 900 0 14 nan nan nan nan nan nan nan nan nan\n"
                                                         "\n# 0 3\n# yesterday\n");
    check_circle(&dic, 0, 310, 420, 55.5);
    struct photo_grains *all[] = {&plain, &dic};
    for (int k = 0; k < 2; k++)
        table_free(&PHOTO_GRAINS, all[k]);
}

/* refx refy is the rounded centre: the motion written is that of the material there. */
static void test_motions(void **state)
{
    (void)state;
    const double x = 310.3, y = 419.6, u = 1.25, v = -2.5, angle = 0.1, c = cos(angle), s = sin(angle);
    double ox = 310 - x, oy = 420 - y;
    char text[600];
    snprintf(text, sizeof text,
             "2\n310 420 0 55 %.15e %.15e %.15e 0.5 0.25 0.01 1 1 1\n1200 900 0 14 nan nan nan nan nan nan 0 0 0\n",
             x + u + c * ox + s * oy - 310, y + v - s * ox + c * oy - 420, angle);
    struct photo_grains reference = grains_of("grains.txt", "2\n310 420 0 55\n1200 900 0 14\n"), previous = {0};
    reference.x_px[0] = x;
    reference.y_px[0] = y;
    check_done(original_read_motion(written("dic_out_4.txt", text), 0, &reference, &previous));
    check_near(previous.x_seen_px[0], x + u, 1e-9);
    check_near(previous.y_seen_px[0], y + v, 1e-9);
    check_near(previous.x_px[0], x + u, 1e-9);
    check_near(previous.angle_seen[0], angle, 1e-12);
    check_near(previous.dx_px[0], 0.5, 0);
    check_near(previous.dangle[0], 0.01, 0);
    assert_true(isnan(previous.x_seen_px[1]) && isnan(previous.angle_seen[1]));
    table_free(&PHOTO_GRAINS, &previous);
    check_done(original_read_motion(written("dic_out_4.txt", text), 1, &reference, &previous));
    check_near(previous.x_seen_px[0], x + u, 1e-9);
    assert_true(isnan(previous.x_px[0])); /* lens or camera are undone here, not there */
    table_free(&PHOTO_GRAINS, &previous);
    table_free(&PHOTO_GRAINS, &reference);
}

static void test_bad_files_are_refused(void **state)
{
    (void)state;
    static const char *const texts[] = {
        "3\n1 2 0 4\n5 6 0 7\n", "2\n1 2 3 4 5\n1 2 3 4 5\n", "2\n1 2 0 4\n1 2 0\n", "2\n1 2 0 x\n1 2 0 4\n", "0\n",
        "2.5\n1 2 0 4\n",        "99999999999\n1 2 0 4\n",    "1\n1 2 3 4 5 6\n"};
    struct photo_grains grains = {0};
    for (size_t k = 0; k < sizeof texts / sizeof *texts; k++) {
        assert_int_equal(original_read_grains(written("bad.txt", texts[k]), &grains), -1);
        assert_int_equal(error_status(), EXIT_INPUT);
    }
    assert_int_equal(original_read_grains(written("CONF", "1\n1 2 0 4\n#CORNERS 4\n"), &grains), -1);
    assert_non_null(strstr(error_message(), "CONF"));
    assert_false(original_is_text(written("state", "\x89HDF")));
    assert_false(original_is_text("not/there"));
}

/* What people do to lists by hand: lines added under an old count, a grain twice, an editor's byte order mark. */
static void test_lists_edited_by_hand(void **state)
{
    (void)state;
    struct photo_grains grains = {0};
    assert_int_equal(original_read_grains(written("long.txt", "2\n1 2 0 4\n5 6 0 7\n\n8 9 0 7\n"), &grains), -1);
    assert_non_null(strstr(error_message(), "line 5: there are more grains than the 2"));
    assert_int_equal(original_read_grains(written("twice.txt", "3\n1 2 0 4\n5 6 0 7\n1 2 0 5\n"), &grains), -1);
    assert_non_null(strstr(error_message(), "grains 0 and 2 have the same centre"));
    grains = grains_of("mark.txt", "\xEF\xBB\xBF"
                                   "2\r\n1 2 0 4\r\n1 3 0 7\r\n\r\n");
    check_circle(&grains, 1, 1, 3, 7);
    table_free(&PHOTO_GRAINS, &grains);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_circles_from_both_files),
        cmocka_unit_test(test_motions),
        cmocka_unit_test(test_bad_files_are_refused),
        cmocka_unit_test(test_lists_edited_by_hand),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
