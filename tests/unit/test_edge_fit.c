/* The edge of one blurred disc, without noise: the drawing knows nothing of the model that is fitted. */
#include "tests/check.h"
#include "tests/discs.h"
#include "findgrains/rims/refine_circle.h"

#include <math.h>

#define FAR 60000.0
#define VOID 2000.0

static const struct scenery still = {.void_grey = VOID, .blur = 1.05};

static struct edge_settings settings_for(double blur, double window)
{
    return (struct edge_settings){.blur = blur,
                                  .window = window,
                                  .sector = 3,
                                  .least_step = 1000,
                                  .void_level = VOID,
                                  .void_spread = 15000,
                                  .noise = 900,
                                  .damping = 1,
                                  .tukey = 4.685};
}

/* Fit one disc from a start that is off; returns the refined rim. */
static struct refined fit_disc(const struct photo *photo, struct rim start, const struct edge_settings *settings,
                               int ellipse)
{
    struct zone zone;
    struct edge_work work = {0};
    struct refined refined = {.rim = start};
    check_done(zone_make(photo->width, photo->height, NULL, 0, &zone));
    for (int k = 0; k < 6; k++)
        check_done(refine_circle(photo, &zone, NULL, 0, settings, ellipse, &work, &refined));
    edge_work_free(&work);
    return refined;
}

/* The half level of a blurred disc lies at R - s^2 / (2 R). The disc is placed so that this point of its row is a pixel
 * centre; what the drawing has there, against the step's slope, says how far the half level really is from it. */
static void half_level_is_inside_the_rim(void **state)
{
    (void)state;
    const double radii[] = {12, 30, 60}, blur = 2, s2 = blur * blur + 1.0 / 12;
    for (int k = 0; k < 3; k++) {
        double r = radii[k], inside = s2 / (2 * r);
        struct disc disc = {.x = 80 + inside, .y = 80, .radius = r, .grey = FAR};
        struct photo photo;
        struct scenery wide = still;
        wide.blur = blur;
        check_done(discs_draw(161, 161, &disc, 1, &wide, &photo));
        double slope = (FAR - VOID) / sqrt(2 * M_PI * s2), grey = photo_row(&photo, 80)[80 + (int)r];
        double off = (grey - 0.5 * (FAR + VOID)) / slope;
        check_near(off, 0, s2 * s2 / (r * r * r) + 0.0005); /* second order; 64 chords per pixel */
        assert_true(inside > 5 * fabs(off));
        photo_free(&photo);
    }
}

static void circle_is_exact_without_noise(void **state)
{
    (void)state;
    const double radii[] = {10, 25, 67}, blurs[] = {0.7, 1.05, 1.5};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            struct disc disc = {.x = 80.37, .y = 79.81, .radius = radii[i] + 0.23, .grey = FAR};
            struct scenery scenery = still;
            scenery.blur = blurs[k];
            struct photo photo;
            check_done(discs_draw(161, 161, &disc, 1, &scenery, &photo));
            struct edge_settings settings = settings_for(sqrt(blurs[k] * blurs[k] + 1.0 / 12), 3);
            struct rim start = {.x = disc.x + 0.4, .y = disc.y - 0.3, .radius = disc.radius - 0.4};
            struct refined found = fit_disc(&photo, start, &settings, 0);
            /* discrete pixels: a sector of 3 px does not balance on its middle; falls with the rim's length */
            double tolerance = 0.001 + 0.03 / radii[i];
            check_near(found.rim.x, disc.x, tolerance);
            check_near(found.rim.y, disc.y, tolerance);
            check_near(found.rim.radius, disc.radius, 0.001);
            assert_true(found.support > 0.8);
            photo_free(&photo);
        }
}

static void ellipse_is_exact_without_noise(void **state)
{
    (void)state;
    struct disc disc = {.x = 80.37, .y = 79.81, .radius = 60.4, .c2 = 0.21, .s2 = -0.17, .grey = FAR};
    struct photo photo;
    check_done(discs_draw(161, 161, &disc, 1, &still, &photo));
    struct edge_settings settings = settings_for(sqrt(1.05 * 1.05 + 1.0 / 12), 3);
    struct refined found = fit_disc(&photo, (struct rim){.x = 80, .y = 80, .radius = 60}, &settings, 1);
    check_near(found.rim.x, disc.x, 0.002);
    check_near(found.rim.y, disc.y, 0.002);
    check_near(found.rim.radius, disc.radius, 0.002);
    check_near(found.rim.c2, disc.c2, 0.002);
    check_near(found.rim.s2, disc.s2, 0.002);
    photo_free(&photo);
}

/* Standard errors against the scatter over drawings that differ in noise only, and against the Cramer-Rao bound of
 * the whole rim with known levels (s: blur, A: step): sigma_R = (noise / A) sqrt(s / (sqrt(pi) R)). */
static void standard_errors_match_the_scatter(void **state)
{
    (void)state;
    enum { DRAWS = 40 };
    const double noise = 900, radius = 40.3;
    double square = 0, reported = 0, square_x = 0, reported_x = 0, s = sqrt(1.05 * 1.05 + 1.0 / 12);
    struct edge_settings settings = settings_for(s, 5 * s);
    for (int k = 0; k < DRAWS; k++) {
        struct disc disc = {.x = 60.37, .y = 59.81, .radius = radius, .grey = 32000};
        struct scenery scenery = still;
        scenery.noise = noise;
        scenery.seed = 100 + (uint64_t)k;
        struct photo photo;
        check_done(discs_draw(121, 121, &disc, 1, &scenery, &photo));
        struct refined found = fit_disc(&photo, (struct rim){.x = 60.2, .y = 60, .radius = 40}, &settings, 0);
        square += pow(found.rim.radius - radius, 2);
        square_x += pow(found.rim.x - disc.x, 2);
        reported += found.s_radius * found.s_radius;
        reported_x += found.s_x * found.s_x;
        photo_free(&photo);
    }
    double bound = noise / 30000 * sqrt(s / (sqrt(M_PI) * radius)), rms = sqrt(square / DRAWS);
    /* 40 draws: the RMS is known to 11 % (one standard deviation) */
    check_near(rms / sqrt(reported / DRAWS), 1, 0.35);
    check_near(sqrt(square_x / reported_x), 1, 0.35);
    check_at_most(rms, 2.0 * bound);
    assert_true(rms > 0.7 * bound);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(half_level_is_inside_the_rim),
        cmocka_unit_test(circle_is_exact_without_noise),
        cmocka_unit_test(ellipse_is_exact_without_noise),
        cmocka_unit_test(standard_errors_match_the_scatter),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
