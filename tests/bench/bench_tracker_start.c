/* Whole packings through tracker_follow(): are far, turned and noisy grains found, is any wrong one not flagged, and
 * what does a photo cost?
 *
 *     bench_tracker_start [--photos N] [--only start|noise|speed]
 *
 * Wrong: more than 0.5 px or 0.5 degrees from the truth. Not flagged: no flag of distrust, nor `vague`, which says that
 * such errors are within four standard errors. */
#include <omp.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "pipeline/speak/error.h"
#include "pipeline/speak/progress.h"
#include "tests/dots.h"
#include "tracker/subset/rigid_motion.h"
#include "tracker/follow/track_grains.h"

static const double degree = 3.141592653589793 / 180;
enum { COLUMNS = 6, ROWS = 5, COUNT = COLUMNS * ROWS };
static const uint64_t seed = 88000000;

/* Speckled discs on a grid, all of one radius, each with a pattern of its own. */
struct scene_drawn {
    double radius, pitch, margin;
    int width, height;
    struct dots dots[COUNT];
    double x[COUNT], y[COUNT];
    struct motion motion[COUNT];
};

static void scene_make(struct scene_drawn *scene, double radius, double margin, const double *sigma, uint64_t key)
{
    *scene = (struct scene_drawn){.radius = radius, .pitch = 2 * radius + 3, .margin = margin};
    scene->width = (int)(COLUMNS * scene->pitch + 2 * margin);
    scene->height = (int)(ROWS * scene->pitch + 2 * margin);
    for (int k = 0; k < COUNT; k++) {
        scene->dots[k] = dots_make(radius, sigma, key + (uint64_t)k);
        scene->x[k] = margin + (k % COLUMNS + 0.5) * scene->pitch + random_uniform(key, 3 * (uint64_t)k);
        scene->y[k] = margin + (k / COLUMNS + 0.5) * scene->pitch + random_uniform(key, 3 * (uint64_t)k + 1);
    }
}

static void scene_move(struct scene_drawn *scene, double shift, double own, double turn, uint64_t key)
{
    double u = shift * (2 * random_uniform(key, 1) - 1), v = shift * (2 * random_uniform(key, 2) - 1);
    for (int k = 0; k < COUNT; k++) {
        uint64_t c = 10 + 3 * (uint64_t)k;
        scene->motion[k] =
            (struct motion){u + own * (2 * random_uniform(key, c) - 1), v + own * (2 * random_uniform(key, c + 1) - 1),
                            turn * (2 * random_uniform(key, c + 2) - 1)};
    }
}

static struct photo scene_photo(const struct scene_drawn *scene, double noise, uint64_t key)
{
    struct canvas canvas = canvas_make(scene->width, scene->height, 0.05);
    for (int k = 0; k < COUNT; k++) {
        double x = scene->x[k] + scene->motion[k].u, y = scene->y[k] + scene->motion[k].v;
        canvas_add_disc(&canvas, x, y, scene->radius, 0.75, 0.7);
        canvas_add(&canvas, &scene->dots[k], x, y, scene->motion[k].angle, 0);
    }
    struct photo photo = canvas_photo(&canvas, 1, 0, noise, key);
    canvas_free(&canvas);
    return photo;
}

static int scene_grains(const struct scene_drawn *scene, struct photo_grains *grains)
{
    static const char *const names[] = {"x_px", "y_px", "radius_px", "flags", NULL};
    if (table_alloc(&PHOTO_GRAINS, grains, COUNT, names))
        return -1;
    memcpy(grains->x_px, scene->x, sizeof scene->x);
    memcpy(grains->y_px, scene->y, sizeof scene->y);
    for (int k = 0; k < COUNT; k++)
        grains->radius_px[k] = scene->radius;
    return 0;
}

static void scene_free_drawn(struct scene_drawn *scene)
{
    for (int k = 0; k < COUNT; k++)
        dots_free(&scene->dots[k]);
}

struct counts {
    int total, flagged, vague, wrong, silent; /* silent: wrong, neither flagged nor vague */
    double predicted;                         /* wrong angles that the stated errors let expect */
    double seconds, square, angle_square;
    int good;
};

static double cpu_seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void count(const struct scene_drawn *scene, const struct photo_grains *tracks, struct counts *counts)
{
    for (int k = 0; k < COUNT; k++) {
        double ex = tracks->x_px[k] - scene->x[k] - scene->motion[k].u;
        double ey = tracks->y_px[k] - scene->y[k] - scene->motion[k].v;
        double ea = tracks->angle[k] - scene->motion[k].angle;
        int flagged = (tracks->flags[k] & GRAIN_DISTRUST) != 0, vague = (tracks->flags[k] & GRAIN_VAGUE) != 0;
        int wrong = !(hypot(ex, ey) <= 0.5 && fabs(ea) <= 0.5 * degree);
        counts->total++;
        counts->flagged += flagged;
        counts->wrong += wrong;
        counts->vague += vague && !flagged;
        counts->silent += wrong && !flagged && !vague;
        if (isfinite(ea))
            counts->predicted += erfc(0.5 * degree / tracks->s_angle[k] / sqrt(2));
        if (!wrong) {
            counts->square += (ex * ex + ey * ey) / 2;
            counts->angle_square += ea * ea;
            counts->good++;
        }
    }
}

