/* The section "simulation" of a scene: read whole, and every kind of mistake refused where it stands. */
#include "tests/check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "pipeline/speak/error.h"
#include "simulation/dem/simulate.h"
#include "simulation/dem/simulate_scene.h"

static const char HEAD[] = "{\"schema\": \"film.scene/1\", \"name\": \"test\",\n"
                           "\"grains\": {\"density_kg_m3\": 700, \"length_m\": 0.05},\n"
                           "\"contact\": {\"kn_N_per_m\": 1e7, \"mu\": 0.5},\n";

static int read_text(const char *text, struct scene *scene, struct simulation_plan *plan)
{
    char path[] = "test_simulate_scene_XXXXXX";
    int file = mkstemp(path);
    assert_true(file >= 0);
    assert_int_equal(write(file, text, strlen(text)), strlen(text));
    close(file);
    int status = scene_read(path, scene);
    if (!status)
        status = simulation_read(scene, plan);
    unlink(path);
    return status;
}

static int read_section(const char *section, struct scene *scene, struct simulation_plan *plan)
{
    char text[2000];
    snprintf(text, sizeof text, "%s\"simulation\": %s}\n", HEAD, section);
    return read_text(text, scene, plan);
}

static void a_whole_section_is_read(void **state)
{
    (void)state;
    struct scene scene = {0};
    struct simulation_plan plan = {0};
    check_done(read_section("{\"seed\": 9, \"grading\": [[3, 0.01], [2, 0.02]], \"aspect\": 2, \"pressure_Pa\": 1e5,\n"
                            " \"friction_during_compression\": 0.1, \"restitution\": 0.4, \"inertial_number\": 1e-4,\n"
                            " \"tolerance\": 1e-8, \"max_steps\": 1000, \"test\": \"biaxial_vertical\",\n"
                            " \"steps\": [[4, 1e-3], [2, -1e-3]]}",
                            &scene, &plan));
    const struct simulation *s = &plan.simulation;
    assert_int_equal(s->seed, 9);
    assert_int_equal(s->grade_count, 2);
    assert_int_equal(s->grading[1].count, 2);
    check_near(s->grading[1].diameter, 0.02, 0);
    check_near(s->aspect, 2, 0);
    check_near(s->pressure, 1e5 * 0.05, 1e-9);
    check_near(s->preparation_mu, 0.1, 0);
    check_near(s->restitution, 0.4, 0);
    check_near(s->inertial, 1e-4, 0);
    check_near(s->tolerance, 1e-8, 0);
    check_near(s->density, 700, 0);
    check_near(s->length, 0.05, 0);
    check_near(s->law.mu, 0.5, 0);
    assert_int_equal(s->max_steps, 1000);
    assert_int_equal(s->test, TEST_BIAXIAL_VERTICAL);
    assert_int_equal(s->step_count, 2);
    check_near(s->steps[1].amount, -1e-3, 0);
    char *parameters = simulation_parameters(&scene);
    assert_non_null(strstr(parameters, "\"seed\":9"));
    assert_non_null(strstr(parameters, "\"density_kg_m3\":700"));
    free(parameters);
    simulation_plan_free(&plan);
    scene_free(&scene);
}

static void discs_and_tests_are_read(void **state)
{
    (void)state;
    struct scene scene = {0};
    struct simulation_plan plan = {0};
    check_done(
        read_section("{\"discs\": [{\"x_m\": 1, \"y_m\": 2, \"radius_m\": 0.5, \"fixed\": true},\n"
                     " {\"x_m\": 3, \"y_m\": 4, \"radius_m\": 0.25, \"load_N\": [5, -6]}], \"box_m\": [7, 8],\n"
                     " \"kappa\": 300, \"test\": \"cyclic\", \"stress_amplitude\": 0.4, \"cycles\": [[8, 0.25]],\n"
                     " \"lateral\": \"fixed\", \"relax_at\": \"stress\", \"time_step\": 0.05}",
                     &scene, &plan));
    const struct simulation *s = &plan.simulation;
    assert_int_equal(s->disc_count, 2);
    assert_true(s->discs[0].fixed && !s->discs[1].fixed);
    check_near(s->discs[1].radius, 0.25, 0);
    check_near(s->discs[1].load_y, -6, 0);
    check_near(s->discs[0].y, 2, 0);
    check_near(s->box[1], 8, 0);
    check_near(s->kappa, 300, 0);
    check_near(s->amplitude, 0.4, 0);
    check_near(s->time_step, 0.05, 0);
    assert_int_equal(s->test, TEST_CYCLIC);
    assert_true(s->lateral_fixed && s->relax_at_stress);
    assert_int_equal(simulation_states(s), 9);
    simulation_plan_free(&plan);
    scene_free(&scene);
}

