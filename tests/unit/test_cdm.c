/* Contact dynamics: the order of the contacts, threads, acceleration. */
#include <omp.h>

#include "forces/methods/cdm_order.h"
#include "forces/methods/method.h"
#include "tests/unit/force_checks.h"

static int keep_state(const struct packing *packing, const struct simulation_state *state, void *user)
{
    if (state->index == 0)
        copy_packing(packing, user);
    return 0;
}

static int draw(void **state)
{
    static struct packing packing; /* 120 grains, kappa = 100 */
    const struct grade grading[] = {{52, 8e-3}, {28, 12e-3}, {26, 14e-3}, {14, 20e-3}};
    struct simulation simulation = SIMULATION_DEFAULT;
    simulation.grading = grading, simulation.grade_count = 4;
    simulation.law = (struct contact_law){.row = &linear_law, .kn = KN, .kt_over_kn = 1, .mu = 0.5};
    simulation.kappa = 100;
    simulation.tolerance = 1e-9;
    check_done(simulate(&simulation, keep_state, &packing));
    *state = &packing;
    return 0;
}

static int forget(void **state)
{
    packing_free(*state);
    return 0;
}

static struct force_options cdm_options(void)
{
    struct force_options options = FORCE_OPTIONS_DEFAULT;
    options.law.kn = KN, options.law.mu = 0.5;
    options.start = START_ZERO;
    return options;
}

static void build(const struct packing *packing, struct network *network)
{
    struct force_options options = cdm_options();
    const struct network_options network_options = {.wall_mass = FORCE_WALL_MASS};
    check_done(network_build(packing, &options.law, &network_options, network));
}

/* Every contact once; contacts of one colour share no degree of freedom. */
static void colours_share_no_grain(void **state)
{
    struct network network;
    struct cdm_order order;
    build(*state, &network);
    check_done(cdm_order_build(&network, 1, &order));
    int *seen = calloc(network.count, sizeof *seen), *owner = calloc(network.dofs, sizeof *owner);
    assert_true(order.colours >= 3 && order.colours <= 16);
    assert_int_equal(order.start[order.colours + 1], network.count);
    for (int colour = 0; colour <= order.colours; colour++)
        for (size_t k = order.start[colour]; k < order.start[colour + 1]; k++) {
            const int *dof = network.contact[order.contact[k]].dof;
            seen[order.contact[k]]++;
            for (int e = 0; e < NETWORK_WIDTH && dof[e] >= 0 && colour < order.colours; e++) {
                assert_int_not_equal(owner[dof[e]], colour + 1);
                owner[dof[e]] = colour + 1;
            }
        }
    for (size_t c = 0; c < network.count; c++)
        assert_int_equal(seen[c], 1);
    free(seen), free(owner);
    cdm_order_free(&order);
    network_free(&network);
}

static void solve(const struct packing *packing, const struct force_options *options, int threads, double **f,
                  size_t *count, struct outcome *outcome)
{
    struct network network;
    int before = omp_get_max_threads();
    build(packing, &network);
    *count = 2 * network.count;
    *f = calloc(*count, sizeof **f);
    omp_set_num_threads(threads);
    check_done(CDM_METHOD.solve(&(struct problem){packing, &network, options}, *f, outcome));
    omp_set_num_threads(before);
    network_free(&network);
}

static void the_same_bytes_with_one_and_two_threads(void **state)
{
    struct force_options options = cdm_options();
    struct outcome outcome[2];
    double *f[2];
    size_t count;
    options.colours = 1;
    options.iterations = 300;
    for (int k = 0; k < 2; k++)
        solve(*state, &options, k + 1, &f[k], &count, &outcome[k]);
    assert_memory_equal(f[0], f[1], count * sizeof(double));
    assert_true(outcome[0].iterations == 300 && outcome[0].imbalance == outcome[1].imbalance);
    free(f[0]), free(f[1]);
}

/* Every way ends in equilibrium, with admissible forces; acceleration takes fewer sweeps. */
static void acceleration_and_colours_reach_equilibrium(void **state)
{
    static const struct {
        int block, colours;
        double relaxation;
    } ways[] = {{0, 0, 1}, {0, 0, 1.3}, {10, 0, 1}, {0, 1, 1}, {10, 1, 1.3}};
    int plain = 0;
    for (size_t k = 0; k < sizeof ways / sizeof *ways; k++) {
        struct force_options options = cdm_options();
        struct outcome outcome;
        double *f;
        size_t count;
        options.tolerance = 1e-4;
        options.block = ways[k].block, options.colours = ways[k].colours, options.relaxation = ways[k].relaxation;
        solve(*state, &options, 1, &f, &count, &outcome);
        assert_true(outcome.converged && outcome.imbalance <= 1e-4);
        for (size_t c = 0; c < count; c += 2)
            assert_true(f[c] >= 0 && fabs(f[c + 1]) <= 0.5 * f[c] * (1 + 1e-12));
        plain = k == 0 ? outcome.iterations : plain;
        if (ways[k].block > 0)
            assert_true(outcome.iterations < plain / 2);
        free(f);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(colours_share_no_grain),
        cmocka_unit_test(the_same_bytes_with_one_and_two_threads),
        cmocka_unit_test(acceleration_and_colours_reach_equilibrium),
    };
    return cmocka_run_group_tests(tests, draw, forget);
}
