/* What map believes and says, against formulas: how probable a contact is, how far the barrier keeps forces from the
 * edges of their cones, and which contacts count as open or slipping. */
#include <stdlib.h>

#include "tests/unit/discs.h"

#include "forces/infer_forces.h"
#include "forces/network/evidence.h"
#include "forces/network/network.h"
#include "forces/network/network_result.h"

#define MU 0.5

/* Disc 2 on the fixed discs 0 and 1, branches at 45 degrees, P = 1530 N downwards (thesis Fig. 2.11). By symmetry both
 * contacts carry fn and a tangential force that helps, with fn + ft = P / sqrt(2). */
static const double HELD = 1530 / 1.4142135623730951;

static void three_discs(struct packing *packing)
{
    const double radius = 5.7e-3, half = 2 * radius * sqrt(0.5);
    discs_begin(packing, 3);
    disc_put(packing, 0, -half, 0, radius);
    disc_put(packing, 1, half, 0, radius);
    disc_put(packing, 2, 0, half, radius);
    packing->grains.flags[0] = packing->grains.flags[1] = GRAIN_FIXED;
    packing->grains.load_y[2] = -1530;
    discs_touch(packing, 1e-9);
}

static struct force_options options_at(enum force_start start)
{
    struct force_options options = FORCE_OPTIONS_DEFAULT;
    options.law.kn = 5e7, options.law.mu = MU;
    options.start = start;
    options.tolerance = 1e-11;
    return options;
}

static void build(const struct packing *packing, const struct force_options *options, struct network *network)
{
    check_done(
        network_build(packing, &options->law, &(struct network_options){.candidates = 1, .wall_mass = 100}, network));
}

/* Without its own column, the probability that a candidate is closed is that its true overlap is positive, the error
 * being normal: 84.134 % where the overlap is one standard error. A decided contact is certain; a stated probability
 * counts. */
static void a_candidate_is_as_probable_as_its_overlap(void **state)
{
    (void)state;
    static const double overlaps[] = {1, 0, -1, -2}, closed[] = {0.841344746, 0.5, 0.158655254, 0.022750132};
    struct packing packing;
    struct network network;
    struct evidence evidence;
    struct force_options options = options_at(START_ZERO);
    const double error = 1e-6;
    double f[4] = {0};
    three_discs(&packing);
    struct contacts *contacts = &packing.contacts;
    for (int k = 0; k < 2; k++)
        check_done(table_add(&CONTACTS, contacts, k ? "s_overlap" : "flags"));
    contacts->flags[0] = CONTACT_CANDIDATE, contacts->flags[1] = 0;
    contacts->s_overlap[0] = contacts->s_overlap[1] = error;
    for (int k = 0; k < 4; k++) {
        contacts->overlap[0] = overlaps[k] * error, contacts->overlap[1] = -error;
        build(&packing, &options, &network);
        assert_int_equal(network.count, 2);
        check_done(evidence_build(&packing, &network, &options, f, &evidence));
        check_near(evidence.probability[0], closed[k], 1e-8);
        check_near(evidence.probability[1], 1, 0);
        evidence_free(&evidence);
        network_free(&network);
    }
    check_done(table_add(&CONTACTS, contacts, "probability"));
    contacts->probability[0] = 0.3, contacts->probability[1] = NAN;
    build(&packing, &options, &network);
    check_done(evidence_build(&packing, &network, &options, f, &evidence));
    check_near(evidence.probability[0], 0.3, 0);
    check_near(evidence.probability[1], 1, 0);
    evidence_free(&evidence);
    network_free(&network);
    packing_free(&packing);
}

/* d/dt of the objective of one contact at ft = t, fn = a - t, beliefs fn ~ N(1, 1), ft ~ N(0, 2/3 mu^2), and the
 * barrier -w log(mu fn - ft) - w log(mu fn + ft). */
static double slope(double a, double w, double t)
{
    double fn = a - t, variance = 2.0 / 3 * MU * MU;
    return -(fn - 1) + t / variance + w * (MU + 1) / (MU * fn - t) + w * (MU - 1) / (MU * fn + t);
}

/* Four force components less three equations over four edges: the weight of each edge is 1/4 (map.c). The forces are
 * the minimum along the static line, found here by halving. */
