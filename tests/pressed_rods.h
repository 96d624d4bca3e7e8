/* Photos of two rods pressed together along a known path: for test_stiffness and bench_stiffness. Loading to 1000 N in
 * two slopes, unloading, reloading in two slopes: 40 photos; the press carries both rods along and turns them a little.
 */
#ifndef TESTS_PRESSED_RODS_H
#define TESTS_PRESSED_RODS_H

#include <math.h>
#include <stdlib.h>

#include "calibration/rods/press_series.h"
#include "pipeline/numbers/random.h"
#include "simulation/render/render.h"
#include "tracker/follow/track_grains.h"

enum { ROD_PHOTOS = 40 };

struct pressed_rods {
    double scale;     /* m/px */
    double radius_px; /* of both */
    double noise;     /* read noise over full scale */
    uint64_t seed;
};

struct pressed_law {
    double k_low, k_high, at;               /* N/m, N/m, N: first loading */
    double k_back;                          /* unloading */
    double again_low, again_high, again_at; /* reloading */
};
static const struct pressed_law PRESSED_LAW = {5e6, 1.04e7, 250, 1.6e7, 9e6, 1.14e7, 180};
enum { ROD_UP = 18, ROD_DOWN = 27 }; /* photos: loading 0..17, unloading 17..26, reloading 26..39 */

static inline double pressed_slopes(double force, double low, double high, double at)
{
    return fmin(force, at) / low + fmax(force - at, 0) / high;
}

/* Force in photo k and the deflection that the law gives it. */
static inline double pressed_force(int k)
{
    if (k < ROD_UP)
        return 1000.0 * k / (ROD_UP - 1);
    if (k < ROD_DOWN)
        return 1000.0 * (ROD_DOWN - 1 - k) / (ROD_DOWN - ROD_UP);
    return 1000.0 * (k - ROD_DOWN + 1) / (ROD_PHOTOS - ROD_DOWN);
}

static inline double pressed_deflection(int k)
{
    const struct pressed_law *law = &PRESSED_LAW;
    double most = pressed_slopes(1000, law->k_low, law->k_high, law->at), force = pressed_force(k);
    if (k < ROD_UP)
        return pressed_slopes(force, law->k_low, law->k_high, law->at);
    if (k < ROD_DOWN)
        return most - (1000 - force) / law->k_back;
    return most - 1000 / law->k_back + pressed_slopes(force, law->again_low, law->again_high, law->again_at);
}

static inline int pressed_place(const struct pressed_rods *rods, int k, struct photo_grains *grains)
{
    static const char *const columns[] = {"x_px", "y_px",     "radius_px", "angle", "s_x",
                                          "s_y",  "s_radius", "flags",     NULL};
    double r = rods->radius_px, near = pressed_deflection(k) / rods->scale;
    double shift_x = k ? 1.5 * (random_uniform(rods->seed, 5u * (unsigned)k) - 0.5) : 0, lean = k ? 2e-4 * sin(k) : 0;
    double shift_y = 0.004 * pressed_force(k);
    if (table_alloc(&PHOTO_GRAINS, grains, 2, columns))
        return -1;
    double middle_x = r + 20.3, middle_y = 2 * r + 20.4, half = r - 0.5 * near;
    for (int e = 0; e < 2; e++) {
        double side = e ? 1 : -1;
        grains->x_px[e] = middle_x + shift_x - side * half * sin(lean);
        grains->y_px[e] = middle_y + shift_y + side * half * cos(lean);
        grains->radius_px[e] = r;
        grains->angle[e] = k ? 1e-3 * sin(1.7 * k + e) : 0;
        grains->s_x[e] = grains->s_y[e] = grains->s_radius[e] = 0;
    }
    return 0;
}

static inline int pressed_photo(const struct pressed_rods *rods, int k, const struct photo_grains *grains,
                                struct photo *photo)
{
    struct optics optics = OPTICS_DEFAULT;
    optics.seed = rods->seed;
    optics.read_noise = rods->noise;
    optics.shot_noise = 0;
    struct picture picture = {.width = (int)(2 * rods->radius_px + 41),
                              .height = (int)(4 * rods->radius_px + 46),
                              .index = k,
                              .grains = grains};
    return render_picture(&picture, &optics, photo);
}

/* Draw the photos and follow the rods: tracks of all photos, index and time (2 s apart) as a series has them. */
static inline int pressed_follow(const struct pressed_rods *rods, struct press_photo tracked[ROD_PHOTOS])
{
    struct tracker_options options = TRACKER_DEFAULT;
    struct photo_grains first = {0};
    struct photo reference = {0};
    struct tracker *tracker = NULL;
    int status = pressed_place(rods, 0, &first) || pressed_photo(rods, 0, &first, &reference) ? -1 : 0;
    if (!status && !(tracker = tracker_open(&reference, &first, &options)))
        status = -1;
    for (int k = 0; k < ROD_PHOTOS && !status; k++) {
        struct photo_grains grains = {0};
        struct photo photo = {0};
        struct tracks tracks = {0};
        status = pressed_place(rods, k, &grains) || pressed_photo(rods, k, &grains, &photo) ||
                         tracker_follow(tracker, &photo, k ? &tracked[k - 1].grains : NULL, &tracks)
                     ? -1
                     : 0;
        tracked[k] = (struct press_photo){.index = k, .time = 2.0 * k, .grains = tracks.grains};
        table_free(&PATCHES, &tracks.patches);
        table_free(&PHOTO_GRAINS, &grains);
        photo_free(&photo);
    }
    tracker_close(tracker);
    photo_free(&reference);
    table_free(&PHOTO_GRAINS, &first);
    return status;
}

#endif
