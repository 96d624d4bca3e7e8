/* Convex discs in the corners of the box, judged from state files and by hand: who touches them, what they push, and
 * the equations of the walls that they enter. */
#include "tests/check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "pipeline/speak/error.h"
#include "pipeline/packing/packing_file.h"
#include "simulation/dem/dem.h"
#include "simulation/series_folder.h"
#include "simulation/dem/simulate_scene.h"

enum { BOTTOM, RIGHT, TOP, LEFT, BOTTOM_LEFT, BOTTOM_RIGHT, TOP_RIGHT, TOP_LEFT, WALL_ROWS };
static const double KN = 1e7, MU_WALL = 0.3, CORNER = 0.012;

static const char SCENE[] =
    "{\"schema\": \"film.scene/1\", \"name\": \"test\",\n"
    "\"grains\": {\"density_kg_m3\": 700, \"length_m\": 0.05},\n"
    "\"contact\": {\"kn_N_per_m\": 1e7, \"mu\": 0.2, \"mu_wall\": 0.3},\n"
    "\"simulation\": {\"grading\": [[40, 0.008], [20, 0.012]], \"kappa\": 200, \"inertial_number\": 1e-2,\n"
    "                 \"corner_radius_m\": 0.012, \"test\": \"%s\", \"steps\": [[2, 4e-3]]}}\n";

/* Three states of sixty discs, read from their files. */
static void run_and_read(const char *test, struct packing packing[3])
{
    char folder_path[] = "test_corner_discs_XXXXXX", path[64], line[200];
    struct scene scene = {0};
    struct simulation_plan plan = {0};
    struct series_folder folder = {0};
    assert_non_null(mkdtemp(folder_path));
    snprintf(path, sizeof path, "%s/scene.json", folder_path);
    FILE *text = fopen(path, "w");
    assert_non_null(text);
    fprintf(text, SCENE, test);
    assert_int_equal(fclose(text), 0);
    check_done(scene_read(path, &scene));
    check_done(simulation_read(&scene, &plan));
    check_near(plan.simulation.corner_radius, CORNER, 0);
    check_done(series_folder_open(&folder, &scene, "{}", folder_path, simulation_states(&plan.simulation)));
    check_done(simulate(&plan.simulation, series_folder_save, &folder));
    check_done(series_folder_close(&folder));
    simulation_plan_free(&plan);
    scene_free(&scene);
    assert_int_equal(unlink(path), 0);
    for (int k = 0; k < 3; k++) {
        snprintf(path, sizeof path, "%s/%04d.truth.hdf", folder_path, k);
        check_done(packing_read(path, &packing[k]));
        assert_int_equal(unlink(path), 0);
    }
    snprintf(path, sizeof path, "%s/loads.csv", folder_path);
    text = fopen(path, "r");
    assert_non_null(text);
    int lines = 0;
    while (fgets(line, sizeof line, text))
        lines++;
    fclose(text);
    assert_int_equal(lines, 1 + 3 * 4); /* the four sides only */
    assert_int_equal(unlink(path), 0);
    snprintf(path, sizeof path, "%s/states.csv", folder_path);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(rmdir(folder_path), 0);
}

static double mean_fn(const struct packing *packing)
{
    double sum = 0;
    for (size_t c = 0; c < packing->contacts.count; c++)
        sum += packing->forces->contact.fn[c] / (double)packing->contacts.count;
    return sum;
}

