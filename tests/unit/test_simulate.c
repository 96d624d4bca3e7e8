/* States of simulate, judged from the tables of the packing alone: equilibrium, Coulomb's law, stress, motions. */
#include "tests/check.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "simulation/dem/simulate.h"

enum { MOST_STATES = 8 };
static const double PI = 3.141592653589793;

/* Copies of all states, in order. */
struct series {
    struct packing packing[MOST_STATES];
    struct simulation_state state[MOST_STATES];
    size_t count;
};

static int keep(const struct packing *packing, const struct simulation_state *state, void *user)
{
    struct series *series = user;
    assert_in_range(series->count, 0, MOST_STATES - 1);
    struct packing *copy = &series->packing[series->count];
    series->state[series->count++] = *state;
    copy->force_count = 1;
    copy->forces = calloc(1, sizeof *copy->forces);
    *copy->forces = *packing->forces;
    return table_copy(&GRAINS, &copy->grains, &packing->grains) || table_copy(&WALLS, &copy->walls, &packing->walls) ||
           table_copy(&CONTACTS, &copy->contacts, &packing->contacts) ||
           table_copy(&CONTACT_FORCES, &copy->forces->contact, &packing->forces->contact) ||
           table_copy(&RESIDUALS, &copy->forces->residual, &packing->forces->residual);
}

static void series_free(struct series *series)
{
    for (size_t k = 0; k < series->count; k++)
        packing_free(&series->packing[k]);
    memset(series, 0, sizeof *series);
}

static const struct grade GRADING[] = {{30, 8e-3}, {16, 12e-3}, {14, 14e-3}};
static const struct loading_steps STEPS[] = {{2, 1e-3}, {1, -5e-4}};

static struct simulation sixty_discs(void)
{
    struct simulation simulation = SIMULATION_DEFAULT;
    simulation.grading = GRADING;
    simulation.grade_count = 3;
    simulation.law = (struct contact_law){.row = &linear_law, .kn = 1e7, .kt_over_kn = 0.9, .mu = 0.5};
    simulation.kappa = 200;
    simulation.aspect = 1.3;
    simulation.test = TEST_BIAXIAL_VERTICAL;
    simulation.steps = STEPS;
    simulation.step_count = 2;
    return simulation;
}

static double mean_fn(const struct packing *packing)
{
    double sum = 0;
    for (size_t c = 0; c < packing->contacts.count; c++)
        sum += packing->forces->contact.fn[c] / (double)packing->contacts.count;
    return sum;
}

/* Forces gathered from n, contact point, fn, ft: nothing but the columns of the file. */
static void check_equilibrium(const struct packing *packing)
{
    const struct contacts *contacts = &packing->contacts;
    const struct grains *grains = &packing->grains;
    size_t bodies = grains->count + packing->walls.count;
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
    for (size_t w = 0; w < packing->walls.count; w++) {
        check_at_most(fabs(sum[grains->count + w][0] + packing->walls.fx[w]), tolerance);
        check_at_most(fabs(sum[grains->count + w][1] + packing->walls.fy[w]), tolerance);
    }
    free(sum);
}

/* Every touching pair, and only those, has a row whose normal, point and overlap follow from the centres; the forces
 * obey the law. */
static void check_contacts(const struct packing *packing, const struct contact_law *law)
{
    const struct contacts *contacts = &packing->contacts;
    const struct grains *g = &packing->grains;
    size_t touching = 0;
    for (size_t i = 0; i < g->count; i++) {
        for (size_t j = i + 1; j < g->count; j++)
            touching += hypot(g->x[j] - g->x[i], g->y[j] - g->y[i]) < g->radius[i] + g->radius[j];
        touching +=
            (size_t)((g->x[i] < g->radius[i]) + (g->y[i] < g->radius[i]) +
                     (packing->walls.x1[0] - g->x[i] < g->radius[i]) + (packing->walls.y1[1] - g->y[i] < g->radius[i]));
    }
    assert_int_equal(contacts->count, touching);
    for (size_t c = 0; c < contacts->count; c++) {
        size_t i = (size_t)contacts->i[c], j = (size_t)contacts->j[c];
        int wall = j >= g->count;
        double fn = packing->forces->contact.fn[c], ft = packing->forces->contact.ft[c], overlap = contacts->overlap[c];
        if (!wall) {
            double dx = g->x[j] - g->x[i], dy = g->y[j] - g->y[i], d = hypot(dx, dy);
            check_near(overlap, g->radius[i] + g->radius[j] - d, 1e-15);
            check_near(contacts->nx[c], dx / d, 1e-13);
            check_near(contacts->ny[c], dy / d, 1e-13);
        }
        double arm = g->radius[i] - 0.5 * overlap;
        check_near(contacts->x[c], g->x[i] + arm * contacts->nx[c], 1e-15);
        check_near(contacts->y[c], g->y[i] + arm * contacts->ny[c], 1e-15);
        check_near(fn, law->kn * overlap, 1e-12 * fn);
        check_at_most(fabs(ft), (wall ? law->mu_wall : law->mu) * fn * (1 + 1e-12));
        assert_int_equal(!!(contacts->flags[c] & CONTACT_WALL), wall);
    }
}

