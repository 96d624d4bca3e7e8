/* What a photo of 80 Mpixels and 1850 grains costs: CPU seconds and peak memory, decoding apart.
 *
 *     bench_tracker_photo [--threads N] [--photos N]
 *
 * Two processes, so that each has its own peak: subsets built anew for every photo, and subsets kept. */
#include <omp.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "pipeline/speak/progress.h"
#include "tests/bench/stamped.h"
#include "tracker/follow/track_grains.h"

enum { COLUMNS = 50, ROWS = 37, COUNT = COLUMNS * ROWS, PITCH = 206 };
static const double radius = 100, noise = 0.01;
static const uint64_t seed = 66000000;

static double clock_seconds(clockid_t id)
{
    struct timespec now;
    clock_gettime(id, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static double place(int k, int axis)
{
    int cell = axis ? k / COLUMNS : k % COLUMNS;
    return (cell + 0.5) * PITCH + 10 + random_uniform(seed + (uint64_t)k, (uint64_t)axis);
}

/* Photo `index` of a slow test: grains move by 0.5 px and 0.05 degrees per photo, each its own way. */
static struct motion motion_of(int k, int index)
{
    uint64_t key = seed + (uint64_t)k;
    return (struct motion){index * (random_uniform(key, 5) - 0.5), index * (random_uniform(key, 6) - 0.5),
                           index * 0.002 * (random_uniform(key, 7) - 0.5)};
}

static struct photo draw(int index)
{
    struct photo photo = stamped_blank(0.1, noise, seed + (uint64_t)index);
#pragma omp parallel for schedule(dynamic, 8)
    for (int k = 0; k < COUNT; k++) {
        struct motion m = motion_of(k, index);
        struct dots dots = dots_make(radius, DOTS_NORMAL, seed + (uint64_t)k);
        stamp(&photo, &dots, place(k, 0), place(k, 1), PITCH / 2, place(k, 0) + m.u, place(k, 1) + m.v, m.angle, 1,
              noise, seed + (uint64_t)(COUNT * (index + 1) + k));
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

static void report(const struct tracks *tracks, int index, double cpu, double wall)
{
    double square = 0;
    struct rusage usage;
    for (int k = 0; k < COUNT; k++) {
        struct motion m = motion_of(k, index);
        square +=
            (pow(tracks->grains.x_px[k] - place(k, 0) - m.u, 2) + pow(tracks->grains.y_px[k] - place(k, 1) - m.v, 2)) /
            (2 * COUNT);
    }
    getrusage(RUSAGE_SELF, &usage);
    printf(
        "  photo %d: CPU %.2f s (elapsed %.2f s), RMS %.4f px, flagged %zu, peak memory %.0f MB = 2 photos + %.0f MB\n",
        index, cpu, wall, sqrt(square), tracks_flagged(tracks), (double)usage.ru_maxrss * 1024 / 1e6,
        (double)usage.ru_maxrss * 1024 / 1e6 - 4e-6 * FULL_WIDTH * FULL_HEIGHT);
    fflush(stdout);
}

static int run(int keep, int photos, int threads)
{
    struct tracker_options options = TRACKER_DEFAULT;
    struct tracks previous = {0};
    struct photo_grains grains = circles();
    struct photo reference = draw(0);
    options.keep = keep;
    omp_set_num_threads(threads);
    struct tracker *tracker = NULL;
    for (int index = 1; index <= photos; index++) {
        omp_set_num_threads(omp_get_num_procs());
        struct photo photo = draw(index);
        omp_set_num_threads(threads);
        struct tracks tracks = {0};
        double cpu = clock_seconds(CLOCK_PROCESS_CPUTIME_ID), wall = clock_seconds(CLOCK_MONOTONIC);
        if (!tracker)
            tracker = tracker_open(&reference, &grains, &options);
        if (!tracker || tracker_follow(tracker, &photo, previous.grains.count ? &previous.grains : NULL, &tracks)) {
            fprintf(stderr, "bench_tracker_photo: %s\n", error_message());
            return 1;
        }
        report(&tracks, index, clock_seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu, clock_seconds(CLOCK_MONOTONIC) - wall);
        tracks_free(&previous);
        previous = tracks;
        free(photo.pixels);
    }
    tracks_free(&previous);
    tracker_close(tracker);
    table_free(&PHOTO_GRAINS, &grains);
    free(reference.pixels);
    return 0;
}

int main(int argc, char **argv)
{
    int threads = 1, photos = 2, failed = 0;
    for (int k = 1; k + 1 < argc; k += 2) {
        if (!strcmp(argv[k], "--threads"))
            threads = atoi(argv[k + 1]);
        else if (!strcmp(argv[k], "--photos"))
            photos = atoi(argv[k + 1]);
    }
    progress_silence();
    for (int keep = 0; keep < 2; keep++) {
        int status = 0;
        printf("%d grains of radius %g px in %d x %d px, subsets %s, %d thread(s)\n", COUNT, radius, FULL_WIDTH,
               FULL_HEIGHT, keep ? "kept" : "built anew", threads);
        fflush(stdout);
        pid_t child = fork();
        if (!child)
            _exit(run(keep, photos, threads));
        if (child < 0 || waitpid(child, &status, 0) < 0 || status)
            failed = 1;
    }
    return failed;
}
