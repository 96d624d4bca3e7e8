/* From a scene to state files: the numbers of the whole state, read back and reckoned anew from the columns. */
#include "tests/check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "simulation/series_folder.h"
#include "simulation/dem/simulate_scene.h"
#include "pipeline/packing/packing_file.h"

static const char SCENE[] =
    "{\"schema\": \"film.scene/1\", \"name\": \"test\",\n"
    "\"grains\": {\"density_kg_m3\": 700, \"length_m\": 0.05},\n"
    "\"contact\": {\"kn_N_per_m\": 1e7, \"mu\": 0.2},\n"
    "\"simulation\": {\"grading\": [[40, 0.008], [20, 0.012]], \"kappa\": 200, \"inertial_number\": 1e-2,\n"
    "                 \"test\": \"biaxial_vertical\", \"steps\": [[1, 5e-3]]}}\n";

static const double PI = 3.141592653589793;

static double number_of(const struct state *file, const char *name)
{
    double value = NAN;
    assert_int_equal(state_read_numbers(file, "state", name, &value, 1), 0);
    return value;
}

static void simulate_into(const char *scene_path, const char *folder_path)
{
    struct scene scene = {0};
    struct simulation_plan plan = {0};
    struct series_folder folder = {0};
    FILE *text = fopen(scene_path, "w");
    assert_non_null(text);
    fputs(SCENE, text);
    assert_int_equal(fclose(text), 0);
    check_done(scene_read(scene_path, &scene));
    check_done(simulation_read(&scene, &plan));
    check_done(series_folder_open(&folder, &scene, "{}", folder_path, simulation_states(&plan.simulation)));
    check_done(simulate(&plan.simulation, series_folder_save, &folder));
    check_done(series_folder_close(&folder));
    simulation_plan_free(&plan);
    scene_free(&scene);
}

/* Frame and discs are upright here: width and height are those of the bottom and the right wall. */
static void check_numbers(const struct state *file, const struct packing *packing)
{
    const struct grains *grains = &packing->grains;
    const struct contact_forces *dem = &packing_forces(packing, "dem")->contact;
    double width = packing->walls.x1[0] - packing->walls.x0[0], height = packing->walls.y1[1] - packing->walls.y0[1];
    double area = 0, rattlers = 0, between = 0, sliding = 0, stored = 0, weber[4], walls[4];
    for (size_t k = 0; k < grains->count; k++) {
        area += PI * grains->radius[k] * grains->radius[k];
        rattlers += (grains->flags[k] & GRAIN_RATTLER) != 0;
    }
    for (size_t c = 0; c < packing->contacts.count; c++) {
        stored += 0.5 * (dem->fn[c] * dem->fn[c] + dem->ft[c] * dem->ft[c]) / 1e7; /* kt = kn */
        if ((size_t)packing->contacts.j[c] >= grains->count)
            continue;
        between++;
        sliding += dem->status[c] == STATUS_SLIP;
    }
    check_near(number_of(file, "solid_fraction"), area / (width * height), 1e-12);
    check_near(number_of(file, "sliding"), sliding / between, 1e-12);
    check_near(number_of(file, "rattlers"), rattlers / (double)grains->count, 1e-12);
    check_near(number_of(file, "stored_J"), stored, 1e-9 * stored);
    check_near(number_of(file, "static"), 1, 0);
    check_at_most(number_of(file, "unbalanced"), 1e-6);
    check_done(state_read_numbers(file, "state", "weber_stress_N_per_m", weber, 4));
    check_done(state_read_numbers(file, "state", "wall_stress_N_per_m", walls, 4));
    check_near(walls[0], -packing->walls.fx[1] / height, 1e-6 * walls[0]);
    check_near(walls[3], -packing->walls.fy[2] / width, 1e-6 * walls[3]);
    check_near(number_of(file, "kappa"), 1e7 / (0.5 * (weber[0] + weber[3])), 1e-6);
    check_near(weber[0], walls[0], 1e-6 * walls[0]);
    check_near(weber[3], walls[3], 1e-6 * walls[3]);
}

static void numbers_of_a_state_follow_from_its_columns(void **state)
{
    (void)state;
    static const char *const files[] = {"0000.truth.hdf", "0001.truth.hdf", "loads.csv", "states.csv", "scene.json"};
    char folder[] = "test_series_folder_XXXXXX", path[5][64];
    assert_non_null(mkdtemp(folder));
    for (int k = 0; k < 5; k++)
        snprintf(path[k], sizeof path[k], "%s/%s", folder, files[k]);
    simulate_into(path[4], folder);
    for (int k = 0; k < 2; k++) {
        struct packing packing = {0};
        check_done(packing_read(path[k], &packing));
        struct state *file = state_open(path[k]);
        assert_non_null(file);
        check_numbers(file, &packing);
        if (k)
            assert_true(number_of(file, "sliding") > 0 && number_of(file, "inertial_number") > 0);
        state_close(file);
        packing_free(&packing);
    }
    for (int k = 0; k < 5; k++)
        assert_int_equal(unlink(path[k]), 0);
    assert_int_equal(rmdir(folder), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_of_a_state_follow_from_its_columns),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