/* Branch vectors by hand: between centres, to a wall from the centre to its foot. Frictionless walls. */
static void check_stress(const struct packing *packing, double length, double pressure)
{
    const struct contacts *contacts = &packing->contacts;
    const struct grains *g = &packing->grains;
    double width = packing->walls.x1[0], height = packing->walls.y1[1], sigma[2] = {0};
    for (size_t c = 0; c < contacts->count; c++) {
        size_t i = (size_t)contacts->i[c], j = (size_t)contacts->j[c];
        double fn = packing->forces->contact.fn[c], ft = packing->forces->contact.ft[c];
        double nx = contacts->nx[c], ny = contacts->ny[c];
        double arm = g->radius[i] - contacts->overlap[c] + (j < g->count ? g->radius[j] : 0);
        sigma[0] += (fn * nx - ft * ny) * nx * arm, sigma[1] += (fn * ny + ft * nx) * ny * arm;
    }
    double xx = -packing->walls.fx[1] / (height * length), yy = -packing->walls.fy[2] / (width * length);
    check_near(sigma[0] / (width * height * length), xx, 1e-6 * xx);
    check_near(sigma[1] / (width * height * length), yy, 1e-6 * yy);
    check_near(packing->forces->stress[0][0], xx, 1e-6 * xx);
    check_near(packing->forces->stress[1][1], yy, 1e-6 * yy);
    check_near(xx, pressure / length, 1e-6 * pressure / length);
}

static void states_are_static_and_exact(void **state)
{
    (void)state;
    struct series series = {0};
    struct simulation simulation = sixty_discs();
    check_done(simulate(&simulation, keep, &series));
    assert_int_equal(series.count, 4);
    double pressure = simulation.law.kn / simulation.kappa;
    for (size_t k = 0; k < series.count; k++) {
        const struct packing *packing = &series.packing[k];
        assert_int_equal(packing->grains.count, 60);
        assert_true(series.state[k].relaxed);
        check_equilibrium(packing);
        check_contacts(packing, &simulation.law);
        check_stress(packing, simulation.length, pressure);
        check_at_most(packing->forces->imbalance, 1e-6);
        double height = series.packing[0].walls.y1[1];
        check_near(1 - packing->walls.y1[1] / height, series.state[k].strain[1], 1e-12);
    }
    check_near(-series.packing[0].walls.fy[2] / series.packing[0].walls.x1[0], pressure, 1e-9 * pressure);
    check_near(series.state[1].strain[1], 1e-3, 1e-12);
    check_near(series.state[2].strain[1], 2e-3, 1e-12);
    check_near(series.state[3].strain[1], 1.5e-3, 1e-12);
    series_free(&series);
}

static void friction_at_walls_too(void **state)
{
    (void)state;
    struct series series = {0};
    struct simulation simulation = sixty_discs();
    simulation.law.mu_wall = 0.3;
    check_done(simulate(&simulation, keep, &series));
    for (size_t k = 0; k < series.count; k++) {
        check_equilibrium(&series.packing[k]);
        check_contacts(&series.packing[k], &simulation.law);
    }
    assert_true(fabs(series.packing[1].walls.fx[2]) > 1e-3 * mean_fn(&series.packing[1]));
    series_free(&series);
}

/* Row of contact (i, j), or -1. */
static long row_of(const struct contacts *contacts, int64_t i, int64_t j)
{
    for (size_t c = 0; c < contacts->count; c++)
        if (contacts->i[c] == i && contacts->j[c] == j)
            return (long)c;
    return -1;
}

/* dun is the loss of overlap; where a contact sticks, -kt dut is the gain of ft; un since the reference likewise; a
 * pair that was not in touch has NaN and says so. */
static void motions_explain_forces(void **state)
{
    (void)state;
    struct series series = {0};
    struct simulation simulation = sixty_discs();
    check_done(simulate(&simulation, keep, &series));
    size_t explained = 0, kept = 0;
    for (size_t k = 1; k < series.count; k++) {
        const struct contacts *now = &series.packing[k].contacts, *then = &series.packing[k - 1].contacts;
        const struct contact_forces *f = &series.packing[k].forces->contact,
                                    *f0 = &series.packing[k - 1].forces->contact;
        double fn = mean_fn(&series.packing[k]), kt = simulation.law.kn * simulation.law.kt_over_kn;
        for (size_t c = 0; c < now->count; c++) {
            long old = row_of(then, now->i[c], now->j[c]),
                 first = row_of(&series.packing[0].contacts, now->i[c], now->j[c]);
            assert_int_equal(isnan(now->dun[c]), old < 0);
            assert_int_equal(!!(now->flags[c] & CONTACT_NEW), old < 0);
            assert_int_equal(isnan(now->un[c]), first < 0);
            if (first >= 0)
                check_near(-now->un[c] - (now->overlap[c] - series.packing[0].contacts.overlap[first]), 0,
                           1e-3 * fn / 1e7);
            if (old < 0)
                continue;
            check_near(-now->dun[c] - (now->overlap[c] - then->overlap[old]), 0, 1e-3 * fn / 1e7);
            if (f->status[c] == STATUS_STICK && f0->status[old] == STATUS_STICK) {
                kept++;
                explained += fabs(f->ft[c] - f0->ft[old] + kt * now->dut[c]) < 0.02 * fn;
            }
        }
    }
    assert_true(kept > 100);
    check_at_most(0.9, (double)explained / (double)kept); /* the others slid, or opened, on their way */
    series_free(&series);
}

