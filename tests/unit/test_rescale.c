/* k_n and k_t from the stresses of simulated series whose stiffness is known. */
#include "tests/check.h"

#include <math.h>
#include <string.h>

#include "calibration/rods/rescale.h"
#include "pipeline/speak/error.h"
#include "tests/kept_states.h"

static const struct grade GRADING[] = {{60, 8e-3}, {40, 12e-3}};
static const struct loading_steps STEPS[] = {{12, 2e-4}};
static const double KN = 2.3e7, RATIO = 0.6;

static void make_series(struct kept_states *kept)
{
    struct simulation simulation = SIMULATION_DEFAULT;
    simulation.grading = GRADING;
    simulation.grade_count = 2;
    simulation.law = (struct contact_law){.row = &linear_law, .kn = KN, .kt_over_kn = RATIO, .mu = 0.5};
    simulation.preparation_mu = 0.1; /* dense: little slides in small steps */
    simulation.kappa = 300;
    simulation.test = TEST_BIAXIAL_VERTICAL;
    simulation.steps = STEPS;
    simulation.step_count = 1;
    check_done(simulate(&simulation, keep_state, kept));
}

static struct contact_law law_of(double ratio)
{
    return (struct contact_law){.row = &linear_law, .kn = NAN, .kt_over_kn = ratio, .mu = 0.5};
}

static void one_number(void **state)
{
    (void)state;
    struct kept_states kept = {0};
    struct rescale rescale;
    make_series(&kept);
    struct rescale_options options = {.law = law_of(RATIO)};
    check_done(rescale_fit(kept.packing, kept.count, &options, &rescale));
    check_near(rescale.kn / KN, 1, 0.01); /* tangential forces of the first state are not known */
    assert_true(isnan(rescale.s_kt_over_kn));
    check_at_most(rescale.rms, 0.05); /* contacts that form on the way begin without force */
    rescale_free(&rescale);

    options.increments = 1;
    check_done(rescale_fit(kept.packing, kept.count, &options, &rescale));
    check_near(rescale.kn / KN, 1, 0.02);
    rescale_free(&rescale);

    /* The forces of the files, with a stiffness that is wrong by 1.7. */
    for (size_t k = 0; k < kept.count; k++)
        for (size_t c = 0; c < kept.packing[k].contacts.count; c++) {
            kept.packing[k].forces->contact.fn[c] /= 1.7;
            kept.packing[k].forces->contact.ft[c] /= 1.7;
        }
    options = (struct rescale_options){.method = "dem"};
    check_done(rescale_fit(kept.packing, kept.count, &options, &rescale));
    check_near(rescale.ratio, 1.7, 1e-6);
    check_near(rescale.kn / (1.7 * KN), 1, 1e-6);
    rescale_free(&rescale);
    kept_free(&kept);
}

static void two_numbers(void **state)
{
    (void)state;
    struct kept_states kept = {0};
    struct rescale rescale;
    make_series(&kept);
    struct rescale_options options = {.law = law_of(1), .fit_kt = 1, .increments = 1};
    check_done(rescale_fit(kept.packing, kept.count, &options, &rescale));
    check_near(rescale.kn / KN, 1, 0.02);
    check_near(rescale.kt_over_kn, RATIO, 0.05);
    rescale_free(&rescale);
    kept_free(&kept);
}

static void what_no_stress_tells_is_refused(void **state)
{
    (void)state;
    struct kept_states kept = {0};
    struct rescale rescale;
    make_series(&kept);
    struct rescale_options options = {.law = law_of(1), .fit_kt = 1};
    assert_int_equal(rescale_fit(kept.packing, 1, &options, &rescale), -1);
    assert_non_null(strstr(error_message(), "two or more"));
    options = (struct rescale_options){.law = {.mu = NAN}};
    assert_int_equal(rescale_fit(kept.packing, 2, &options, &rescale), -1);
    options = (struct rescale_options){.law = law_of(1), .method = "qsm"};
    assert_int_equal(rescale_fit(kept.packing, 2, &options, &rescale), -1);
    options.method = NULL;
    for (size_t k = 0; k < kept.count; k++)
        for (size_t w = 0; w < kept.packing[k].walls.count; w++)
            kept.packing[k].walls.fx[w] = kept.packing[k].walls.fy[w] = NAN;
    assert_int_equal(rescale_fit(kept.packing, 2, &options, &rescale), -1);
    assert_int_equal(error_status(), EXIT_INPUT);
    assert_non_null(strstr(error_message(), "loads.csv"));
    kept_free(&kept);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_number),
        cmocka_unit_test(two_numbers),
        cmocka_unit_test(what_no_stress_tells_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
