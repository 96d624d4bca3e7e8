/* The loading tests of simulate: each moves what it should and keeps what it should; small systems with known answers;
 * every contact law comes to rest. Judged from the tables of the packing. */
#include "tests/check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/laws/contact_spring.h"
#include "pipeline/speak/error.h"
#include "simulation/dem/simulate.h"

enum { MOST_STATES = 10 };
static const double PI = 3.141592653589793;

/* What the tests need of every state. */
struct record {
    double width, height, lean; /* of the box */
    double load[4][2];          /* of bottom, right, top, left */
    double mean_fn, unbalanced; /* the latter from the tables, relative */
    double boundary[2][2];      /* N/m: sum of the walls' contact forces times where they act, over the area */
    struct simulation_state state;
};
struct records {
    struct record row[MOST_STATES];
    size_t count;
    const struct contact_law *law; /* when given: every normal force is checked against its closed form */
};

/* Largest unbalanced component of any grain, from n, contact point, fn, ft and loads. */
static double unbalanced(const struct packing *packing)
{
    const struct contacts *c = &packing->contacts;
    const struct grains *g = &packing->grains;
    double(*sum)[3] = calloc(g->count + 4, sizeof *sum), largest = 0;
    for (size_t k = 0; k < g->count && g->load_x; k++)
        sum[k][0] = g->load_x[k], sum[k][1] = g->load_y[k];
    for (size_t k = 0; k < c->count; k++) {
        double fn = packing->forces->contact.fn[k], ft = packing->forces->contact.ft[k];
        double fx = fn * c->nx[k] - ft * c->ny[k], fy = fn * c->ny[k] + ft * c->nx[k];
        for (int end = 0; end < 2; end++) {
            size_t b = (size_t)(end ? c->j[k] : c->i[k]);
            double sign = end ? 1 : -1;
            sum[b][0] += sign * fx, sum[b][1] += sign * fy;
            if (b < g->count)
                sum[b][2] += sign * ((c->x[k] - g->x[b]) * fy - (c->y[k] - g->y[b]) * fx) / g->radius[b];
        }
    }
    for (size_t k = 0; k < g->count; k++)
        for (int component = 0; component < 3 && !(g->flags[k] & GRAIN_FIXED); component++)
            largest = fmax(largest, fabs(sum[k][component]));
    for (size_t w = 0; w < packing->walls.count; w++) {
        largest = fmax(largest, fabs(sum[g->count + w][0] + packing->walls.fx[w]));
        largest = fmax(largest, fabs(sum[g->count + w][1] + packing->walls.fy[w]));
    }
    free(sum);
    return largest;
}

static void check_law(const struct packing *packing, const struct contact_law *law)
{
    const struct contacts *c = &packing->contacts;
    const struct grains *g = &packing->grains;
    for (size_t k = 0; k < c->count; k++) {
        double r = g->radius[c->i[k]], fn = packing->forces->contact.fn[k];
        if ((size_t)c->j[k] < g->count)
            r = r * g->radius[c->j[k]] / (r + g->radius[c->j[k]]);
        struct contact_pair pair = contact_pair_of(law, r);
        check_near(fn, contact_pair_force(law, &pair, c->overlap[k]), 1e-9 * fn + 1e-9);
        check_at_most(fabs(packing->forces->contact.ft[k]), law->mu * fn * (1 + 1e-12));
    }
}

/* Forces on the grains from the walls at the feet of the grains on the wall lines (the box's lower left corner is the
 * origin); compression positive. */
static void boundary_stress(const struct packing *packing, struct record *row)
{
    const struct contacts *c = &packing->contacts;
    const struct grains *g = &packing->grains;
    for (size_t k = 0; k < c->count; k++) {
        if ((size_t)c->j[k] < g->count)
            continue;
        size_t i = (size_t)c->i[k];
        double fn = packing->forces->contact.fn[k], ft = packing->forces->contact.ft[k];
        double f[2] = {fn * c->nx[k] - ft * c->ny[k], fn * c->ny[k] + ft * c->nx[k]};
        double arm = g->radius[i] - c->overlap[k], x[2] = {g->x[i] + arm * c->nx[k], g->y[i] + arm * c->ny[k]};
        for (int a = 0; a < 2; a++)
            for (int b = 0; b < 2; b++)
                row->boundary[a][b] += f[a] * x[b] / (row->width * row->height);
    }
}

