/* Contact laws on one small-strain probe: what Tolomeo and McDowell find, in the plane, on 60 discs. */
#include "tests/check.h"

#include <math.h>
#include <string.h>

#include "calibration/rods/laws.h"
#include "pipeline/speak/error.h"

static const struct grade GRADING[] = {{24, 0.024}, {24, 0.03}, {12, 0.04}};

static struct simulation ballast(void)
{
    struct simulation simulation = SIMULATION_DEFAULT;
    simulation.grading = GRADING;
    simulation.grade_count = 3;
    simulation.density = 2650;
    simulation.length = 0.03;
    simulation.pressure = 1.5e5 * 0.03;
    simulation.preparation_mu = 0.2;
    simulation.tolerance = 1e-7;
    simulation.law = (struct contact_law){.row = &pohrt_popov_law,
                                          .kt_over_kn = 1.5 / 1.75,
                                          .mu = 0.7,
                                          .young = 6e10,
                                          .poisson = 0.25,
                                          .fractal = 2.13,
                                          .roughness = 2.61e-5};
    return simulation;
}

static void rough_contacts_are_softer_and_plastic_ones_stiffer_again(void **state)
{
    (void)state;
    static const struct law *const rows[] = {&hertz_mindlin_law, &pohrt_popov_law, &pohrt_popov_plastic_law};
    struct simulation simulation = ballast();
    struct law_probe probe = {.first = 1e-6, .last = 3e-4, .per_decade = 1, .back = 2};
    struct law_curve curves[3];
    for (int k = 0; k < 3; k++) {
        struct contact_law law = simulation.law;
        law.row = rows[k];
        check_done(law_compare(&simulation, &law, &probe, &curves[k]));
        assert_int_equal(curves[k].count, curves[k].loading + 2);
        const struct law_step *first = &curves[k].steps[0], *last = &curves[k].steps[curves[k].loading - 1];
        check_near(first->strain, 1e-6, 1e-12);
        check_near(last->strain, 3e-4, 1e-12);
        check_near(curves[k].steps[curves[k].count - 1].strain, 1.5e-4, 1e-12);
        assert_true(first->rested);
        /* What is compressed stands upright, what opens lies down; turned round on the way back. */
        check_at_most(first->angle[GROUP_UNLOADING], 0.5);
        check_at_most(1.0, first->angle[GROUP_RELOADING]);
        check_at_most(1.0, curves[k].steps[curves[k].loading].angle[GROUP_UNLOADING]);
        /* The contacts of a state are all in one group; few begin on their virgin curve and more are there later. */
        size_t all = 0;
        for (int g = 0; g < GROUPS; g++)
            all += first->count[g];
        check_near((double)all, 0.5 * curves[k].fabric.z * 60, 20); /* walls count once */
        check_at_most((double)first->count[GROUP_LOADING], (double)last->count[GROUP_LOADING] - 1);
        if (k == 2) /* the elastic ones stay as they are in so small a packing */
            check_at_most(last->young, 0.9 * first->young);
    }
    check_at_most(curves[1].steps[0].young, 0.8 * curves[0].steps[0].young);
    check_at_most(1.15 * curves[1].steps[0].young, curves[2].steps[0].young);
    for (int k = 0; k < 3; k++)
        law_curve_free(&curves[k]);
}

static void strains_that_make_no_sense_are_refused(void **state)
{
    (void)state;
    struct simulation simulation = ballast();
    struct law_probe probe = {.first = 1e-3, .last = 1e-4, .per_decade = 1};
    struct law_curve curve;
    assert_int_equal(law_compare(&simulation, &simulation.law, &probe, &curve), -1);
    assert_int_equal(error_status(), EXIT_INPUT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rough_contacts_are_softer_and_plastic_ones_stiffer_again),
        cmocka_unit_test(strains_that_make_no_sense_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
