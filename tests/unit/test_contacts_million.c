/* A million grains: every contact of a hexagonal crystal, and memory that grows no faster than the grains. */
#include <math.h>
#include <sys/resource.h>

#include "contacts/find_contacts.h"
#include "tests/check.h"

static void find_crystal(size_t side)
{
    static const char *const columns[] = {"x_px", "y_px", "radius_px", "flags", NULL};
    struct scene scene = {.path = "scene.json", .scale = 1e-4};
    struct photo_grains grains;
    struct packing packing = {0};
    struct contact_summary summary;
    struct contact_options options = CONTACT_OPTIONS_DEFAULT;
    struct contact_input input = {.scene = &scene, .grains = &grains, .is_reference = 1};
    scene.grains.density = scene.grains.length = NAN;
    check_done(table_alloc(&PHOTO_GRAINS, &grains, side * side, columns));
    for (size_t k = 0; k < grains.count; k++) {
        size_t at = (k * 7919) % grains.count, row = at / side; /* 7919 is a prime: each place once */
        grains.x_px[k] = 39.9 * ((double)(at % side) + 0.5 * (double)(row % 2));
        grains.y_px[k] = 39.9 * sqrt(0.75) * (double)row;
        grains.radius_px[k] = 20;
    }
    check_done(find_contacts(&input, &options, &packing, &summary));
    assert_int_equal(summary.contacts, side * (side - 1) + (side - 1) * (2 * side - 1));
    packing_free(&packing);
    table_free(&PHOTO_GRAINS, &grains);
}

static double peak_bytes(void)
{
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return 1024.0 * (double)usage.ru_maxrss;
}

static void test_million(void **state)
{
    (void)state;
    double start = peak_bytes();
    find_crystal(200);
    double small = (peak_bytes() - start) / (200.0 * 200.0);
    find_crystal(1000);
    double large = (peak_bytes() - start) / 1e6;
    print_message("bytes per grain: %.0f of 40 000, %.0f of a million\n", small, large);
    check_at_most(large, 2 * small);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_million)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