/* One photo after the reference. */
static int run(struct scene_drawn *scene, double noise, uint64_t key, struct counts *counts)
{
    struct tracker_options options = TRACKER_DEFAULT;
    struct photo_grains grains = {0};
    struct tracks tracks = {0};
    struct photo photo = scene_photo(scene, noise, key * 2 + 1);
    struct motion moved[COUNT];
    memcpy(moved, scene->motion, sizeof moved);
    memset(scene->motion, 0, sizeof moved);
    struct photo reference = scene_photo(scene, noise, key * 2);
    memcpy(scene->motion, moved, sizeof moved);
    int status = scene_grains(scene, &grains);
    double begin = cpu_seconds();
    if (!status)
        status = track_grains(&reference, &grains, &photo, NULL, &options, &tracks);
    counts->seconds += cpu_seconds() - begin;
    if (!status)
        count(scene, &tracks.grains, counts);
    tracks_free(&tracks);
    table_free(&PHOTO_GRAINS, &grains);
    free(photo.pixels);
    free(reference.pixels);
    return status;
}

static void print(const char *what, const struct counts *c)
{
    printf(
        "%-52s | %4d grains: wrong %d (the stated errors predict %.1f), wrong and not flagged %d, distrusted %d, vague "
        "%d | RMS %.4f px %.4f deg | %.2f ms per grain\n",
        what, c->total, c->wrong, c->predicted, c->silent, c->flagged, c->vague, sqrt(c->square / c->good),
        sqrt(c->angle_square / c->good) / degree, 1e3 * c->seconds / c->total);
    fflush(stdout);
}

static const struct {
    const char *name;
    double sigma[2];
} patterns[] = {{"normal", {1.2, 2.2}}, {"fine", {0.6, 1.0}}, {"coarse", {2.5, 4.0}}};

/* Shifts to 32 px and turns to 12 degrees without any earlier photo. */
static int table_start(int photos)
{
    const double radii[] = {16, 30, 66};
    for (int p = 0; p < 3; p++)
        for (int r = 0; r < 3; r++) {
            struct counts counts = {0};
            char what[80];
            for (int k = 0; k < photos; k++) {
                struct scene_drawn scene;
                uint64_t key = seed + (uint64_t)(1000 * (3 * p + r) + k) * COUNT;
                scene_make(&scene, radii[r], 50, patterns[p].sigma, key);
                scene_move(&scene, 32, 1, 12 * degree, key);
                if (run(&scene, 0.01, key, &counts))
                    return -1;
                scene_free_drawn(&scene);
            }
            snprintf(what, sizeof what, "start: %s, grain radius %g px, 32 px, 12 deg", patterns[p].name, radii[r]);
            print(what, &counts);
        }
    return 0;
}

/* Small motions, 3 % noise, small grains: where the original lost half of them in silence. */
static int table_noise(int photos)
{
    const double radii[] = {16, 28};
    for (int r = 0; r < 2; r++) {
        struct counts counts = {0};
        char what[80];
        for (int k = 0; k < photos; k++) {
            struct scene_drawn scene;
            uint64_t key = seed + (uint64_t)(20000 + 1000 * r + k) * COUNT;
            scene_make(&scene, radii[r], 20, patterns[0].sigma, key);
            scene_move(&scene, 5, 0.8, 2 * degree, key);
            if (run(&scene, 0.03, key, &counts))
                return -1;
            scene_free_drawn(&scene);
        }
        snprintf(what, sizeof what, "noise 3 %%: normal, grain radius %g px, 5 px, 2 deg", radii[r]);
        print(what, &counts);
    }
    return 0;
}

/* CPU of one photo of 1850 grains of radius 100 px (subset 80), scaled from COUNT of them; one thread. */
static int table_speed(int photos)
{
    struct scene_drawn scene;
    struct photo_grains grains = {0};
    struct tracker_options options = TRACKER_DEFAULT;
    scene_make(&scene, 100, 20, patterns[0].sigma, seed);
    struct photo reference = scene_photo(&scene, 0.01, 1);
    omp_set_num_threads(1);
    if (scene_grains(&scene, &grains))
        return -1;
    for (int keep = 0; keep < 2; keep++) {
        options.keep = keep;
        struct tracker *tracker = tracker_open(&reference, &grains, &options);
        struct tracks previous = {0};
        for (int k = 0; tracker && k < 3 && k < photos; k++) {
            struct tracks tracks = {0};
            scene_move(&scene, 0.5, 0.3, 0.1 * degree, seed + (uint64_t)k);
            struct photo photo = scene_photo(&scene, 0.01, 2 + (uint64_t)k);
            double begin = cpu_seconds();
            if (tracker_follow(tracker, &photo, k ? &previous.grains : NULL, &tracks))
                return -1;
            double seconds = cpu_seconds() - begin;
            printf("speed: subsets %s, photo %d | %.3f ms per grain, %.2f s per 1850 grains of radius 100 px\n",
                   keep ? "kept" : "built anew", k + 1, 1e3 * seconds / COUNT, seconds / COUNT * 1850);
            tracks_free(&previous);
            previous = tracks;
            free(photo.pixels);
        }
        tracks_free(&previous);
        tracker_close(tracker);
    }
    table_free(&PHOTO_GRAINS, &grains);
    free(reference.pixels);
    scene_free_drawn(&scene);
    return 0;
}

int main(int argc, char **argv)
{
    static const struct {
        const char *name;
        int (*run)(int photos);
    } tables[] = {{"start", table_start}, {"noise", table_noise}, {"speed", table_speed}};
    const char *only = "";
    int photos = 8;
    for (int k = 1; k + 1 < argc; k += 2) {
        if (!strcmp(argv[k], "--photos"))
            photos = atoi(argv[k + 1]);
        else if (!strcmp(argv[k], "--only"))
            only = argv[k + 1];
    }
    progress_silence();
    for (int t = 0; t < 3; t++)
        if ((!*only || !strcmp(only, tables[t].name)) && tables[t].run(photos)) {
            fprintf(stderr, "bench_tracker_start: %s\n", error_message());
            return error_status();
        }
    return 0;
}
