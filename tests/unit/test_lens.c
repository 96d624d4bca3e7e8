/* The lens map: against the polynomial written out term by term, its inverse, its derivatives, its file. */
#include "tests/check.h"

#include <stdio.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/scene/lens.h"

/* 8 px at the corners of a 10320 x 7752 photo. */
static const struct lens LENS = {{5100, 3900}, {-2.6e-10 * 0.12, 3e-19, -2e-27}, {4e-9, -3e-9, 2e-9}};

static void test_brown_term_by_term(void **state)
{
    (void)state;
    struct lens lens = {{10, 20}, {1e-3, 2e-5, 3e-7}, {4e-3, 5e-3, 6e-3}};
    struct vec seen = vec(13, 16), is = lens_corrected(&lens, seen); /* d = (3, -4), r = 5 */
    double radial = 1 + 0.025 + 0.0125 + 3e-7 * 15625, growth = 1 + 0.15;
    check_near(is.x, 10 + 3 * radial + (4e-3 * (25 + 18) + 2 * 5e-3 * -12) * growth, 1e-12);
    check_near(is.y, 20 - 4 * radial + (2 * 4e-3 * -12 + 5e-3 * (25 + 32)) * growth, 1e-12);
}

static void test_inverse_and_derivatives(void **state)
{
    (void)state;
    uint64_t seed = 3;
    for (int trial = 0; trial < 1000; trial++) {
        struct vec seen = vec(10320 * check_uniform(&seed), 7752 * check_uniform(&seed));
        struct vec back = lens_seen(&LENS, lens_corrected(&LENS, seen));
        check_near(back.x, seen.x, 1e-9);
        check_near(back.y, seen.y, 1e-9);
        double j[2][2], h = 0.5;
        lens_jacobian(&LENS, seen, j);
        struct vec e = lens_corrected(&LENS, vec(seen.x + h, seen.y)),
                   w = lens_corrected(&LENS, vec(seen.x - h, seen.y));
        struct vec s = lens_corrected(&LENS, vec(seen.x, seen.y + h)),
                   n = lens_corrected(&LENS, vec(seen.x, seen.y - h));
        check_near(j[0][0], e.x - w.x, 1e-9);
        check_near(j[1][0], e.y - w.y, 1e-9);
        check_near(j[0][1], s.x - n.x, 1e-9);
        check_near(j[1][1], s.y - n.y, 1e-9);
    }
    struct lens folded = {{0, 0}, {-1e-2, 0, 0}, {0, 0, 0}};
    assert_true(isnan(lens_seen(&folded, vec(1000, 0)).x));
}

static void write_text(const char *path, const char *text)
{
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

static void test_file(void **state)
{
    (void)state;
    const char *path = FILM_BINARY_DIR "/tests/test_lens.json";
    struct lens lens;
    write_text(path, "{\"schema\": \"film.lens/1\", \"map\": \"corrected from seen\", \"centre_px\": [1, 2], "
                     "\"K\": [3e-9, 4e-18, 5e-27], \"P\": [6e-7, 7e-7, 8e-9]}");
    check_done(lens_read(path, &lens));
    check_near(lens.centre.y, 2, 0);
    check_near(lens.k[2], 5e-27, 0);
    check_near(lens.p[0], 6e-7, 0);
    write_text(path, "{\"schema\": \"film.lens/1\", \"map\": \"seen from corrected\", \"centre_px\": [1, 2], "
                     "\"K\": [3e-9, 4e-18, 5e-27], \"P\": [6e-7, 7e-7, 8e-9]}");
    assert_int_equal(lens_read(path, &lens), -1); /* the other direction has other numbers */
    write_text(path, "{\"schema\": \"film.lens/1\", \"map\": \"corrected from seen\", \"centre_px\": [1, 2]}");
    assert_int_equal(lens_read(path, &lens), -1);
    assert_non_null(strstr(error_message(), "'K' is missing"));
    remove(path);
}

/* With K1 alone a side at height Y over the centre, seen from -X to X, is bent by K1 X^2 Y to first order. */
static void test_bend(void **state)
{
    (void)state;
    struct lens lens = {.centre = vec(5000, 4000), .k = {1e-11}};
    double bend = lens_bend(&lens, vec(1000, 1000), vec(9000, 1000));
    check_near(bend, 1e-11 * 4000 * 4000 * 3000.0, 0.01 * 0.48);
    check_near(lens_bend(&lens, vec(5000, 1000), vec(5000, 7000)), 0, 1e-9); /* through the centre: straight */
    check_near(lens_bend(&lens, vec(1000, 1000), vec(1000, 1000)), 0, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_brown_term_by_term),
                                       cmocka_unit_test(test_inverse_and_derivatives), cmocka_unit_test(test_file),
                                       cmocka_unit_test(test_bend)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
