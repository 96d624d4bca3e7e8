/* The photos of sample_images are what its command renders from its truth: same pixels, same photo truth. */
#include "tests/check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "simulation/render/render.h"
#include "pipeline/packing/packing_file.h"

#define SAMPLE FILM_SOURCE_DIR "/sample_images"

static void compare_pixels(const struct photo *photo, const char *path)
{
    struct photo kept = {0};
    struct photo_request request = {.width = photo->width, .height = photo->height};
    size_t pixels = (size_t)photo->width * (size_t)photo->height, other = 0;
    int furthest = 0;
    check_done(photo_read(path, &request, &kept));
    for (size_t at = 0; at < pixels; at++) {
        int step = abs(photo->pixels[at] - kept.pixels[at]) / 16;
        other += step > 0;
        furthest = step > furthest ? step : furthest;
    }
    print_message("%s: %zu of %zu pixels differ\n", path, other, pixels);
    /* None on the machine that made them. sin, cos, exp and log may differ in the last bit from one C library to the
     * next; that can turn a rounding here and there, by one 12-bit step. */
    assert_true(other <= pixels / 100000);
    assert_true(furthest <= 1);
    photo_free(&kept);
}

static void compare_truth(const struct photo_grains *grains, const char *path)
{
    struct state *state = state_open(path);
    struct photo_grains kept = {0};
    assert_non_null(state);
    check_done(state_read(state, "grains", &PHOTO_GRAINS, NULL, &kept));
    assert_int_equal(kept.count, grains->count);
    for (size_t k = 0; k < kept.count; k++) {
        check_near(kept.x_px[k], grains->x_px[k], 1e-9);
        check_near(kept.y_px[k], grains->y_px[k], 1e-9);
        check_near(kept.radius_px[k], grains->radius_px[k], 1e-9);
        check_near(kept.angle[k], grains->angle[k], 1e-9);
    }
    table_free(&PHOTO_GRAINS, &kept);
    state_close(state);
}

static void test_same_pixels(void **state)
{
    (void)state;
    struct scene scene = {0};
    struct optics optics;
    check_done(scene_read(SAMPLE "/virtual.json", &scene));
    check_done(optics_read(&scene, &optics));
    for (int index = 0; index <= 4; index += 4) {
        char path[512];
        struct packing packing = {0};
        struct photo photo = {0};
        struct photo_truth truth = {0};
        snprintf(path, sizeof path, SAMPLE "/truth/%04d.truth.hdf", index);
        check_done(packing_read(path, &packing));
        check_done(render(&packing, &optics, &scene, index, &photo, &truth));
        snprintf(path, sizeof path, SAMPLE "/photos/%04d.tif", index);
        compare_pixels(&photo, path);
        snprintf(path, sizeof path, SAMPLE "/truth/%04d.photo-truth.hdf", index);
        compare_truth(&truth.grains, path);
        photo_free(&photo);
        photo_truth_free(&truth);
        packing_free(&packing);
    }
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_same_pixels)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
