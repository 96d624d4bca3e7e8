/* The parts of series against formulas, on a crystal of nine discs: what each shared unknown does to an overlap, and
 * when a grain's equations are no longer believed. */
#include <stdlib.h>

#include "tests/unit/discs.h"

#include "forces/series/series_state.h"
#include "forces/series/series_status.h"
#include "pipeline/numbers/random.h"

#define KN 1e7
#define ERROR 1e-6 /* m: standard error of every place, radius, wall and rim */
#define OFFSET 3e-6
#define S_OFFSET 2e-6

static struct packing packing;
static struct series series;
static struct force_options options = FORCE_OPTIONS_DEFAULT;
static struct series_options series_options = SERIES_OPTIONS_DEFAULT;

static double some_angle(size_t k)
{
    return 2 * random_uniform(7, k) - 1;
}

static void measure_errors(struct packing *measured)
{
    static const char *const names[] = {"s_x_ref", "s_y_ref", "s_radius", "s_x", "s_y", "s_shape", "angle"};
    struct grains *g = &measured->grains;
    for (size_t k = 0; k < sizeof names / sizeof *names; k++)
        check_done(table_add(&GRAINS, g, names[k]));
    check_done(table_add(&WALLS, &measured->walls, "s_offset"));
    for (size_t k = 0; k < g->count; k++) {
        g->s_x_ref[k] = g->s_y_ref[k] = g->s_radius[k] = g->s_x[k] = g->s_y[k] = g->s_shape[k] = ERROR;
        g->angle[k] = some_angle(k);
    }
    for (size_t w = 0; w < measured->walls.count; w++)
        measured->walls.s_offset[w] = ERROR;
}

/* One state with every kind of unknown but the stiffness, forces in N. */
static int build(void **state)
{
    (void)state;
    options.law.kn = KN, options.law.mu = 0.5;
    discs_hexagonal(&packing, 3, 3);
    measure_errors(&packing);
    long grains = (long)packing.grains.count, walls = (long)packing.walls.count, shape = 3 * grains + walls + 1;
    series = (struct series){.count = 1, .options = &options, .series_options = &series_options};
    series.force = 1, series.stiffness = KN;
    series.shared = (struct series_shared){.wall = 3 * grains,
                                           .offset = 3 * grains + walls,
                                           .stiffness = -1,
                                           .shape = shape,
                                           .segment = shape + 2 * SERIES_HARMONICS * grains,
                                           .count = (size_t)(shape + 2 * SERIES_HARMONICS * grains)};
    series.state = calloc(1, sizeof *series.state);
    series.state->packing = &packing;
    series.state->flags = calloc(packing.contacts.count, sizeof *series.state->flags);
    check_done(series_shared_resize(&series));
    check_done(series_state_build(&series, 0));
    check_done(series_state_measure(&series, 0, OFFSET, S_OFFSET));
    return series.state->network.count > 12 ? 0 : -1;
}

static int forget(void **state)
{
    (void)state;
    series_state_free(series.state);
    free(series.state), free(series.store);
    packing_free(&packing);
    return 0;
}

/* ---- overlaps, from the errors q alone ---- */

static double rim(const double *q, size_t k, double x, double y)
{
    double turned = atan2(y, x) - some_angle(k), sum = ERROR * q[3 * k + 2] + S_OFFSET * q[series.shared.offset];
    for (int h = 0; h < SERIES_HARMONICS; h++) { /* each harmonic has its part of the rms */
        const double *of_harmonic = q + series.shared.shape + 2 * (long)(k * SERIES_HARMONICS + (size_t)h);
        double size = ERROR / sqrt(SERIES_HARMONICS);
        sum += size * (of_harmonic[0] * cos((h + 2) * turned) + of_harmonic[1] * sin((h + 2) * turned));
    }
    return packing.grains.radius[k] + sum;
}