static int record(const struct packing *packing, const struct simulation_state *state, void *user)
{
    struct records *records = user;
    assert_in_range(records->count, 0, MOST_STATES - 1);
    struct record *row = &records->row[records->count++];
    row->state = *state;
    for (size_t c = 0; c < packing->contacts.count; c++)
        row->mean_fn += packing->forces->contact.fn[c] / (double)packing->contacts.count;
    row->unbalanced = unbalanced(packing) / row->mean_fn;
    if (records->law)
        check_law(packing, records->law);
    if (!packing->walls.count)
        return 0;
    const struct walls *w = &packing->walls;
    row->width = w->x1[0], row->height = w->y1[1], row->lean = w->x0[3];
    boundary_stress(packing, row);
    for (int side = 0; side < 4; side++)
        row->load[side][0] = w->fx[side], row->load[side][1] = w->fy[side];
    return 0;
}

static const struct grade GRADING[] = {{26, 8e-3}, {14, 12e-3}, {13, 14e-3}, {7, 20e-3}};

static struct simulation sixty_discs(enum loading_test test, const struct loading_steps *steps)
{
    struct simulation simulation = SIMULATION_DEFAULT;
    simulation.grading = GRADING;
    simulation.grade_count = 4;
    simulation.law = (struct contact_law){.kn = 1e7, .kt_over_kn = 1, .mu = 0.5};
    simulation.kappa = 200;
    simulation.preparation_mu = 0.1;
    simulation.test = test;
    simulation.steps = steps;
    simulation.step_count = 1;
    return simulation;
}

static double simulate_all(const struct simulation *simulation, struct records *records)
{
    check_done(simulate(simulation, record, records));
    assert_int_equal(records->count, simulation_states(simulation));
    for (size_t k = 0; k < records->count; k++) {
        check_at_most(records->row[k].unbalanced, 1e-6);
        const struct simulation_state *s = &records->row[k].state;
        for (int a = 0; a < 2; a++) /* Weber's stress is the walls' stress */
            for (int b = 0; b < 2; b++)
                check_near(s->stress[a][b], records->row[k].boundary[a][b], 1e-6 * s->stress[a][a]);
    }
    return records->row[0].state.pressure;
}

/* Stresses that the loads make: on the right wall over its height, on the top over its width. */
static double on_right(const struct record *row)
{
    return -row->load[1][0] / row->height;
}

static double on_top(const struct record *row)
{
    return -row->load[2][1] / row->width;
}

static void isotropic_goes_by_both_stresses(void **state)
{
    (void)state;
    struct records records = {0};
    struct simulation simulation = sixty_discs(TEST_ISOTROPIC, (struct loading_steps[]){{3, 0.5}, {2, -0.5}});
    simulation.step_count = 2;
    double p = simulate_all(&simulation, &records), expected[] = {1, 1.5, 2, 2.5, 2, 1.5};
    for (size_t k = 0; k < 6; k++) {
        check_near(on_right(&records.row[k]), p * expected[k], 1e-9 * p);
        check_near(on_top(&records.row[k]), p * expected[k], 1e-9 * p);
    }
    assert_true(records.row[3].width < records.row[0].width && records.row[3].height < records.row[0].height);
}

static void biaxial_keeps_the_other_stress(void **state)
{
    (void)state;
    for (int horizontal = 0; horizontal < 2; horizontal++) {
        struct records records = {0};
        struct simulation simulation = sixty_discs(horizontal ? TEST_BIAXIAL_HORIZONTAL : TEST_BIAXIAL_VERTICAL,
                                                   (struct loading_steps[]){{4, 1e-3}});
        double p = simulate_all(&simulation, &records);
        for (size_t k = 0; k < 5; k++) {
            const struct record *row = &records.row[k], *first = &records.row[0];
            double now = horizontal ? row->width / first->width : row->height / first->height;
            check_near(1 - now, 1e-3 * (double)k, 1e-12);
            check_near(row->state.strain[horizontal ? 0 : 1], 1e-3 * (double)k, 1e-12);
            check_near(horizontal ? on_top(row) : on_right(row), p, 1e-9 * p);
        }
        const struct record *last = &records.row[4];
        assert_true((horizontal ? on_right(last) : on_top(last)) > 1.1 * p); /* it resists */
    }
}

