/* Every allocation of contacts and of the texts about a photo fails once: the call says so, or its result is that of
 * the undisturbed one. */
#include "tests/check.h"

#include "tests/failing_memory.h"

#include <math.h>
#include <stdio.h>
#include <unistd.h>

#include "contacts/find_contacts.h"
#include "pipeline/speak/error.h"
#include "simulation/render/render.h"

enum { ACROSS = 5, COUNT = ACROSS * ACROSS };

/* A square lattice of grains of 20 px that overlap by 0.2 px, in a frame of 1000 px, the last one apart. */
static void make_lattice(struct photo_grains *grains, struct scene *scene)
{
    static const char *const columns[] = {"x_px", "y_px", "radius_px", "s_x", "s_y", "s_radius", "flags", NULL};
    check_done(table_alloc(&PHOTO_GRAINS, grains, COUNT, columns));
    for (int k = 0; k < COUNT; k++) {
        grains->x_px[k] = 100 + 39.8 * (k % ACROSS) + (k == COUNT - 1 ? 5 : 0);
        grains->y_px[k] = 800 - 39.8 * (k / ACROSS);
        grains->radius_px[k] = 20;
        grains->s_x[k] = grains->s_y[k] = grains->s_radius[k] = 0.02;
    }
    *scene = (struct scene){.path = "scene.json", .scale = 1e-4, .origin_px = {0, 1000}};
    scene->grains.density = scene->grains.length = NAN;
    scene->frame.given = 1;
    scene->frame.corners_px[CORNER_TOP_LEFT] = vec(80, 620);
    scene->frame.corners_px[CORNER_TOP_RIGHT] = vec(280, 620);
    scene->frame.corners_px[CORNER_BOTTOM_RIGHT] = vec(280, 820);
    scene->frame.corners_px[CORNER_BOTTOM_LEFT] = vec(80, 820);
}

static void test_find_contacts(void **state)
{
    (void)state;
    struct photo_grains grains = {0};
    struct scene scene;
    struct contact_options options = CONTACT_OPTIONS_DEFAULT;
    struct packing whole = {0};
    int failed = 1, refused = 0;
    make_lattice(&grains, &scene);
    options.radius_offset_auto = 1;
    struct contact_input input = {.scene = &scene, .grains = &grains, .is_reference = 1};
    check_done(find_contacts(&input, &options, &whole, NULL));
    assert_true(whole.contacts.count >= 40);
    for (long left = 0; failed; left++) {
        struct packing packing = {0};
        atomic_store(&allocations_left, left);
        int status = find_contacts(&input, &options, &packing, NULL);
        failed = allocation_failed();
        refused += status != 0;
        assert_true(status || (same_columns(&GRAINS, &packing.grains, &whole.grains) &&
                               same_columns(&CONTACTS, &packing.contacts, &whole.contacts) &&
                               same_columns(&WALLS, &packing.walls, &whole.walls)));
        assert_true(failed || !status);
        packing_free(&packing);
        error_clear();
    }
    assert_true(refused > 20);
    packing_free(&whole);
    table_free(&PHOTO_GRAINS, &grains);
}

/* The parameters in the file of a photo's truth: all of them, or none and an error. */
static void test_parameters_of_a_photo(void **state)
{
    (void)state;
    char folder[] = "/tmp/film_memory_XXXXXX", scene_path[64], path[64];
    assert_non_null(mkdtemp(folder));
    snprintf(scene_path, sizeof scene_path, "%s/scene.json", folder);
    snprintf(path, sizeof path, "%s/0000.photo-truth.hdf", folder);
    FILE *file = fopen(scene_path, "w");
    assert_non_null(file);
    fputs("{\"schema\": \"film.scene/1\", \"name\": \"t\", \"scale_m_per_px\": 1e-4, \"optics\": {\"psf_px\": 0.8}}",
          file);
    fclose(file);
    struct scene scene;
    struct photo_truth truth = {.patches = {.count = 0}};
    check_done(scene_read(scene_path, &scene));
    check_done(table_alloc(&PHOTO_GRAINS, &truth.grains, 1, NULL));
    check_done(table_alloc(&CONTACTS, &truth.contacts, 0, NULL));
    check_done(table_alloc(&PATCHES, &truth.patches, 0, NULL));
    failing_memory_of_json();
    char *whole = NULL;
    int failed = 1, refused = 0;
    for (long left = -1; failed; left++) {
        struct state_info info = {0};
        atomic_store(&allocations_left, left);
        int status = photo_truth_write(path, &truth, &scene, 0, scene_path);
        failed = left < 0 || allocation_failed();
        refused += status != 0;
        if (!status) {
            struct state *written = state_open(path);
            assert_non_null(written);
            check_done(state_read_info(written, &info));
            state_close(written);
            assert_non_null(strstr(info.inputs, "\"name\":\"scene.json\""));
            assert_non_null(strstr(info.inputs, "\"sha256\":"));
            if (whole)
                assert_string_equal(info.parameters, whole);
            else
                whole = strdup(info.parameters);
            state_info_free(&info);
        }
        assert_true(failed || !status);
        remove(path);
        error_clear();
    }
    assert_true(refused > 5);
    free(whole);
    photo_truth_free(&truth);
    scene_free(&scene);
    remove(scene_path);
    rmdir(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_find_contacts),
        cmocka_unit_test(test_parameters_of_a_photo),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