static void mistakes_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *section, *says;
    } bad[] = {
        {"{\"kappa\": 100}", "grading"},
        {"{\"kappa\": 100, \"grading\": []}", "grading"},
        {"{\"kappa\": 100, \"grading\": [[0, 0.01]]}", "count"},
        {"{\"kappa\": 100, \"grading\": [[2.5, 0.01]]}", "count"},
        {"{\"kappa\": 100, \"grading\": [[2, -0.01]]}", "-0.01"},
        {"{\"kappa\": 100, \"grading\": [2, 0.01]}", "pairs"},
        {"{\"kappa\": 100, \"grading\": [[9000000, 0.01], [9000000, 0.01]]}", "fewer"},
        {"{\"grading\": [[2, 0.01]]}", "kappa"},
        {"{\"kappa\": 100, \"pressure_Pa\": 1e5, \"grading\": [[2, 0.01]]}", "one of them"},
        {"{\"pressure_Pa\": -1e5, \"grading\": [[2, 0.01]]}", "pressure_Pa"},
        {"{\"pressure_Pa\": 1e12, \"grading\": [[2, 0.01]]}", "lower the pressure"},
        {"{\"kappa\": 0.5, \"grading\": [[2, 0.01]]}", "kappa"},
        {"{\"kappa\": 100, \"grading\": [[2, 0.01]], \"friction_during_compression\": 0.6}", "mu"},
        {"{\"kappa\": 100, \"grading\": [[2, 0.01]], \"test\": \"triaxial\"}", "test"},
        {"{\"kappa\": 100, \"grading\": [[2, 0.01]], \"restitution\": 0.05}", "restitution"},
        {"{\"kappa\": 100, \"grading\": [[2, 0.01]], \"steps\": [[1, 0.9]]}", "steps"},
        {"{\"kappa\": 100, \"grading\": [[2, 0.01]], \"tolerance\": 0.1}", "tolerance"},
        {"{\"kappa\": 100, \"grading\": [[2, 0.01]], \"sede\": 1}", "sede"},
        {"{\"kappa\": 100, \"grading\": [[2, 0.01]], \"corner_radius_m\": -0.01}", "corner_radius_m"},
        {"{\"kappa\": 100, \"grading\": [[2, 0.01]], \"time_step\": 0.5}", "time_step"},
        {"{\"kappa\": 100, \"grading\": [[2, 0.01]], \"discs\": 3}", "discs"},
        {"{\"kappa\": 100, \"grading\": [[2, 0.01]], \"discs\": [{\"x_m\": 0, \"y_m\": 0, \"radius_m\": 1}]}",
         "one of them"},
        {"{\"discs\": [{\"x_m\": 0, \"y_m\": 0}]}", "radius_m"},
        {"{\"discs\": [{\"x_m\": 0, \"y_m\": 0, \"radius_m\": -1}]}", "radius_m"},
        {"{\"discs\": [3]}", "object"},
        {"{\"discs\": [{\"x_m\": 0, \"y_m\": 0, \"radius_m\": 1}], \"box_m\": [0, 1]}", "box_m"},
        {"{\"kappa\": 100, \"discs\": [{\"x_m\": 0, \"y_m\": 0, \"radius_m\": 1}], \"stress_steps\": [[1, 0.1]]}",
         "walls"},
        {"{\"kappa\": 100, \"grading\": [[2, 0.01]], \"steps\": [[1, 0.1]]}", "stress_steps"},
        {"{\"kappa\": 100, \"grading\": [[2, 0.01]], \"test\": \"simple_shear\", \"stress_steps\": [[1, 0.1]]}",
         "steps"},
        {"{\"kappa\": 100, \"grading\": [[2, 0.01]], \"test\": \"cyclic\", \"cycles\": [[1, 0.1]]}",
         "stress_amplitude"},
        {"{\"kappa\": 100, \"grading\": [[2, 0.01]], \"stress_steps\": [[1, 0.5], [5, -0.3]]}", "row 1"},
        {"{\"kappa\": 100, \"grading\": [[2, 0.01]], \"relax_at\": \"volume\"}", "relax_at"},
        {"[]", "simulation"},
    };
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        struct scene scene = {0};
        struct simulation_plan plan = {0};
        int status = read_section(bad[k].section, &scene, &plan);
        if (status != -1 || error_status() != EXIT_INPUT || !strstr(error_message(), bad[k].says))
            fail_msg("%s: status %d, %s", bad[k].section, status, error_message());
        assert_null(plan.grading);
        simulation_plan_free(&plan);
        scene_free(&scene);
    }
}