/* Grains, and the walls with the discs at their ends (in x for the side walls, in y for bottom and top). */
static void check_equilibrium(const struct packing *packing)
{
    const struct contacts *contacts = &packing->contacts;
    const struct grains *grains = &packing->grains;
    const struct walls *walls = &packing->walls;
    size_t bodies = grains->count + walls->count;
    double(*sum)[3] = calloc(bodies, sizeof *sum), tolerance = 1e-6 * mean_fn(packing);
    for (size_t c = 0; c < contacts->count; c++) {
        double fn = packing->forces->contact.fn[c], ft = packing->forces->contact.ft[c];
        double fx = fn * contacts->nx[c] - ft * contacts->ny[c], fy = fn * contacts->ny[c] + ft * contacts->nx[c];
        for (int end = 0; end < 2; end++) {
            int64_t k = end ? contacts->j[c] : contacts->i[c];
            double sign = end ? 1 : -1;
            sum[k][0] += sign * fx, sum[k][1] += sign * fy;
            if ((size_t)k < grains->count)
                sum[k][2] += sign * ((contacts->x[c] - grains->x[k]) * fy - (contacts->y[c] - grains->y[k]) * fx) /
                             grains->radius[k];
        }
    }
    for (size_t k = 0; k < grains->count; k++)
        for (int component = 0; component < 3; component++)
            check_at_most(fabs(sum[k][component]), tolerance);
    double(*on)[3] = sum + grains->count;
    static const int ends[4][2] = {
        {BOTTOM_LEFT, BOTTOM_RIGHT}, {BOTTOM_RIGHT, TOP_RIGHT}, {TOP_RIGHT, TOP_LEFT}, {TOP_LEFT, BOTTOM_LEFT}};
    for (int w = 0; w < 4; w++) {
        int axis = w == RIGHT || w == LEFT ? 0 : 1;
        double load[2] = {walls->fx[w], walls->fy[w]};
        for (int a = 0; a < 2; a++) {
            double discs = a == axis ? on[ends[w][0]][a] + on[ends[w][1]][a] : 0;
            check_at_most(fabs(load[a] + on[w][a] + discs), tolerance);
        }
    }
    free(sum);
}

/* Every grain that reaches a disc has its row, by geometry and law. Returns how many there are. */
static size_t check_disc_contacts(const struct packing *packing)
{
    const struct contacts *contacts = &packing->contacts;
    const struct grains *g = &packing->grains;
    const struct walls *walls = &packing->walls;
    size_t touching = 0, rows = 0;
    for (size_t k = 0; k < g->count; k++)
        for (size_t w = BOTTOM_LEFT; w < WALL_ROWS; w++)
            touching += hypot(g->x[k] - walls->x0[w], g->y[k] - walls->y0[w]) < g->radius[k] + walls->radius[w];
    for (size_t c = 0; c < contacts->count; c++) {
        size_t i = (size_t)contacts->i[c], j = (size_t)contacts->j[c];
        if (j < g->count + BOTTOM_LEFT)
            continue;
        size_t w = j - g->count;
        double dx = walls->x0[w] - g->x[i], dy = walls->y0[w] - g->y[i], d = hypot(dx, dy);
        double overlap = g->radius[i] + CORNER - d, arm = g->radius[i] - 0.5 * overlap;
        double fn = packing->forces->contact.fn[c];
        rows++;
        check_near(contacts->overlap[c], overlap, 1e-15);
        check_near(contacts->nx[c], dx / d, 1e-13);
        check_near(contacts->ny[c], dy / d, 1e-13);
        check_near(contacts->x[c], g->x[i] + arm * dx / d, 1e-15);
        check_near(fn, KN * overlap, 1e-9 * fn);
        check_at_most(fabs(packing->forces->contact.ft[c]), MU_WALL * fn * (1 + 1e-12));
        assert_true(contacts->flags[c] & CONTACT_WALL);
    }
    assert_int_equal(rows, touching);
    return rows;
}

static void check_discs_in_corners(const struct walls *walls)
{
    assert_int_equal(walls->count, WALL_ROWS);
    static const char *const names[] = {"bottom-left", "bottom-right", "top-right", "top-left"};
    for (int k = 0; k < 4; k++) {
        assert_int_equal(walls_find(walls, names[k]), BOTTOM_LEFT + k);
        check_near(walls->x0[BOTTOM_LEFT + k], walls->x0[k], 0);
        check_near(walls->y0[BOTTOM_LEFT + k], walls->y0[k], 0);
        check_near(walls->radius[BOTTOM_LEFT + k], CORNER, 0);
    }
}

