/* Every allocation of a stage fails once: the call says so, or its result is that of the undisturbed one. */
#include "tests/failing_memory.h"

#include "tests/drawn_packing.h"

#include <omp.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "tracker/search/consistency.h"

/* Ten good matches, one of them ten times as noisy as usual: it is doubtful, or memory was gone. */
static void test_doubtful_matches(void **state)
{
    (void)state;
    for (long left = 0; left < 3; left++) {
        struct outcome outcomes[10];
        memset(outcomes, 0, sizeof outcomes);
        for (int k = 0; k < 10; k++)
            outcomes[k] = (struct outcome){.found = 2, .fit = {.noise = k == 4 ? 100 : 10, .zncc = 0.9}};
        atomic_store(&allocations_left, left);
        int status = consistency_demote(outcomes, 10), failed = allocation_failed();
        assert_int_equal(status, failed ? -1 : 0);
        assert_int_equal(outcomes[4].found, failed ? 2 : 1);
        error_clear();
    }
}

static void test_track_grains(void **state)
{
    (void)state;
    struct packing packing;
    packing_make(&packing, 5);
    struct photo reference = packing_photo(&packing, 0.01, 1);
    struct photo_grains grains = packing_grains(&packing);
    struct tracker_options options = TRACKER_DEFAULT;
    struct tracks whole = {0};
    packing_move(&packing, 4, -3, 1, 9 * degree, 6);
    struct photo photo = packing_photo(&packing, 0.01, 2);
    omp_set_num_threads(1); /* the order of the allocations */
    check_done(track_grains(&reference, &grains, &photo, NULL, &options, &whole));
    int failed = 1, refused = 0;
    for (long left = 0; failed; left += left < 20 ? 1 : 23) {
        struct tracks tracks = {0};
        atomic_store(&allocations_left, left);
        int status = track_grains(&reference, &grains, &photo, NULL, &options, &tracks);
        failed = allocation_failed();
        refused += status != 0;
        assert_true(status || same_columns(&PHOTO_GRAINS, &tracks.grains, &whole.grains));
        assert_true(failed || !status);
        tracks_free(&tracks);
        error_clear();
    }
    assert_true(refused > 20);
    tracks_free(&whole);
    table_free(&PHOTO_GRAINS, &grains);
    free(photo.pixels);
    free(reference.pixels);
    packing_free(&packing);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_doubtful_matches),
        cmocka_unit_test(test_track_grains),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