static void rest_at_constant_stress(void **state)
{
    (void)state;
    struct records strain = {0}, stress = {0};
    struct simulation simulation = sixty_discs(TEST_BIAXIAL_VERTICAL, (struct loading_steps[]){{2, 1e-3}});
    simulate_all(&simulation, &strain);
    simulation.relax_at_stress = 1;
    double p = simulate_all(&simulation, &stress);
    assert_true(fabs(stress.row[2].state.strain[1] - 2e-3) > 1e-9); /* it crept */
    check_near(stress.row[2].state.strain[1], 2e-3, 2e-3);
    check_near(on_right(&stress.row[2]), p, 1e-9 * p);
    assert_true(on_top(&stress.row[2]) > p);
}

static void shear_tilts_the_side_walls(void **state)
{
    (void)state;
    struct records records = {0};
    struct simulation simulation = sixty_discs(TEST_SIMPLE_SHEAR, (struct loading_steps[]){{4, 2e-3}});
    simulation.law.mu_wall = 0.3;
    double p = simulate_all(&simulation, &records);
    for (size_t k = 0; k < 5; k++) {
        const struct record *row = &records.row[k];
        check_near(row->lean / row->height, 2e-3 * (double)k, 1e-12);
        check_near(row->width, records.row[0].width, 1e-15);
        double vertical = on_top(row) - row->load[2][0] / row->width * row->lean / row->height;
        check_near(vertical, p, 1e-6 * p); /* work of the top's loads along the side walls: p per area swept */
    }
    /* the top goes to the right: compression from top left to bottom right */
    double before = records.row[0].state.stress[0][1], after = records.row[4].state.stress[0][1];
    check_at_most(after, before - 0.05 * p);
}

static void oedometer_keeps_the_width(void **state)
{
    (void)state;
    struct records strain = {0}, stress = {0};
    struct simulation simulation = sixty_discs(TEST_OEDOMETER, (struct loading_steps[]){{3, 1e-3}, {2, -1e-3}});
    simulation.step_count = 2;
    double p = simulate_all(&simulation, &strain);
    simulation.steps = (struct loading_steps[]){{2, 0.5}, {2, -0.5}, {2, 0.5}, {2, -0.5}};
    simulation.step_count = 4;
    simulation.by_stress = 1;
    simulate_all(&simulation, &stress);
    static const double strains[] = {0, 1e-3, 2e-3, 3e-3, 2e-3, 1e-3}, loads[] = {1, 1.5, 2, 1.5, 1, 1.5, 2, 1.5, 1};
    for (size_t k = 0; k < 6; k++) {
        check_near(strain.row[k].state.strain[1], strains[k], 1e-12);
        check_near(strain.row[k].width, strain.row[0].width, 0);
    }
    for (size_t k = 0; k < 9; k++) {
        check_near(on_top(&stress.row[k]), p * loads[k], 1e-9 * p);
        check_near(stress.row[k].width, stress.row[0].width, 0);
    }
    /* the second cycle moves less than the first: what was lost stays lost */
    double lost = stress.row[4].state.strain[1], again = stress.row[8].state.strain[1] - lost;
    assert_true(lost > 0 && fabs(again) < lost);
}

static void cycles_swing_the_top(void **state)
{
    (void)state;
    struct records records = {0};
    struct simulation simulation = sixty_discs(TEST_CYCLIC, (struct loading_steps[]){{8, 0.125}});
    simulation.amplitude = 0.3;
    double p = simulate_all(&simulation, &records);
    for (size_t k = 0; k < 9; k++) {
        check_near(on_top(&records.row[k]), p * (1 + 0.3 * sin(2 * PI * 0.125 * (double)k)), 1e-9 * p);
        check_near(on_right(&records.row[k]), p, 1e-9 * p);
    }
    assert_true(records.row[2].height < records.row[6].height);
}

static void every_law_comes_to_rest(void **state)
{
    (void)state;
    static const struct law *const rows[] = {&hertz_mindlin_law, &hertz_pfc_law, &pohrt_popov_law};
    for (size_t k = 0; k < 3; k++) {
        struct records records = {0};
        struct simulation simulation = sixty_discs(TEST_BIAXIAL_VERTICAL, (struct loading_steps[]){{2, 1e-3}});
        simulation.law = (struct contact_law){.row = rows[k],
                                              .kn = NAN,
                                              .kt_over_kn = 1.4 / 1.7,
                                              .mu = 0.5,
                                              .young = 1e9,
                                              .poisson = 0.3,
                                              .fractal = 2.13,
                                              .roughness = 2.6e-5};
        simulation.kappa = NAN;
        simulation.pressure = 6000;
        records.law = &simulation.law;
        double p = simulate_all(&simulation, &records);
        check_near(p, 6000, 0);
        check_near(on_right(&records.row[2]), p, 1e-9 * p);
    }
}