static double overlap_with(const double *q, size_t row)
{
    const struct grains *g = &packing.grains;
    size_t i = (size_t)packing.contacts.i[row], w;
    double nx = packing.contacts.nx[row], ny = packing.contacts.ny[row];
    double x = g->x[i] + ERROR * q[3 * i], y = g->y[i] + ERROR * q[3 * i + 1];
    if (packing_is_wall(&packing, row, &w)) { /* an offset moves the wall inwards */
        double distance = (packing.walls.x0[w] - x) * nx + (packing.walls.y0[w] - y) * ny;
        return rim(q, i, nx, ny) - distance + ERROR * q[series.shared.wall + (long)w];
    }
    size_t j = (size_t)packing.contacts.j[row];
    double dx = g->x[j] + ERROR * q[3 * j] - x, dy = g->y[j] + ERROR * q[3 * j + 1] - y;
    return rim(q, i, nx, ny) + rim(q, j, -nx, -ny) - hypot(dx, dy);
}

/* One standard error of each unknown in turn: the line of the contact changes by kn times the overlap's change. */
static void each_unknown_does_what_it_says(void **state)
{
    (void)state;
    const struct series_state *here = series.state;
    double *q = calloc(series.shared.count, sizeof *q), out[2];
    size_t felt = 0;
    for (size_t c = 0; c < here->network.count; c++)
        for (size_t k = 0; k < series.shared.count; k++) {
            size_t row = here->network.contact[c].row;
            q[k] = 1;
            series_error_at(&series, here, c, q, out);
            double change = overlap_with(q, row);
            q[k] = -1;
            change = 0.5 * (change - overlap_with(q, row));
            q[k] = 0;
            check_near(out[NORMAL], KN * change, 1e-6 * KN * ERROR);
            felt += fabs(change) > 1e-3 * ERROR;
        }
    assert_true(felt > 12 * here->network.count);
    free(q);
}

/* Offsets count once per radius: twice between rods, once at a wall; and so do the errors of this photo: two rods, or
 * a rod and the wall. The law itself is not known better than to 1 % of the unit. */
static void lines_say_what_was_measured(void **state)
{
    (void)state;
    const struct series_state *here = series.state;
    for (size_t c = 0; c < here->network.count; c++) {
        size_t row = here->network.contact[c].row, w;
        double radii = packing_is_wall(&packing, row, &w) ? 1 : 2;
        check_near(here->measured[c][NORMAL], KN * (packing.contacts.overlap[row] - radii * OFFSET), 1e-9);
        check_near(here->variance[c][NORMAL], 2 * pow(KN * ERROR, 2) + 1e-4, 1e-6);
        assert_true(isnan(here->measured[c][TANGENTIAL]));
    }
}

/* ---- what is not believed ---- */

/* A residual of six standard errors is that of a missing contact: the variance grows to 1 + 36 times what was asked,
 * while the residual soft y stays; one of four is an error like others. */
static void only_large_residuals_are_let_go(void **state)
{
    (void)state;
    struct series_state *here = series.state;
    double error = sqrt(here->softness);
    size_t large = (size_t)here->network.grain_dof[4], small = (size_t)here->network.grain_dof[5];
    here->y[large + 1] = -6 * error / here->soft[large + 1];
    here->y[small] = 4 * error / here->soft[small];
    assert_int_equal(series_let_go(&series), 1);
    for (size_t d = 0; d < here->network.dofs; d++)
        check_near(here->soft[d], (d >= large && d < large + 3 ? 37 : 1) * here->softness, 1e-9 * here->softness);
    check_near(here->soft[large + 1] * here->y[large + 1], -6 * error, 1e-9 * error);
    check_near(here->soft[small] * here->y[small], 4 * error, 1e-9 * error);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_unknown_does_what_it_says),
        cmocka_unit_test(lines_say_what_was_measured),
        cmocka_unit_test(only_large_residuals_are_let_go),
    };
    return cmocka_run_group_tests(tests, build, forget);
}
