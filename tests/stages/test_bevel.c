/* A dark bevel at the rims is a constant radius bias: findgrains shows it as such, contacts finds it again from the
 * overlaps alone. The packing of sample_images (120 rods, mean overlap 0.3 px) is photographed anew with a bevel and
 * without. */
#include "tests/check.h"

#include <math.h>
#include <stdio.h>

#include "contacts/find_contacts.h"
#include "findgrains/find_grains.h"
#include "pipeline/state/state.h"
#include "simulation/render/render.h"

#define SAMPLE FILM_SOURCE_DIR "/sample_images/"

static void read_truth(struct photo_grains *truth)
{
    static const char *const required[] = {"x_px", "y_px", "radius_px", "angle", NULL};
    struct state *state = state_open(SAMPLE "truth/0000.photo-truth.hdf");
    assert_non_null(state);
    check_done(state_read(state, "grains", &PHOTO_GRAINS, required, truth));
    state_close(state);
}

static void photograph(const struct photo_grains *truth, double bevel, struct photo *photo)
{
    struct scene scene = {0};
    struct optics optics;
    check_done(scene_read(SAMPLE "virtual.json", &scene));
    check_done(optics_read(&scene, &optics));
    optics.bevel_width = bevel;
    optics.bevel_depth = 0.6;
    struct picture picture = {.width = scene.photos.width, .height = scene.photos.height, .grains = truth, .framed = 1};
    for (int k = 0; k < 4; k++)
        picture.corners[k] = scene.frame.corners_px[k];
    check_done(render_picture(&picture, &optics, photo));
    optics_free(&optics);
    scene_free(&scene);
}

static double mean_bias(const struct photo_grains *truth, const struct photo_grains *grains)
{
    double sum = 0;
    size_t count = 0;
    for (size_t k = 0; k < truth->count; k++)
        for (size_t j = 0; j < grains->count; j++) {
            if (hypot(grains->x_px[j] - truth->x_px[k], grains->y_px[j] - truth->y_px[k]) > 2)
                continue;
            sum += grains->radius_px[j] - truth->radius_px[k];
            count++;
        }
    assert_int_equal(count, truth->count);
    return sum / (double)count;
}

/* Returns the bias of the radii; *offset: what contacts adds to them, with its standard error. */
static double run(double bevel, double *offset, double *error)
{
    struct photo_grains truth = {0}, grains = {0};
    struct photo photo = {0};
    struct scene scene = {0};
    struct packing packing = {0};
    struct contact_summary summary;
    struct find_options options = FIND_OPTIONS_DEFAULT;
    struct contact_options how = CONTACT_OPTIONS_DEFAULT;
    read_truth(&truth);
    photograph(&truth, bevel, &photo);
    check_done(scene_read(SAMPLE "scene.json", &scene));
    options.radius_min_px = 18;
    options.radius_max_px = 58;
    options.has_frame = 1;
    for (int k = 0; k < 4; k++)
        options.corners_px[k] = scene.frame.corners_px[k];
    check_done(find_grains(&photo, &options, &grains, NULL));
    how.radius_offset_auto = 1;
    const struct contact_input input = {.scene = &scene, .grains = &grains, .is_reference = 1};
    check_done(find_contacts(&input, &how, &packing, &summary));
    assert_null(summary.undecided);
    double bias = mean_bias(&truth, &grains);
    *offset = summary.radius_offset_px;
    *error = summary.s_radius_offset_px;
    printf("  bevel %.1f px: radii off by %+.3f px, offset found %+.3f, standard error %.3f\n", bevel, bias, *offset,
           *error);
    packing_free(&packing);
    scene_free(&scene);
    photo_free(&photo);
    table_free(&PHOTO_GRAINS, &grains);
    table_free(&PHOTO_GRAINS, &truth);
    return bias;
}

static void bevel_is_found_again(void **state)
{
    static const double bevels[] = {0, 1.5};
    double bias[2], offset, error;
    (void)state;
    for (int k = 0; k < 2; k++) {
        bias[k] = run(bevels[k], &offset, &error);
        check_near(offset, -bias[k], 3 * error);
        check_at_most(error, 0.04);
    }
    check_near(bias[0], 0, 0.02);
    assert_true(bias[1] < -0.3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bevel_is_found_again),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
