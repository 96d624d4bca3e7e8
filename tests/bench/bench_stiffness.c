/* calibration stiffness on drawn photos of two rods at full size: 40 photos, 0 to 1000 N, 6e-5 m/px, rods of 20 mm.
 *
 *     bench_stiffness [SEEDS]        (default 10)
 */
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "calibration/rods/stiffness.h"
#include "pipeline/speak/error.h"
#include "tests/pressed_rods.h"

struct sums {
    double kn, kn2, first, first2, back2, at, at2, again_at2, stated;
    int breaks, draws;
    double worst;
};

static int run(const struct pressed_rods *rods, struct sums *sums)
{
    struct press_series_options series = {.rods = {0, 1}, .scale = rods->scale};
    struct press_options options = PRESS_DEFAULT;
    struct press_photo tracked[ROD_PHOTOS] = {0};
    struct press_point points[ROD_PHOTOS];
    struct stiffness stiffness = {0};
    double at[ROD_PHOTOS], force[ROD_PHOTOS];
    for (int k = 0; k < ROD_PHOTOS; k++)
        at[k] = 2 * k, force[k] = pressed_force(k);
    struct force_record record = {.count = ROD_PHOTOS, .at = at, .force = force};
    int status = pressed_follow(rods, tracked);
    if (!status)
        status = press_series_points(tracked, ROD_PHOTOS, &record, &series, points);
    if (!status)
        status = stiffness_fit(points, ROD_PHOTOS, &options, &stiffness);
    if (!status && stiffness.phase_count == 3) {
        const struct pressed_law *law = &PRESSED_LAW;
        double kn = stiffness.kn / (0.5 * (law->k_high + law->again_high)) - 1;
        double first = stiffness.phase[0].k_high / law->k_high - 1, back = stiffness.unloading / law->k_back - 1;
        double b = stiffness.phase[0].break_force - law->at, again = stiffness.phase[2].break_force - law->again_at;
        sums->kn += kn, sums->kn2 += kn * kn, sums->first2 += first * first, sums->back2 += back * back;
        sums->at2 += b * b, sums->again_at2 += again * again;
        sums->breaks += isfinite(b) + isfinite(again);
        sums->stated += stiffness.s_kn / stiffness.kn;
        sums->worst = fmax(sums->worst, fabs(kn));
        sums->draws++;
    }
    stiffness_free(&stiffness);
    for (int k = 0; k < ROD_PHOTOS; k++)
        press_photo_free(&tracked[k]);
    return status;
}

int main(int argc, char **argv)
{
    static const double noises[] = {0, 0.01, 0.02};
    int seeds = argc > 1 ? atoi(argv[1]) : 10;
    printf("| photo noise | k_n: mean error | RMS | worst | stated | first loading RMS | unloading RMS | break RMS, "
           "first and second (250, 180 N) | breaks found | CPU s per test |\n"
           "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
    for (int n = 0; n < 3; n++) {
        struct sums sums = {0};
        clock_t begin = clock();
        for (int seed = 1; seed <= seeds; seed++) {
            struct pressed_rods rods = {.scale = 6e-5, .radius_px = 166.7, .noise = noises[n], .seed = (uint64_t)seed};
            if (run(&rods, &sums)) {
                fprintf(stderr, "bench_stiffness: %s\n", error_message());
                return 1;
            }
        }
        double d = sums.draws;
        printf(
            "| %g %% | %+.3f %% | %.3f %% | %.3f %% | %.3f %% | %.3f %% | %.3f %% | %.1f, %.1f N | %d of %d | %.1f |\n",
            100 * noises[n], 100 * sums.kn / d, 100 * sqrt(sums.kn2 / d), 100 * sums.worst, 100 * sums.stated / d,
            100 * sqrt(sums.first2 / d), 100 * sqrt(sums.back2 / d), sqrt(sums.at2 / d), sqrt(sums.again_at2 / d),
            sums.breaks, 2 * seeds, (double)(clock() - begin) / CLOCKS_PER_SEC / seeds);
        fflush(stdout);
    }
    return 0;
}
