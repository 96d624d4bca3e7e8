/* A frame in simple shear: side walls that lean by 10 degrees. Two chains of discs that cross in one disc, one at right
 * angles to the side walls and one upright, carry the loads of their walls and nothing else, whatever the friction; and
 * a packing sheared by simulate. */
#include "tests/unit/force_checks.h"

#include "forces/network/network.h"
#include "pipeline/packing/stress.h"

enum { ARM = 2, CHAIN = 2 * ARM + 1, DISCS = 4 * ARM + 1 };

static const double LEAN = 10 * M_PI / 180, RADIUS = 0.01, SIDE_LOAD = 700, TOP_LOAD = 450;

/* Leaning wall from the foot upwards, so that the inside is on its left; distance `out` from the centre. */
static void put_wall(struct packing *packing, size_t w, const char *name, struct vec in, double out, double half)
{
    struct walls *walls = &packing->walls;
    struct vec along = vec_scale(-1, vec_turn(in)), middle = vec_scale(-out, in);
    memcpy(walls->name[w], name, strlen(name) + 1);
    walls->x0[w] = middle.x - half * along.x, walls->y0[w] = middle.y - half * along.y;
    walls->x1[w] = middle.x + half * along.x, walls->y1[w] = middle.y + half * along.y;
    walls->radius[w] = 0;
    assert_true(vec_dot(wall_inward(walls, w), in) > 1 - 1e-12);
}

/* The chains meet in disc 0 at the centre; the frame is the rhombus around them. `error`: overlaps times that. */
static void crossed_chains(struct packing *packing, double kn, double error)
{
    const double reach = CHAIN * RADIUS, half = reach / cos(LEAN);
    const struct vec side = vec(cos(LEAN), -sin(LEAN)), up = vec(0, 1); /* side: outward normal of the right wall */
    discs_begin(packing, DISCS);
    disc_put(packing, 0, 0, 0, RADIUS);
    for (size_t k = 1; k <= ARM; k++)
        for (size_t arm = 0; arm < 4; arm++) {
            struct vec along = vec_scale((arm % 2 ? -1 : 1) * 2 * RADIUS * (double)k, arm < 2 ? side : up);
            disc_put(packing, 4 * (k - 1) + arm + 1, along.x, along.y, RADIUS);
        }
    discs_box(packing, 1, 1, 0);
    put_wall(packing, 0, "bottom", up, reach, half);
    put_wall(packing, 1, "right", vec_scale(-1, side), reach, half);
    put_wall(packing, 2, "top", vec_scale(-1, up), reach, half);
    put_wall(packing, 3, "left", side, reach, half);
    discs_load_wall(packing, "right", -SIDE_LOAD * side.x, -SIDE_LOAD * side.y);
    discs_load_wall(packing, "top", NAN, -TOP_LOAD);
    discs_touch(packing, 1e-9);
    assert_int_equal(packing->contacts.count, 2 * (CHAIN + 1));
    for (size_t c = 0; c < packing->contacts.count; c++)
        packing->contacts.overlap[c] = error * (fabs(packing->contacts.nx[c]) > 0.5 ? SIDE_LOAD : TOP_LOAD) / kn;
}

static void check_chains(const struct packing *packing, const struct forces *forces)
{
    const struct vec side = vec(cos(LEAN), -sin(LEAN));
    const double reach = CHAIN * RADIUS, area = 4 * reach * reach / cos(LEAN);
    for (size_t c = 0; c < packing->contacts.count; c++) {
        check_near(forces->contact.fn[c], fabs(packing->contacts.nx[c]) > 0.5 ? SIDE_LOAD : TOP_LOAD, 1e-3);
        check_near(forces->contact.ft[c], 0, 1e-3);
    }
    /* Weber: force times length of each chain, along itself, over the area of the rhombus */
    const double across = SIDE_LOAD * 2 * reach / area, upright = TOP_LOAD * 2 * reach / area;
    double between;
    check_done(packing_area(packing, &between));
    check_near(between, area, 1e-12);
    check_near(forces->stress[0][0], across * side.x * side.x, 1e-5 * across);
    check_near(forces->stress[0][1], across * side.x * side.y, 1e-5 * across);
    check_near(forces->stress[1][0], across * side.y * side.x, 1e-5 * across);
    check_near(forces->stress[1][1], across * side.y * side.y + upright, 1e-5 * across);
}

