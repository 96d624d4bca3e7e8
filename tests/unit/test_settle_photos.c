/* A cyclic test from drawn photos: a packing is simulated, photographed four times per cycle and tracked; residual and
 * reversible displacements from the tracks files against those of the simulation. */
#include "tests/check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "calibration/settlement/settle_series.h"
#include "pipeline/state/state.h"
#include "simulation/dem/loading.h"
#include "simulation/dem/placement.h"
#include "simulation/render/render.h"
#include "tracker/follow/track_grains.h"

enum { GRAINS_A = 8, GRAINS_B = 6, COUNT = GRAINS_A + GRAINS_B, CYCLES = 3, PER = 4, PHOTOS = CYCLES * PER + 1 };
static const double SCALE = 1.6e-4; /* m/px: radii of 25 and 37 px */
static const int MARGIN = 20;
static const struct grade GRADING[] = {{GRAINS_A, 8e-3}, {GRAINS_B, 12e-3}};
static const struct loading_steps NONE[] = {{1, 1}};

static struct simulation small(void)
{
    struct simulation simulation = SIMULATION_DEFAULT;
    simulation.grading = GRADING;
    simulation.grade_count = 2;
    simulation.law = (struct contact_law){.row = &linear_law, .kn = 1e7, .kt_over_kn = 0.8, .mu = 0.5};
    simulation.kappa = 100;
    simulation.test = TEST_CYCLIC;
    simulation.amplitude = 0.5;
    simulation.lateral_fixed = 1;
    simulation.steps = NONE;
    simulation.step_count = 1;
    simulation.tolerance = 1e-5;
    simulation.time_step = 0.25;
    return simulation;
}

/* What the camera sees; the packing's height in px is that of state 0. */
static void place(const struct dem *dem, double bottom, struct photo_grains *seen)
{
    static const char *const columns[] = {"x_px", "y_px",     "radius_px", "angle", "s_x",
                                          "s_y",  "s_radius", "flags",     NULL};
    check_done(table_alloc(&PHOTO_GRAINS, seen, dem->count, columns));
    for (size_t k = 0; k < dem->count; k++) {
        seen->x_px[k] = MARGIN + dem->grains[k].x / SCALE;
        seen->y_px[k] = bottom - dem->grains[k].y / SCALE;
        seen->radius_px[k] = dem->grains[k].radius / SCALE;
        seen->angle[k] = -dem->grains[k].angle;
        seen->s_x[k] = seen->s_y[k] = seen->s_radius[k] = 0;
        seen->flags[k] = 0;
    }
}

static void draw(const struct photo_grains *seen, int width, int height, int index, struct photo *photo)
{
    struct optics optics = OPTICS_DEFAULT;
    struct picture picture = {.width = width, .height = height, .index = index, .grains = seen};
    optics.read_noise = 0.01;
    check_done(render_picture(&picture, &optics, photo));
}

static void write_tracks(const char *path, int index, const struct photo_grains *grains)
{
    struct provenance provenance = PROVENANCE_DEFAULT;
    provenance.stage = "tracker";
    provenance.parameters = "{}";
    provenance.index = index;
    provenance.coordinates = "corrected";
    struct state_writer *writer = state_create(path, &provenance);
    assert_non_null(writer);
    check_done(state_write(writer, "grains", &PHOTO_GRAINS, grains));
    check_done(state_commit(writer));
}

/* Simulate, draw and track; `truth` gets the positions. */
static void photograph_and_track(char *const paths[PHOTOS], double truth[PHOTOS][2 * COUNT])
{
    struct simulation simulation = small();
    struct loading loading = {.simulation = &simulation};
    struct tracker_options options = TRACKER_DEFAULT;
    struct tracker *tracker = NULL;
    struct photo_grains before = {0}, reference = {0};
    struct photo first = {0};
    check_done(placement(&simulation, &loading.dem));
    assert_true(loading_begin(&loading) >= 0);
    int width = 2 * MARGIN + (int)(loading.dem.box.size[BOX_WIDTH] / SCALE);
    int height = 2 * MARGIN + (int)(loading.dem.box.size[BOX_HEIGHT] / SCALE) + 10;
    for (int s = 0; s < PHOTOS; s++) {
        struct photo_grains seen = {0};
        struct photo photo = {0};
        struct tracks tracks = {0};
        if (s)
            assert_true(loading_step(&loading, 1.0 / PER) >= 0);
        for (size_t k = 0; k < COUNT; k++)
            truth[s][2 * k] = loading.dem.grains[k].x, truth[s][2 * k + 1] = loading.dem.grains[k].y;
        place(&loading.dem, height - MARGIN, &seen);
        draw(&seen, width, height, s, &photo);
        if (!s) {
            place(&loading.dem, height - MARGIN, &reference);
            draw(&reference, width, height, 0, &first);
            tracker = tracker_open(&first, &reference, &options);
            assert_non_null(tracker);
        }
        check_done(tracker_follow(tracker, &photo, s ? &before : NULL, &tracks));
        write_tracks(paths[s], s, &tracks.grains);
        table_free(&PHOTO_GRAINS, &before);
        before = tracks.grains;
        table_free(&PATCHES, &tracks.patches);
        table_free(&PHOTO_GRAINS, &seen);
        photo_free(&photo);
    }
    tracker_close(tracker);
    table_free(&PHOTO_GRAINS, &before);
    table_free(&PHOTO_GRAINS, &reference);
    photo_free(&first);
    dem_free(&loading.dem);
}