/* What a disc contact has lost in overlap since the last state is its motion along the normal. */
static void check_motions(const struct packing *then, const struct packing *now)
{
    for (size_t c = 0; c < now->contacts.count; c++)
        for (size_t o = 0; o < then->contacts.count; o++)
            if ((size_t)now->contacts.j[c] >= now->grains.count + BOTTOM_LEFT &&
                now->contacts.i[c] == then->contacts.i[o] && now->contacts.j[c] == then->contacts.j[o])
                check_near(now->contacts.dun[c], then->contacts.overlap[o] - now->contacts.overlap[c],
                           1e-3 * mean_fn(now) / KN);
}

static void check_series(const char *test)
{
    struct packing packing[3] = {{.length_m = 0}};
    size_t touching = 0;
    run_and_read(test, packing);
    for (int k = 0; k < 3; k++) {
        check_discs_in_corners(&packing[k].walls);
        check_equilibrium(&packing[k]);
        touching += check_disc_contacts(&packing[k]);
        if (k)
            check_motions(&packing[k - 1], &packing[k]);
    }
    assert_true(touching > 3);
    for (int k = 0; k < 3; k++)
        packing_free(&packing[k]);
}

static void states_are_static(void **state)
{
    (void)state;
    check_series("biaxial_vertical");
}

static void sheared_states_are_static(void **state)
{
    (void)state;
    check_series("simple_shear");
}

/* ---- one grain by hand ---- */

static struct simulation one_grain(struct placed_disc *grain)
{
    struct simulation simulation = SIMULATION_DEFAULT;
    simulation.discs = grain;
    simulation.disc_count = 1;
    simulation.box[0] = 0.3, simulation.box[1] = 0.2;
    simulation.corner_radius = 0.05;
    simulation.law = (struct contact_law){.row = &linear_law, .kn = 1e7, .kt_over_kn = 1, .mu = 0.5};
    return simulation;
}

struct wedge {
    int called;
    double mirror_x, mirror_y; /* 1: left, bottom; -1: right, top */
};

/* Load (-10, -5) N at the left of the bottom: the disc's normal leans as the rims say, 0.01 up on 0.06. */
static int check_wedge(const struct packing *packing, const struct simulation_state *state, void *user)
{
    struct wedge *wedge = user;
    size_t disc = (size_t)(wedge->mirror_y > 0 ? (wedge->mirror_x > 0 ? BOTTOM_LEFT : BOTTOM_RIGHT)
                                               : (wedge->mirror_x > 0 ? TOP_LEFT : TOP_RIGHT));
    size_t floor_row = (size_t)(wedge->mirror_y > 0 ? BOTTOM : TOP),
           side = (size_t)(wedge->mirror_x > 0 ? LEFT : RIGHT);
    const double fn = 10 / sqrt(1 - 1.0 / 36), up = fn / 6;
    const struct contacts *contacts = &packing->contacts;
    assert_true(state->relaxed);
    assert_int_equal(contacts->count, 2);
    assert_int_equal(contacts->j[0], 1 + floor_row);
    assert_int_equal(contacts->j[1], 1 + disc);
    check_near(packing->forces->contact.fn[0], 5 - up, 1e-3);
    check_near(packing->forces->contact.fn[1], fn, 1e-3);
    check_near(contacts->overlap[1], fn / 1e7, 1e-10);
    check_near(contacts->nx[1], -wedge->mirror_x * sqrt(1 - 1.0 / 36), 1e-4);
    check_near(contacts->ny[1], -wedge->mirror_y / 6, 1e-4);
    /* reactions: the side wall holds the disc in x, the floor holds grain and disc in y */
    check_near(packing->walls.fx[side], wedge->mirror_x * 10, 1e-3);
    check_near(packing->walls.fy[floor_row], wedge->mirror_y * 5, 1e-3);
    check_near(packing->walls.fx[disc], 0, 0);
    wedge->called++;
    return 0;
}

static void a_grain_is_wedged_between_a_disc_and_a_wall(void **state)
{
    (void)state;
    for (int corner = 0; corner < 4; corner++) {
        double mx = corner % 2 ? -1 : 1, my = corner / 2 ? -1 : 1;
        struct placed_disc grain = {mx > 0 ? 0.061 : 0.239, my > 0 ? 0.011 : 0.189, 0.01, -10 * mx, -5 * my, 0, 0};
        struct simulation simulation = one_grain(&grain);
        struct wedge wedge = {0, mx, my};
        check_done(simulate(&simulation, check_wedge, &wedge));
        assert_int_equal(wedge.called, 1);
    }
}