static void chains_between_leaning_walls(void **state)
{
    (void)state;
    static const double mu[] = {0, 0.5};
    for (int m = 0; m < 2; m++)
        for (int method = METHOD_CDM; method <= METHOD_MAP; method++)
            for (int start = START_ZERO; start <= START_OVERLAP; start++) {
                struct packing packing;
                struct forces forces;
                struct force_options options = usual();
                options.law.mu = options.law.mu_wall = mu[m];
                options.start = (enum force_start)start;
                crossed_chains(&packing, KN, 1);
                infer_and_check(&packing, &options, (enum force_method)method, &forces);
                assert_true(forces.converged);
                check_chains(&packing, &forces);
                forces_free(&forces);
                packing_free(&packing);
            }
}

/* kn wrong by 20 %: the virial of the loads on leaning walls, F . x about the corner where left and bottom meet, is
 * the sum of force times length of both chains and mends it. */
static void virial_of_leaning_walls(void **state)
{
    (void)state;
    struct packing packing;
    struct network network;
    struct forces forces;
    struct network_options network_options = {.wall_mass = 100};
    struct force_options options = usual();
    crossed_chains(&packing, KN, 1.2);
    check_done(network_build(&packing, &options.law, &network_options, &network));
    const double virial = (SIDE_LOAD + TOP_LOAD) * 2 * CHAIN * RADIUS;
    check_near(network.virial * network.force * network.radius, virial, 1e-9 * virial);
    network_free(&network);
    options.start = START_OVERLAP, options.rescale = 1;
    for (int method = METHOD_QSM; method <= METHOD_MAP; method++) {
        infer_and_check(&packing, &options, (enum force_method)method, &forces);
        assert_true(forces.converged);
        check_chains(&packing, &forces);
        forces_free(&forces);
    }
    /* cem keeps the forces of the overlaps, scaled: right without any equilibrium */
    check_done(infer_forces(&packing, &options, METHOD_CEM, &forces));
    check_chains(&packing, &forces);
    forces_free(&forces);
    packing_free(&packing);
}

static int keep_last(const struct packing *packing, const struct simulation_state *state, void *user)
{
    if (state->index == 1)
        copy_packing(packing, user);
    return 0;
}

/* 120 grains, side walls at 10 degrees: equilibrium added up here, the stress of the walls, the true forces. */
static void a_packing_in_simple_shear(void **state)
{
    (void)state;
    static const double least[METHOD_COUNT] = {0, 0.9, 0.95, 0.999};
    struct packing packing = {0};
    struct simulation simulation = SIMULATION_DEFAULT;
    const struct grade grading[] = {{52, 8e-3}, {28, 12e-3}, {26, 14e-3}, {14, 20e-3}};
    const struct loading_steps steps[] = {{1, tan(LEAN)}};
    simulation.grading = grading, simulation.grade_count = 4;
    simulation.law = (struct contact_law){.row = &linear_law, .kn = KN, .kt_over_kn = 1, .mu = 0.5};
    simulation.kappa = 300;
    simulation.tolerance = 1e-9;
    simulation.test = TEST_SIMPLE_SHEAR;
    simulation.steps = steps, simulation.step_count = 1;
    check_done(simulate(&simulation, keep_last, &packing));
    long right = walls_find(&packing.walls, "right");
    check_near(fabs(wall_inward(&packing.walls, (size_t)right).y), sin(LEAN), 1e-6);
    for (int method = METHOD_CDM; method <= METHOD_MAP; method++) {
        struct force_options options = usual();
        struct forces forces;
        options.start = START_OVERLAP;
        infer_and_check(&packing, &options, (enum force_method)method, &forces);
        assert_true(forces.converged || method == METHOD_CDM);
        check_at_most(least[method], r_fn(&packing, &forces));
        for (int d = 0; d < 4; d++)
            check_near(forces.stress[d / 2][d % 2], packing.forces[0].stress[d / 2][d % 2],
                       (method == METHOD_CDM ? 0.05 : 0.02) * packing.forces[0].stress[1][1]);
        forces_free(&forces);
    }
    packing_free(&packing);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(chains_between_leaning_walls),
        cmocka_unit_test(virial_of_leaning_walls),
        cmocka_unit_test(a_packing_in_simple_shear),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