static void what_is_missing_is_named(void **state)
{
    (void)state;
    static const char *const scenes[][2] = {
        {"{\"schema\": \"film.scene/1\", \"name\": \"t\"}", "simulation"},
        {"{\"schema\": \"film.scene/1\", \"name\": \"t\", \"simulation\": {}}", "kn_N_per_m"},
        {"{\"schema\": \"film.scene/1\", \"name\": \"t\", \"simulation\": {}, \"contact\": {\"kn_N_per_m\": 1e7}}",
         "contact.mu"},
        {"{\"schema\": \"film.scene/1\", \"name\": \"t\", \"simulation\": {}, \"contact\": {\"kn_N_per_m\": 1e7, "
         "\"mu\": 1}}",
         "density"},
        {"{\"schema\": \"film.scene/1\", \"name\": \"t\", \"contact\": {\"law\": \"rubber\"}}", "hertz_mindlin"},
        {"{\"schema\": \"film.scene/1\", \"name\": \"t\", \"contact\": {\"law\": \"hertz_mindlin\", \"mu\": 1}}",
         "young_Pa"},
        {"{\"schema\": \"film.scene/1\", \"name\": \"t\", \"contact\": {\"law\": \"pohrt_popov\", \"mu\": 1, "
         "\"young_Pa\": 1e9, \"poisson\": 0.3}}",
         "roughness_m"},
        {"{\"schema\": \"film.scene/1\", \"name\": \"t\", \"contact\": {\"law\": \"hertz_pfc\", \"kn_N_per_m\": 1e7}}",
         "kn_N_per_m"},
        {"{\"schema\": \"film.scene/1\", \"name\": \"t\", \"grains\": {\"density_kg_m3\": 700, \"length_m\": 1}, "
         "\"contact\": "
         "{\"law\": \"hertz_pfc\", \"mu\": 1, \"young_Pa\": 1e9, \"poisson\": 0.3}, \"simulation\": {\"kappa\": 100, "
         "\"grading\": [[2, 1]]}}",
         "pressure_Pa"},
    };
    for (size_t k = 0; k < sizeof scenes / sizeof *scenes; k++) {
        struct scene scene = {0};
        struct simulation_plan plan = {0};
        assert_int_equal(read_text(scenes[k][0], &scene, &plan), -1);
        assert_int_equal(error_status(), EXIT_INPUT);
        assert_non_null(strstr(error_message(), scenes[k][1]));
        scene_free(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_whole_section_is_read),
        cmocka_unit_test(discs_and_tests_are_read),
        cmocka_unit_test(mistakes_are_refused),
        cmocka_unit_test(what_is_missing_is_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
