/* What a moving camera costs: 3 px, 0.05 degrees, 1e-4 zoom, undone by speckled paper of 400 x 400 px near the corners
 * of a photo of 80 Mpixels; error of the grains' motions beside that with a camera that stands still.
 *
 *     bench_tracker_drift [--photos N] */
#include <stdio.h>
#include <string.h>

#include "pipeline/speak/progress.h"
#include "tests/bench/stamped.h"
#include "tracker/follow/track_grains.h"

enum { COLUMNS = 8, ROWS = 6, COUNT = COLUMNS * ROWS, PAPERS = 4, SIDE = 400 };
static const double radius = 100, noise = 0.01, degree = 3.141592653589793 / 180;
static const double zoom = 1e-4, turn = 0.05 * 3.141592653589793 / 180, shift[2] = {2.4, -1.8}; /* 3 px */
static const double papers[PAPERS][2] = {{420, 400}, {9890, 420}, {9900, 7340}, {430, 7350}};
static const uint64_t seed = 55000000;

static double place(int k, int axis)
{
    int cell = axis ? k / COLUMNS : k % COLUMNS;
    return 1200 + cell * (axis ? 1060 : 1130) + random_uniform(seed + (uint64_t)k, (uint64_t)axis);
}

/* A body at (x, y) after it has moved by `own` and the camera (about the middle of the photo) after it. */
static void draw_body(struct photo *photo, const struct dots *dots, const double at[2], int half, struct motion own,
                      int camera, uint64_t key)
{
    const double mx = FULL_WIDTH / 2.0, my = FULL_HEIGHT / 2.0, z = camera ? 1 + zoom : 1, a = camera ? turn : 0;
    double dx = at[0] + own.u - mx, dy = at[1] + own.v - my;
    double x = mx + (camera ? shift[0] : 0) + z * (cos(a) * dx + sin(a) * dy);
    double y = my + (camera ? shift[1] : 0) + z * (-sin(a) * dx + cos(a) * dy);
    stamp(photo, dots, at[0], at[1], half, x, y, own.angle + a, z, noise, key);
}

static struct motion own_motion(int k, int index)
{
    uint64_t key = seed + (uint64_t)(1000 * index + k);
    return (struct motion){index ? random_uniform(key, 5) - 0.5 : 0, index ? random_uniform(key, 6) - 0.5 : 0,
                           index ? 0.004 * (random_uniform(key, 7) - 0.5) : 0};
}

static struct photo draw(int index, int camera)
{
    struct photo photo = stamped_blank(0.1, 0, seed);
    for (int k = 0; k < COUNT + PAPERS; k++) {
        const double grain[2] = {place(k, 0), place(k, 1)}, *at = k < COUNT ? grain : papers[k - COUNT];
        double reach = k < COUNT ? radius : SIDE * 0.75;
        struct dots dots = dots_make(reach, DOTS_NORMAL, seed + (uint64_t)k);
        draw_body(&photo, &dots, at, (int)reach + 16, k < COUNT ? own_motion(k, index) : (struct motion){0}, camera,
                  seed + (uint64_t)(4000 * (2 * index + camera) + k));
        dots_free(&dots);
    }
    return photo;
}

static struct photo_grains circles(void)
{
    static const char *const names[] = {"x_px", "y_px", "radius_px", "flags", NULL};
    struct photo_grains grains = {0};
    if (table_alloc(&PHOTO_GRAINS, &grains, COUNT, names))
        abort();
    for (int k = 0; k < COUNT; k++) {
        grains.x_px[k] = place(k, 0);
        grains.y_px[k] = place(k, 1);
        grains.radius_px[k] = radius;
    }
    return grains;
}

struct sums {
    double square, stated, normed, angle, angle_stated;
    int n;
};

static int track(const struct photo *reference, const struct photo *photo, const struct photo_grains *grains, int index,
                 const struct rect *drift, size_t count, struct sums *sums)
{
    struct tracker_options options = TRACKER_DEFAULT;
    struct tracks tracks = {0};
    options.drift = drift;
    options.drift_count = count;
    if (track_grains(reference, grains, photo, NULL, &options, &tracks))
        return -1;
    for (int k = 0; k < COUNT; k++) {
        struct motion own = own_motion(k, index);
        const struct photo_grains *g = &tracks.grains;
        double ex = g->x_px[k] - place(k, 0) - own.u, ey = g->y_px[k] - place(k, 1) - own.v;
        sums->square += (ex * ex + ey * ey) / 2;
        sums->stated += (pow(g->s_x[k], 2) + pow(g->s_y[k], 2)) / 2;
        sums->normed += (pow(ex / g->s_x[k], 2) + pow(ey / g->s_y[k], 2)) / 2;
        sums->angle += pow(g->angle[k] - own.angle, 2);
        sums->angle_stated += pow(g->s_angle[k], 2);
        sums->n++;
    }
    tracks_free(&tracks);
    return 0;
}

static void print(const char *what, const struct sums *s, const struct sums *still)
{
    double rms = sqrt(s->square / s->n), stated = sqrt(s->stated / s->n), base = sqrt(still->square / still->n);
    printf(
        "%-28s RMS %.5f px (stated %.5f), %.6f deg (stated %.6f); more than a still camera: %.5f px (predicted %.5f); "
        "error / stated %.2f\n",
        what, rms, stated, sqrt(s->angle / s->n) / degree, sqrt(s->angle_stated / s->n) / degree, rms - base,
        stated - sqrt(still->stated / still->n), sqrt(s->normed / s->n));
}

int main(int argc, char **argv)
{
    int photos = argc > 2 && !strcmp(argv[1], "--photos") ? atoi(argv[2]) : 12;
    struct sums still = {0}, four = {0}, one = {0};
    struct rect drift[PAPERS];
    struct photo_grains grains = circles();
    struct photo reference = draw(0, 0);
    for (int k = 0; k < PAPERS; k++)
        drift[k] = (struct rect){papers[k][0] - SIDE / 2, papers[k][1] - SIDE / 2, papers[k][0] + SIDE / 2,
                                 papers[k][1] + SIDE / 2};
    progress_silence();
    for (int index = 1; index <= photos; index++) {
        struct photo fixed = draw(index, 0), moved = draw(index, 1);
        if (track(&reference, &fixed, &grains, index, NULL, 0, &still) ||
            track(&reference, &moved, &grains, index, drift, PAPERS, &four) ||
            track(&reference, &moved, &grains, index, &drift[index % PAPERS], 1, &one)) {
            fprintf(stderr, "bench_tracker_drift: %s\n", error_message());
            return 1;
        }
        free(fixed.pixels);
        free(moved.pixels);
    }
    printf("%d grains of radius %g px, noise 1 %%, %d photos, camera moved by 3 px, 0.05 degrees, 1e-4 zoom\n", COUNT,
           radius, photos);
    print("still camera, no paper", &still, &still);
    print("four papers", &four, &still);
    print("one paper", &one, &still);
    free(reference.pixels);
    table_free(&PHOTO_GRAINS, &grains);
    return 0;
}
