/* A contact law of one's own, as CONTRIBUTING has it: f = k x^2, k in N/m2 (the scene's young_Pa). Everything that a
 * law needs stands between the two lines; the rest checks that all calls of the house go through its row. */
#include "tests/check.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "forces/network/elastic.h"
#include "pipeline/speak/error.h"
#include "simulation/dem/dem_motion.h"
#include "pipeline/files/json.h"

/* ------------------------------------------------------------------------------------------------------------------ */
static struct contact_pair square_pair(const struct contact_law *law, double reduced_radius)
{
    (void)reduced_radius;
    return (struct contact_pair){.factor = law->young};
}

static double square_force(const struct contact_pair *pair, double overlap)
{
    return pair->factor * overlap * overlap;
}

static double square_overlap(const struct contact_pair *pair, double force)
{
    return sqrt(force / pair->factor);
}

/* dF/dx = 2 k x = 2 (k F)^1/2. */
static double square_stiffness(const struct contact_pair *pair, double force)
{
    return 2 * sqrt(pair->factor * force);
}

/* The integral of k x^2 dx. */
static double square_work(const struct contact_pair *pair, double overlap, double force)
{
    (void)pair;
    return force * overlap / 3;
}

static const struct law_key SQUARE_KEYS[] = {{"young_Pa", offsetof(struct contact_law, young), DBL_MIN, 1e15, 1}, {0}};
static const struct law square_law = {.name = "square",
                                      .says = "springs that stiffen",
                                      .keys = SQUARE_KEYS,
                                      .pair = square_pair,
                                      .force = square_force,
                                      .overlap = square_overlap,
                                      .stiffness = square_stiffness,
                                      .work = square_work};
/* ------------------------------------------------------------------------------------------------------------------ */

static const double K = 1e11;

static struct contact_law square(void)
{
    struct contact_law law = CONTACT_LAW_DEFAULT;
    law.row = &square_law, law.young = K, law.mu = 0.5;
    return law;
}

static int read_square(const char *text, struct contact_law *law)
{
    struct json *json = json_parse(text, strlen(text), "t.json");
    assert_non_null(json);
    int status = contact_law_read_as(&square_law, json, json_root(json), law);
    json_free(json);
    return status;
}

static void it_is_read_from_a_scene(void **state)
{
    (void)state;
    struct contact_law law = CONTACT_LAW_DEFAULT;
    check_done(read_square("{\"law\": \"square\", \"young_Pa\": 1e11, \"mu\": 0.5}", &law));
    check_near(law.young, K, 0);
    check_near(law.mu, 0.5, 0);
    assert_true(contact_law_known(&law));
    assert_int_equal(read_square("{\"mu\": 0.5}", &law), -1);
    assert_non_null(strstr(error_message(), "law 'square' (springs that stiffen) needs young_Pa"));
    assert_int_equal(read_square("{\"young_Pa\": 1, \"poisson\": 0.3}", &law), -1); /* no key of this law */
}

static void springs_and_tangents_follow_it(void **state)
{
    (void)state;
    struct contact_law law = square();
    struct contact_pair pair = contact_pair_of(&law, 0.01);
    struct contact_spring spring = {0};
    double x = 2e-5, fn = K * x * x, ft = 0;
    contact_spring_press(&law, &pair, x, &spring);
    check_near(spring.fn, fn, 1e-12 * fn);
    check_near(spring.stiffness, 2 * K * x, 1e-12 * spring.stiffness);
    check_near(contact_spring_energy(&law, &pair, x, &spring), K * x * x * x / 3, 1e-12 * fn * x);
    struct elastic_tangent tangent = elastic_tangent(&law, &pair, x);
    check_near(tangent.force, fn, 1e-12 * fn);
    check_near(tangent.stiffness, 2 * K * x, 1e-12 * tangent.stiffness);
    check_near(elastic_tangent(&law, &pair, -x).force, 0, 0);
    /* From x to 1.5 x, sliding by 0.1 x: stick; then far: slip; then apart. */
    assert_int_equal(contact_pair_advance(&law, &pair, 0.5, -0.5 * x, 0.1 * x, &fn, &ft), STATUS_STICK);
    check_near(fn, K * 2.25 * x * x, 1e-12 * fn);
    check_near(ft, -2 * K * 1.5 * x * 0.1 * x, 1e-12 * fn);
    assert_int_equal(contact_pair_advance(&law, &pair, 0.5, 0, 9 * x, &fn, &ft), STATUS_SLIP);
    check_near(ft, -0.5 * fn, 1e-12 * fn);
    assert_int_equal(contact_pair_advance(&law, &pair, 0.5, 2 * x, 0, &fn, &ft), STATUS_OPEN);
    check_near(fn, 0, 0);
}

/* Two discs of mass m meet at the relative speed v: at rest the overlap is x with k x^3 / 3 = m v^2 / 4. */
static void two_discs_rebound_by_it(void **state)
{
    (void)state;
    const struct servo held = {0};
    struct dem dem;
    check_done(dem_alloc(&dem, 2));
    dem.law = square();
    dem.skin = 1e-3;
    for (int k = 0; k < 2; k++) {
        struct dem_grain *g = &dem.grains[k];
        g->radius = 0.01, g->mass = 0.2, g->inertia = 1e-5;
        g->x = k * 0.0201, g->vx = k ? -0.05 : 0.05;
    }
    double deepest = cbrt(0.75 * 0.2 * 0.01 / K), whole = dem_energy(&dem).kinetic, most = 0, worst = 0;
    struct stepping stepping = {.dt = 1e-3 * sqrt(0.1 / (2 * K * deepest))};
    for (long step = 0; step < 60000; step++) {
        check_done(dem_step(&dem, &held, &stepping));
        struct dem_energy now = dem_energy(&dem);
        most = fmax(most, dem.pair_count ? dem.pairs[0].overlap : 0);
        worst = fmax(worst, fabs(now.kinetic + now.stored - whole) / whole);
        if (dem.grains[0].vx < 0 && !dem.pairs[0].touching)
            break;
    }
    check_near(most, deepest, 1e-4 * deepest);
    check_at_most(worst, 2e-3); /* velocities are half a step behind the places */
    check_near(dem.grains[1].vx, 0.05, 1e-5);
    check_near(dem.grains[0].vx, -0.05, 1e-5);
    dem_free(&dem);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_is_read_from_a_scene),
        cmocka_unit_test(springs_and_tangents_follow_it),
        cmocka_unit_test(two_discs_rebound_by_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