static void the_barrier_weighs_what_is_free(void **state)
{
    (void)state;
    struct packing packing;
    struct network network;
    struct forces forces;
    struct force_options options = options_at(START_ZERO);
    three_discs(&packing);
    build(&packing, &options, &network);
    double a = HELD / network.force, low = -MU * a / (1 - MU), high = MU * a / (1 + MU);
    for (int k = 0; k < 100; k++) {
        double middle = 0.5 * (low + high);
        *(slope(a, 0.25, middle) < 0 ? &low : &high) = middle;
    }
    check_done(infer_forces(&packing, &options, METHOD_MAP, &forces));
    for (size_t c = 0; c < 2; c++)
        check_near(forces.contact.fn[c] / network.force, a - low, 1e-3);
    forces_free(&forces);
    network_free(&network);
    packing_free(&packing);
}

/* Forces in equilibrium, `mobilised` of the friction used: every method starts there and stays. */
static uint32_t status_at(double mobilised, enum force_method method)
{
    struct packing packing, from = {0};
    struct forces forces, start;
    struct force_options options = options_at(START_FILE);
    three_discs(&packing);
    three_discs(&from);
    options.from = &from;
    check_done(infer_forces(&packing,
                            &(struct force_options){.law = options.law, .start = START_ZERO, .tolerance = 1e-9},
                            METHOD_MAP, &start));
    for (size_t c = 0; c < 2; c++) {
        start.contact.ft[c] = (c ? -1 : 1) * MU * mobilised * HELD / (1 + MU * mobilised);
        start.contact.fn[c] = HELD / (1 + MU * mobilised);
    }
    from.forces = calloc(1, sizeof *from.forces);
    from.forces[0] = start, from.force_count = 1;
    check_done(infer_forces(&packing, &options, method, &forces));
    check_near(forces.contact.fn[0], start.contact.fn[0], 1e-6 * HELD);
    uint32_t status = forces.contact.status[0];
    assert_int_equal(forces.contact.status[1], status);
    forces_free(&forces);
    packing_free(&from);
    packing_free(&packing);
    return status;
}

/* map: slip within 1 % of the edge (docs/forces.md); the others only on the edge, up to rounding. */
static void slip_begins_at_the_edge(void **state)
{
    (void)state;
    assert_int_equal(status_at(0.95, METHOD_MAP), STATUS_STICK);
    assert_int_equal(status_at(0.985, METHOD_MAP), STATUS_STICK);
    assert_int_equal(status_at(0.995, METHOD_MAP), STATUS_SLIP);
    assert_int_equal(status_at(0.995, METHOD_QSM), STATUS_STICK);
    assert_int_equal(status_at(1 - 4e-9, METHOD_QSM), STATUS_STICK);
    assert_int_equal(status_at(1 - 4e-9, METHOD_CDM), STATUS_STICK);
    assert_int_equal(status_at(1, METHOD_QSM), STATUS_SLIP);
    assert_int_equal(status_at(1, METHOD_CDM), STATUS_SLIP);
}

/* The margin counts in <fn> towards the corner, as a share towards the edges; a force that is not known is not used. */
static void the_margin_is_kept(void **state)
{
    (void)state;
    static const double fns[] = {0.019, 0.021, 1, 1, NAN}, fts[] = {0, 0, 0.481, 0.491, 0};
    static const uint32_t expected[] = {STATUS_OPEN, STATUS_STICK, STATUS_STICK, STATUS_SLIP, STATUS_NOT_USED};
    struct packing packing;
    struct network network;
    struct force_options options = options_at(START_ZERO);
    const double unbalance[3] = {0};
    three_discs(&packing);
    build(&packing, &options, &network);
    for (int k = 0; k < 5; k++) {
        struct forces forces = {0};
        double f[4] = {fns[k], -fts[k], 1, 0};
        check_done(result_store(&packing, &network, 0.02, f, unbalance, &forces));
        assert_int_equal(forces.contact.status[0], expected[k]);
        assert_int_equal(forces.contact.status[1], STATUS_STICK);
        forces_free(&forces);
    }
    network_free(&network);
    packing_free(&packing);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_candidate_is_as_probable_as_its_overlap),
        cmocka_unit_test(the_barrier_weighs_what_is_free),
        cmocka_unit_test(slip_begins_at_the_edge),
        cmocka_unit_test(the_margin_is_kept),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