/* Largest way off the line between the ends of a cycle, mean over the cycles. */
static double swing(double truth[PHOTOS][2 * COUNT], int k)
{
    double sum = 0;
    for (int c = 0; c < CYCLES; c++) {
        const double *a = &truth[c * PER][2 * k], *b = &truth[(c + 1) * PER][2 * k];
        double most = 0;
        for (int p = 1; p < PER; p++) {
            const double *now = &truth[c * PER + p][2 * k];
            double t = (double)p / PER;
            most = fmax(most, hypot(now[0] - a[0] - t * (b[0] - a[0]), now[1] - a[1] - t * (b[1] - a[1])));
        }
        sum += most / CYCLES;
    }
    return sum;
}

/* Was the grain lost in a photo? Its swing is then that of the others. */
static int missed(const struct settle_series *series, int k)
{
    int lost = 0;
    for (int s = 0; s < PHOTOS; s++)
        lost += !isfinite(series->at[s * 2 * COUNT + 2 * k]);
    return lost;
}

static void a_photographed_test_gives_the_simulated_displacements(void **state)
{
    (void)state;
    static char text[PHOTOS][512];
    static double truth[PHOTOS][2 * COUNT];
    char *paths[PHOTOS];
    for (int s = 0; s < PHOTOS; s++) {
        snprintf(text[s], sizeof text[s], "%s/tests/settle_%04d.tracks.hdf", FILM_BINARY_DIR, s);
        paths[s] = text[s];
    }
    photograph_and_track(paths, truth);
    struct settle_series series;
    struct settle_estimate estimate;
    struct settle_wanted wanted = {
        .trend = TREND_LOG, .per_cycle = PER, .first = 1, .ahead = 1, .error = NAN, .p = 0.05};
    check_done(settle_series_read(paths, PHOTOS, SCALE, &series));
    check_done(settle_estimate(&series, &wanted, &estimate));
    assert_int_equal(estimate.grains, COUNT);
    assert_int_equal(estimate.cycles, CYCLES);
    assert_in_range(estimate.unused, 0, 2); /* a loose grain may go too far between two photos: said, not used */
    int seen = 0;
    double largest = 0, worst[2] = {0, 0}, most_swing = 0;
    for (int k = 0; k < COUNT; k++) {
        const struct grain_settlement *grain = &estimate.grain[k];
        if (!grain->used)
            continue;
        for (int d = 0; d < 2; d++) {
            double residual = truth[PHOTOS - 1][2 * k + d] - truth[0][2 * k + d];
            largest = fmax(largest, fabs(residual));
            worst[0] = fmax(worst[0], fabs(grain->residual[d] - residual));
        }
        if (missed(&series, k))
            continue;
        seen++;
        most_swing = fmax(most_swing, swing(truth, k));
        worst[1] = fmax(worst[1], fabs(grain->reversible - swing(truth, k)));
    }
    print_message("%zu of %d grains used, %d seen in every photo; residual up to %.2f px, error %.4f px; reversible up "
                  "to %.2f px, error %.4f px\n",
                  estimate.grains - estimate.unused, COUNT, seen, largest / SCALE, worst[0] / SCALE, most_swing / SCALE,
                  worst[1] / SCALE);
    assert_in_range(seen, COUNT - 2, COUNT);
    assert_true(largest > 0.5 * SCALE && most_swing > 0.2 * SCALE); /* there is something to see */
    check_at_most(worst[0], 0.03 * SCALE);
    check_at_most(worst[1], 0.03 * SCALE);
    settle_estimate_free(&estimate);
    settle_series_free(&series);
    for (int s = 0; s < PHOTOS; s++)
        unlink(paths[s]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_photographed_test_gives_the_simulated_displacements)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