static void rattlers_carry_nothing(void **state)
{
    (void)state;
    struct series series = {0};
    struct simulation simulation = sixty_discs();
    simulation.kappa = 3000;
    simulation.step_count = 0;
    simulation.inertial = 1e-2;
    check_done(simulate(&simulation, keep, &series));
    const struct packing *packing = &series.packing[0];
    double tolerance = 1e-5 * mean_fn(packing);
    size_t rattlers = 0;
    for (size_t k = 0; k < packing->grains.count; k++) {
        int64_t carrying = 0, rattler = !!(packing->grains.flags[k] & GRAIN_RATTLER);
        for (size_t c = 0; c < packing->contacts.count; c++)
            carrying += (packing->contacts.i[c] == (int64_t)k || packing->contacts.j[c] == (int64_t)k) &&
                        packing->forces->contact.fn[c] > tolerance;
        if (rattler)
            assert_int_equal(carrying, 0);
        else
            assert_in_range(carrying, 2, 10);
        rattlers += (size_t)rattler;
    }
    assert_in_range(rattlers, 1, 20);
    series_free(&series);
}

static void check_same(const struct packing *a, const struct packing *b)
{
    size_t grains = a->grains.count * sizeof(double), contacts = a->contacts.count * sizeof(double);
    assert_int_equal(a->grains.count, b->grains.count);
    assert_int_equal(a->contacts.count, b->contacts.count);
    assert_memory_equal(a->grains.x, b->grains.x, grains);
    assert_memory_equal(a->grains.angle, b->grains.angle, grains);
    assert_memory_equal(a->forces->contact.fn, b->forces->contact.fn, contacts);
    assert_memory_equal(a->forces->contact.ft, b->forces->contact.ft, contacts);
}

static void threads_and_reruns_change_nothing(void **state)
{
    (void)state;
    struct simulation simulation = sixty_discs();
    struct series series[3] = {0};
    int threads[3] = {1, 2, 2}, most = omp_get_max_threads();
    for (int k = 0; k < 3; k++) {
        omp_set_num_threads(threads[k]);
        check_done(simulate(&simulation, keep, &series[k]));
    }
    omp_set_num_threads(most);
    for (size_t k = 0; k < series[0].count; k++) {
        check_same(&series[0].packing[k], &series[1].packing[k]);
        check_same(&series[1].packing[k], &series[2].packing[k]);
    }
    simulation.seed = 5;
    series_free(&series[2]);
    check_done(simulate(&simulation, keep, &series[2]));
    assert_true(series[2].packing[0].grains.x[0] != series[0].packing[0].grains.x[0]);
    for (int k = 0; k < 3; k++)
        series_free(&series[k]);
}

/* The discs are those of the grading. */
static void grading_is_kept(void **state)
{
    (void)state;
    struct series series = {0};
    struct simulation simulation = sixty_discs();
    simulation.step_count = 0;
    check_done(simulate(&simulation, keep, &series));
    const struct grains *grains = &series.packing[0].grains;
    for (size_t g = 0; g < 3; g++) {
        long found = 0;
        double r = 0.5 * GRADING[g].diameter, mass = 730 * 0.06 * PI * r * r;
        for (size_t k = 0; k < grains->count; k++)
            if (grains->radius[k] == r) {
                found++;
                check_near(grains->mass[k], mass, 1e-15);
                check_near(grains->inertia[k], 0.5 * mass * r * r, 1e-18);
            }
        assert_int_equal(found, GRADING[g].count);
    }
    series_free(&series);
}

static void a_short_run_says_that_it_is_not_static(void **state)
{
    (void)state;
    struct series series = {0};
    struct simulation simulation = sixty_discs();
    simulation.max_steps = 15000;
    simulation.tolerance = 0; /* out of reach */
    assert_int_equal(simulate(&simulation, keep, &series), 1);
    assert_non_null(strstr(error_message(), "4 of 4 states did not come to rest in 15000 steps"));
    assert_int_equal(error_status(), EXIT_FLAGGED);
    error_clear();
    assert_int_equal(series.count, 4);
    for (size_t k = 0; k < series.count; k++) {
        assert_int_equal(series.state[k].relaxed, 0);
        assert_int_equal(series.packing[k].forces->converged, 0);
    }
    series_free(&series);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(states_are_static_and_exact),
        cmocka_unit_test(friction_at_walls_too),
        cmocka_unit_test(motions_explain_forces),
        cmocka_unit_test(rattlers_carry_nothing),
        cmocka_unit_test(threads_and_reruns_change_nothing),
        cmocka_unit_test(grading_is_kept),
        cmocka_unit_test(a_short_run_says_that_it_is_not_static),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