/* ---- a tilted box ---- */

static double energy_at(struct dem *dem, int freedom, double change)
{
    dem->box.size[freedom] += change;
    check_done(dem_forces_static(dem, 0));
    double stored = dem_energy(dem).stored;
    dem->box.size[freedom] -= change;
    return stored;
}

/* What the discs push each freedom with is what the energy of the springs falls by when it moves. */
static void pushes_are_slopes_of_the_energy(void **state)
{
    (void)state;
    const double corner[4][2] = {{0, 0}, {0.1, 0}, {0.12, 0.1}, {0.02, 0.1}}, degrees[4] = {40, 130, 215, -50};
    struct dem dem;
    check_done(dem_alloc(&dem, 4));
    dem.law = (struct contact_law){.row = &linear_law, .kn = 1e6, .kt_over_kn = 1};
    dem.skin = 0.003;
    dem.box = (struct dem_box){.given = 1, .size = {0.1, 0.1, 0.2}, .corner_radius = 0.01};
    for (int k = 0; k < 4; k++) {
        double distance = 0.0149 - 2e-5 * k, angle = degrees[k] * acos(-1) / 180;
        dem.grains[k] = (struct dem_grain){.x = corner[k][0] + distance * cos(angle),
                                           .y = corner[k][1] + distance * sin(angle),
                                           .radius = 0.005,
                                           .mass = 1,
                                           .inertia = 1};
    }
    for (int f = 0; f < BOX_FREEDOMS; f++) {
        double step = 1e-7, slope = (energy_at(&dem, f, step) - energy_at(&dem, f, -step)) / (2 * step);
        energy_at(&dem, f, 0);
        assert_true(fabs(dem.box.push[f]) > 0.5);
        check_near(dem.box.push[f], -slope, 1e-4 * fabs(slope));
    }
    dem_free(&dem);
}

/* ---- refusals ---- */

static int not_called(const struct packing *packing, const struct simulation_state *state, void *user)
{
    (void)packing, (void)state, (void)user;
    fail_msg("a state of a bad simulation");
    return -1;
}

static void bad_corners_are_refused(void **state)
{
    (void)state;
    struct placed_disc grain = {0.05, 0.02, 0.01, 0, -5, 0, 0};
    struct simulation simulation = one_grain(&grain); /* on the disc */
    assert_int_equal(simulate(&simulation, not_called, NULL), -1);
    assert_non_null(strstr(error_message(), "corner disc"));
    grain.x = 0.15;
    simulation.corner_radius = 0.11; /* of a box 0.2 high */
    assert_int_equal(simulate(&simulation, not_called, NULL), -1);
    assert_non_null(strstr(error_message(), "corner_radius_m"));
    simulation.corner_radius = 0.05;
    simulation.box[0] = NAN;
    assert_int_equal(simulate(&simulation, not_called, NULL), -1);
    assert_non_null(strstr(error_message(), "box_m"));
    static const struct grade grading[] = {{60, 8e-3}};
    simulation = (struct simulation)SIMULATION_DEFAULT;
    simulation.grading = grading, simulation.grade_count = 1;
    simulation.law = (struct contact_law){.row = &linear_law, .kn = 1e7, .kt_over_kn = 1, .mu = 0.5};
    simulation.kappa = 200;
    simulation.corner_radius = 0.02; /* of discs that fill 0.06 by 0.06 */
    assert_int_equal(simulate(&simulation, not_called, NULL), -1);
    assert_non_null(strstr(error_message(), "quarter"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(states_are_static),
        cmocka_unit_test(sheared_states_are_static),
        cmocka_unit_test(a_grain_is_wedged_between_a_disc_and_a_wall),
        cmocka_unit_test(pushes_are_slopes_of_the_energy),
        cmocka_unit_test(bad_corners_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
