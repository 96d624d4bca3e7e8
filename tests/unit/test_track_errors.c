/* What the tracker says of its results, from outcomes made up here: flags, errors behind a lens, camera and grains. */
#include "tests/drawn_packing.h"

#include <math.h>
#include <stdlib.h>

#include "tracker/follow/correct.h"
#include "tracker/follow/tracks.h"
#include "tracker/search/consistency.h"
#include "tracker/search/icgn.h"

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

/* Noise that the camera has smoothed over 3 x 3 px, added to a photo. */
static void add_smooth_noise(struct photo *photo, double noise, uint64_t *seed)
{
    int width = photo->width, height = photo->height;
    double *white = calloc((size_t)(width * height), sizeof *white);
    assert_non_null(white);
    for (int k = 0; k < width * height; k++)
        white[k] = check_normal(seed);
    for (int y = 1; y < height - 1; y++)
        for (int x = 1; x < width - 1; x++) {
            double sum = 0;
            for (int k = 0; k < 9; k++)
                sum += white[(y + k / 3 - 1) * width + x + k % 3 - 1];
            photo->pixels[y * width + x] = (uint16_t)(photo->pixels[y * width + x] + noise * DOTS_WHITE * sum / 3);
        }
    free(white);
}

/* Smooth noise moves a match more than white noise of its size does; the stated error grows with it: over 60 matches of
 * a large grain error / stated is 1 within 35 %: sqrt(2 / 180) / 2 = 5 % is chance, and the prior draws towards white
 * noise. */
static void test_smooth_noise_is_seen(void **state)
{
    (void)state;
    enum { DRAWS = 60 };
    const double centre = 90, big = 60;
    double sum = 0;
    uint64_t seed = 5;
    struct dots dots = dots_make(1.25 * big + 6, DOTS_NORMAL, 11);
    for (int draw = 0; draw < DRAWS; draw++) {
        struct motion truth = {0.3 * (draw % 3), 0.2 * (draw % 4), 0.02};
        struct photo photos[2];
        for (int k = 0; k < 2; k++) {
            struct canvas canvas = canvas_make(181, 181, 0.8);
            canvas_add(&canvas, &dots, centre + k * truth.u, centre + k * truth.v, k * truth.angle, 0);
            photos[k] = canvas_photo(&canvas, 0.8, 0.1, 0, 1);
            canvas_free(&canvas);
            add_smooth_noise(&photos[k], 0.01, &seed);
        }
        struct shape shape = {.cx = centre, .cy = centre, .radius = big};
        struct icgn_options options = ICGN_DEFAULT;
        struct subset subset;
        struct patch patch = {0};
        struct fit fit;
        check_done(subset_build(&photos[0], &shape, NULL, &subset));
        check_done(icgn_fit(&subset, &photos[1], truth, &options, &patch, &fit));
        sum += pow(fit.motion.u - truth.u, 2) / fit.covariance[0][0] +
               pow(fit.motion.v - truth.v, 2) / fit.covariance[1][1] +
               pow(fit.motion.angle - truth.angle, 2) / fit.covariance[2][2];
        subset_free(&subset);
        patch_free(&patch);
        free(photos[0].pixels);
        free(photos[1].pixels);
    }
    print_message("smooth noise: error / stated %.3f\n", sqrt(sum / (3 * DRAWS)));
    check_near(sqrt(sum / (3 * DRAWS)), 1, 0.35);
    dots_free(&dots);
}

/* 60 grains: (error / stated error)^2 of places and angles is 1 within 3 sqrt(2 / 60); a grain that is white over a
 * third of its face is flagged. */
static void test_grains_of_a_packing(void **state)
{
    (void)state;
    double place = 0, turn = 0;
    enum { DRAWS = 3 };
    for (uint64_t draw = 0; draw < DRAWS; draw++) {
        struct packing packing;
        struct tracker_options options = TRACKER_DEFAULT;
        struct tracks tracks = {0};
        packing_make(&packing, 500 + draw);
        struct photo reference = packing_photo(&packing, 0.03, 2 * draw + 1);
        struct photo_grains grains = packing_grains(&packing);
        packing_move(&packing, 0.4, 0.2, 0.5, 1 * degree, 900 + draw);
        struct photo photo = packing_photo(&packing, 0.03, 2 * draw + 2);
        for (int y = -9; y <= 9; y++) /* of grain 7 in the reference */
            for (int x = -20; x <= 20; x++)
                reference.pixels[((int)packing.y[7] + y) * WIDTH + (int)packing.x[7] + x] = 65535;
        check_done(track_grains(&reference, &grains, &photo, NULL, &options, &tracks));
        for (int k = 0; k < COUNT; k++) {
            const struct photo_grains *t = &tracks.grains;
            assert_int_equal((t->flags[k] & GRAIN_SATURATED) != 0, k == 7);
            if (k == 7)
                continue;
            place += (pow((t->x_px[k] - packing.x[k] - packing.motion[k].u) / t->s_x[k], 2) +
                      pow((t->y_px[k] - packing.y[k] - packing.motion[k].v) / t->s_y[k], 2)) /
                     (2 * DRAWS * (COUNT - 1));
            turn += pow((t->angle[k] - packing.motion[k].angle) / t->s_angle[k], 2) / (DRAWS * (COUNT - 1));
        }
        tracks_free(&tracks);
        table_free(&PHOTO_GRAINS, &grains);
        free(photo.pixels);
        free(reference.pixels);
        packing_free(&packing);
    }
    print_message("error / stated: places %.3f, angles %.3f\n", sqrt(place), sqrt(turn));
    check_near(place, 1, 3 * sqrt(2.0 / 114) + 0.1);
    check_near(turn, 1, 3 * sqrt(2.0 / 57) + 0.1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_errors_behind_a_lens),
        cmocka_unit_test(test_noisy_matches_are_doubted),
        cmocka_unit_test(test_smooth_noise_is_seen),
        cmocka_unit_test(test_grains_of_a_packing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