/* Discs 1 and 2 fixed, disc 3 lies on both, 45 degrees: docs/theory.md section 2, P = 1530 N. Sticking needs more
 * friction than there is, so ft = mu fn and fn = P / (2 (sin a + mu cos a)); the overlap of 1e-3 R changes the angle a
 * little.
 */
static void three_discs(void **state)
{
    (void)state;
    double half = 0.01 / sqrt(2.0);
    struct placed_disc discs[] = {
        {-half, 0, 0.005, 0, 0, 1, 0}, {half, 0, 0.005, 0, 0, 1, 0}, {0, half, 0.005, 0, -1530, 0, 0}};
    struct simulation simulation = SIMULATION_DEFAULT;
    simulation.discs = discs;
    simulation.disc_count = 3;
    simulation.law = (struct contact_law){.kn = 5e7, .kt_over_kn = 1, .mu = 0.5};
    simulation.restitution = 0.14; /* critical: the disc settles without swinging */
    struct records records = {0};
    check_done(simulate(&simulation, record, &records));
    check_at_most(records.row[0].unbalanced, 1e-6);
    check_near(records.row[0].mean_fn, 721.25, 0.001 * 721.25);
}

/* Three discs in a column on the floor of a box: each contact carries what lies above it. */
static void a_column_under_gravity(void **state)
{
    (void)state;
    struct placed_disc discs[] = {
        {0.05, 0.01, 0.01, 0, 0, 0, 0}, {0.05, 0.0299, 0.01, 0, 0, 0, 0}, {0.05, 0.0501, 0.01, 0, 0, 0, 0}};
    struct simulation simulation = SIMULATION_DEFAULT;
    simulation.discs = discs;
    simulation.disc_count = 3;
    simulation.box[0] = simulation.box[1] = 0.1;
    simulation.gravity = vec(0, -9.81);
    simulation.law = (struct contact_law){.kn = 1e5, .kt_over_kn = 1, .mu = 0.5};
    struct records records = {0};
    check_done(simulate(&simulation, record, &records));
    double weight = 730 * 0.06 * PI * 1e-4 * 9.81;
    check_at_most(records.row[0].unbalanced, 1e-6);
    check_near(records.row[0].load[0][1], 3 * weight, 1e-5 * weight);
    check_near(records.row[0].mean_fn, 2 * weight, 1e-5 * weight);
    check_near(records.row[0].load[2][1], 0, 0);
}

static void misplaced_discs_are_refused(void **state)
{
    (void)state;
    struct placed_disc discs[] = {{0, 0, 0.01, 0, 0, 1, 0}, {0.0199, 0, 0.01, 0, 0, 1, 0}};
    struct simulation simulation = SIMULATION_DEFAULT;
    struct records records = {0};
    simulation.discs = discs;
    simulation.disc_count = 2;
    simulation.law = (struct contact_law){.kn = 1e7, .kt_over_kn = 1, .mu = 0.5};
    assert_int_equal(simulate(&simulation, record, &records), -1);
    assert_int_equal(error_status(), EXIT_INPUT);
    assert_non_null(strstr(error_message(), "fixed discs 0 and 1 overlap"));
    discs[1].x = 0.03; /* nothing presses them */
    assert_int_equal(simulate(&simulation, record, &records), -1);
    assert_int_equal(error_status(), EXIT_INPUT);
    assert_int_equal(records.count, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(isotropic_goes_by_both_stresses), cmocka_unit_test(biaxial_keeps_the_other_stress),
        cmocka_unit_test(rest_at_constant_stress),         cmocka_unit_test(shear_tilts_the_side_walls),
        cmocka_unit_test(oedometer_keeps_the_width),       cmocka_unit_test(cycles_swing_the_top),
        cmocka_unit_test(every_law_comes_to_rest),         cmocka_unit_test(three_discs),
        cmocka_unit_test(a_column_under_gravity),          cmocka_unit_test(misplaced_discs_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
