/* What the tracker says of its results, from outcomes made up here: flags, errors behind a lens, camera and grains. */
#include "tests/check.h"

#include <math.h>
#include <stdlib.h>

#include "tracker/follow/correct.h"
#include "tracker/follow/tracks.h"
#include "tracker/search/consistency.h"

/* A strong lens, so that its derivatives are far from 1. */
static const struct lens lens = {.centre = {100, 80}, .k = {4e-6, 0, 0}, .p = {2e-5, -1e-5, 0}};

/* Variances of a corrected place by its definition: the corrected position moved by what the seen one errs by. */
static void test_errors_behind_a_lens(void **state)
{
    (void)state;
    const struct shape shape = {.cx = 250, .cy = 190, .radius = 20};
    const double step = 1e-4;
    struct fit fit = {.motion = {1, -2, 0.1}, .covariance = {{4e-4, 2e-4, 0}, {2e-4, 9e-4, 0}, {0, 0, 1e-6}}};
    struct corrected body = correct_lens(&lens, &shape, &fit);
    struct vec at = vec(251, 188);
    struct vec dx = vec_scale(0.5 / step, vec_sub(lens_corrected(&lens, vec_add(at, vec(step, 0))),
                                                  lens_corrected(&lens, vec_sub(at, vec(step, 0)))));
    struct vec dy = vec_scale(0.5 / step, vec_sub(lens_corrected(&lens, vec_add(at, vec(0, step))),
                                                  lens_corrected(&lens, vec_sub(at, vec(0, step)))));
    check_near(body.xx, dx.x * dx.x * 4e-4 + 2 * dx.x * dy.x * 2e-4 + dy.x * dy.x * 9e-4, 1e-9);
    check_near(body.yy, dx.y * dx.y * 4e-4 + 2 * dx.y * dy.y * 2e-4 + dy.y * dy.y * 9e-4, 1e-9);
    /* A small circle becomes an ellipse of the same area as the lens makes of areas. */
    struct stretch stretch = correct_stretch(&lens, at.x, at.y);
    check_near(stretch.magnification, sqrt(dx.x * dy.y - dx.y * dy.x), 1e-8);
    assert_true(fabs(stretch.magnification - 1) > 0.1);
}

/* Ten matches that are alike in noise: one with 2.9 times the usual noise stays, one with 3.1 times is put in doubt,
 * unless its ZNCC is beyond doubt. */
static void test_noisy_matches_are_doubted(void **state)
{
    (void)state;
    struct outcome outcomes[12] = {{0}};
    for (int k = 0; k < 12; k++) {
        outcomes[k].found = 2;
        outcomes[k].fit.zncc = 0.9;
        outcomes[k].fit.noise = 100;
    }
    outcomes[3].fit.noise = 290;
    outcomes[5].fit.noise = 310;
    outcomes[7].fit.noise = 310, outcomes[7].fit.zncc = 0.96;
    consistency_demote(outcomes, 12);
    for (int k = 0; k < 12; k++)
        assert_int_equal(outcomes[k].found, k == 5 ? 1 : 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_errors_behind_a_lens),
        cmocka_unit_test(test_noisy_matches_are_doubted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
