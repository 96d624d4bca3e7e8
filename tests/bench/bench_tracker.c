/* IC-GN against the Cramer-Rao bound, and its bias: drawn dots moved exactly (tests/dots.h), seeds that no test uses.
 *
 *     bench_tracker [--trials N] [--only bias|noise|turn|blur|segments] [--json FILE]
 *
 * Bound: sigma^2 (1 + 1/gain^2) (J'J)^-1 with J the exact slopes of the noise-free pattern, orthogonal to {1, grey}. */
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "pipeline/speak/error.h"
#include "tests/dots.h"
#include "tracker/search/icgn.h"
#include "tracker/subset/kernel.h"

static const double degree = 3.141592653589793 / 180;
static const uint64_t seed = 77000000;

struct cell {
    const double *sigma; /* pattern */
    double radius, noise, blur;
    double turn; /* rad; NaN: shifts only */
    int trials;
};

struct result {
    double rms, rms_angle;     /* px, rad */
    double bound, bound_angle; /* root mean square of the bound */
    double stated, stated_angle;
    double bias; /* px: largest mean error of a shift */
    int failures, trials;
    double iterations, seconds; /* CPU, of subset_build and icgn_fit */
};

/* Patterns and noise of a cell that no other cell shares. */
static uint64_t cell_key(const struct cell *cell)
{
    double turn = isnan(cell->turn) ? -1 : cell->turn;
    return seed + 100000 * (uint64_t)(cell->radius + 1000 * cell->noise + 300 * cell->sigma[0] + 500 * cell->blur +
                                      10000 * (turn + 1));
}

static double cpu_seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Slopes of one dot integrated over pixels, times `volume`: exact derivatives of canvas_add_dot. */
static void add_dot_slopes(struct canvas *gx, struct canvas *gy, double x, double y, double sigma, double height)
{
    enum { REACH = 32 };
    double scale = 1 / (sigma * sqrt(2)), volume = height * sigma * sigma * 1.5707963267948966;
    double across[2 * REACH + 1], across_slope[2 * REACH + 1];
    int reach = (int)ceil(6 * sigma), ix = (int)floor(x), iy = (int)floor(y);
    for (int i = -reach; i <= reach; i++) {
        double right = (ix + i + 0.5 - x) * scale, left = (ix + i - 0.5 - x) * scale;
        across[i + reach] = erf(right) - erf(left);
        across_slope[i + reach] = 1.1283791670955126 * scale * (exp(-right * right) - exp(-left * left));
    }
    for (int j = -reach; j <= reach; j++) {
        double below = (iy + j + 0.5 - y) * scale, above = (iy + j - 0.5 - y) * scale;
        double down = erf(below) - erf(above);
        double down_slope = 1.1283791670955126 * scale * (exp(-below * below) - exp(-above * above));
        if (iy + j < 0 || iy + j >= gx->height)
            continue;
        for (int i = -reach; i <= reach; i++) {
            if (ix + i < 0 || ix + i >= gx->width)
                continue;
            size_t k = (size_t)(iy + j) * (size_t)gx->width + (size_t)(ix + i);
            gx->grey[k] += volume * across_slope[i + reach] * down;
            gy->grey[k] += volume * across[i + reach] * down_slope;
        }
    }
}

/* (J'J)^-1 of the exact slopes over the disc, in units of white^-2. */
static void exact_bound(const struct dots *dots, const struct canvas *grey, const struct shape *shape,
                        double inverse[3][3])
{
    struct canvas gx = canvas_make(grey->width, grey->height, 0), gy = canvas_make(grey->width, grey->height, 0);
    double sums[5][5] = {{0}}; /* gx, gy, ga, grey, 1 */
    for (size_t k = 0; k < dots->count; k++)
        add_dot_slopes(&gx, &gy, shape->cx + dots->x[k], shape->cy + dots->y[k], dots->sigma[k], dots->height[k]);
    for (int y = 0; y < grey->height; y++)
        for (int x = 0; x < grey->width; x++) {
            double dx = x - shape->cx, dy = y - shape->cy;
            if (dx * dx + dy * dy > shape->radius * shape->radius)
                continue;
            size_t k = (size_t)y * (size_t)grey->width + (size_t)x;
            const double v[5] = {gx.grey[k], gy.grey[k], gx.grey[k] * dy - gy.grey[k] * dx, grey->grey[k], 1};
            for (int a = 0; a < 5; a++)
                for (int b = 0; b < 5; b++)
                    sums[a][b] += v[a] * v[b];
        }
    for (int out = 4; out >= 3; out--) /* eliminate 1, then grey */
        for (int a = 0; a < out; a++)
            for (int b = 0; b < out; b++)
                sums[a][b] -= sums[a][out] * sums[out][b] / sums[out][out];
    double hessian[3][3];
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            hessian[a][b] = sums[a][b];
    subset_invert(hessian, inverse);
    canvas_free(&gx);
    canvas_free(&gy);
}

/* One pattern, one reference, one moved photo. */
static void run_trial(const struct cell *cell, uint64_t key, struct motion truth, struct result *result,
                      double error[3])
{
    int centre = (int)(1.2 * cell->radius) + 14;
    struct shape shape = {
        .cx = centre + random_uniform(key, 1), .cy = centre + random_uniform(key, 2), .radius = cell->radius};
    struct dots dots = dots_make(1.15 * cell->radius + 8, cell->sigma, key);
    struct canvas before = canvas_make(2 * centre + 2, 2 * centre + 2, 0.8), after = before;
    after = canvas_make(before.width, before.height, 0.8);
    canvas_add(&before, &dots, shape.cx, shape.cy, 0, 0);
    canvas_add(&after, &dots, shape.cx + truth.u, shape.cy + truth.v, truth.angle, cell->blur);
    struct photo reference = canvas_photo(&before, 1, 0, cell->noise, key * 2 + 1);
    struct photo photo = canvas_photo(&after, 1, 0, cell->noise, key * 2 + 2);
    double bound[3][3];
    exact_bound(&dots, &before, &shape, bound);

    struct motion start = {truth.u + 0.3 * random_normal(key, 10), truth.v + 0.3 * random_normal(key, 11),
                           truth.angle + 0.2 * degree * random_normal(key, 12)};
    struct icgn_options options = ICGN_DEFAULT;
    static struct patch patch;
    struct subset subset;
    struct fit fit = {0};
    double begin = cpu_seconds();
    if (subset_build(&reference, &shape, NULL, &subset) || icgn_fit(&subset, &photo, start, &options, &patch, &fit))
        fprintf(stderr, "%s\n", error_message());
    result->seconds += cpu_seconds() - begin;
    error[0] = fit.motion.u - truth.u;
    error[1] = fit.motion.v - truth.v;
    error[2] = fit.motion.angle - truth.angle;
    result->trials++;
    if (!fit.converged || hypot(error[0], error[1]) > 0.5 || fabs(error[2]) > 0.5 * degree) {
        result->failures++;
    } else {
        double noise2 = 2 * cell->noise * cell->noise;
        result->rms += (error[0] * error[0] + error[1] * error[1]) / 2;
        result->rms_angle += error[2] * error[2];
        result->bound += noise2 * (bound[0][0] + bound[1][1]) / 2;
        result->bound_angle += noise2 * bound[2][2];
        result->stated += (fit.covariance[0][0] + fit.covariance[1][1]) / 2;
        result->stated_angle += fit.covariance[2][2];
        result->iterations += fit.iterations;
    }
    subset_free(&subset);
    dots_free(&dots);
    canvas_free(&before);
    canvas_free(&after);
    free(reference.pixels);
    free(photo.pixels);
}

static void finish(struct result *result)
{
    double n = result->trials - result->failures;
    double *squares[] = {&result->rms,         &result->rms_angle, &result->bound,
                         &result->bound_angle, &result->stated,    &result->stated_angle};
    for (int k = 0; k < 6; k++)
        *squares[k] = sqrt(*squares[k] / n);
    result->iterations /= n;
    result->seconds /= result->trials;
}

/* Random errors: shifts 0, 0.3, 0.5 px, or random shifts at the cell's angle. */
static struct result run_noise(const struct cell *cell)
{
    static const double shifts[] = {0, 0.3, 0.5};
    struct result result = {0};
    for (int k = 0; k < cell->trials; k++) {
        uint64_t key = cell_key(cell) + (uint64_t)k;
        struct motion truth = {shifts[k % 3], shifts[k / 3 % 3], 0};
        double error[3];
        if (!isnan(cell->turn))
            truth = (struct motion){random_uniform(key, 20), random_uniform(key, 21), cell->turn};
        run_trial(cell, key, truth, &result, error);
    }
    finish(&result);
    return result;
}

/* Mean error over trials at each of 11 shifts, no noise. */
static struct result run_bias(const struct cell *cell)
{
    struct result result = {0};
    for (int step = 0; step <= 10; step++) {
        double u = 0, v = 0;
        for (int k = 0; k < cell->trials; k++) {
            double error[3];
            struct motion truth = {step * 0.1, 1 - step * 0.1, 0};
            run_trial(cell, seed + 500000 + (uint64_t)k, truth, &result, error);
            u += error[0] / cell->trials;
            v += error[1] / cell->trials;
        }
        result.bias = fmax(result.bias, fmax(fabs(u), fabs(v)));
    }
    finish(&result);
    return result;
}

static FILE *json;

static void write_json(const char *table, const char *pattern, const struct cell *cell, const struct result *r)
{
    static int lines;
    if (!json)
        return;
    fprintf(json,
            "%s{\"table\":\"%s\",\"pattern\":\"%s\",\"radius_px\":%g,\"noise\":%g,\"turn_deg\":%g,\"blur_px\":%g,"
            "\"rms_px\":%.6g,\"rms_deg\":%.6g,\"bound_px\":%.6g,\"bound_deg\":%.6g,\"stated_px\":%.6g,"
            "\"stated_deg\":%.6g,\"bias_px\":%.6g,\"failures\":%d,\"iterations\":%.3g,\"ms\":%.4g}\n",
            lines++ ? "," : "", table, pattern, cell->radius, cell->noise, isnan(cell->turn) ? 0 : cell->turn / degree,
            cell->blur, r->rms, r->rms_angle / degree, r->bound, r->bound_angle / degree, r->stated,
            r->stated_angle / degree, r->bias, r->failures, r->iterations, 1e3 * r->seconds);
}

static struct result print_noise(const char *table, const char *pattern, const struct cell *cell)
{
    struct result r = run_noise(cell);
    printf("%-8s r %3g  noise %3g%%  turn %5g  blur %g | RMS %.5f px %.5f deg | / bound %.2f %.2f | stated / RMS %.2f "
           "%.2f | lost %d | %.1f it. %.3f ms\n",
           pattern, cell->radius, 100 * cell->noise, isnan(cell->turn) ? 0 : cell->turn / degree, cell->blur, r.rms,
           r.rms_angle / degree, r.rms / r.bound, r.rms_angle / r.bound_angle, r.stated / r.rms,
           r.stated_angle / r.rms_angle, r.failures, r.iterations, 1e3 * r.seconds);
    fflush(stdout);
    write_json(table, pattern, cell, &r);
    return r;
}

/* Mean of (RMS / bound)^2 over cells. */
struct pool {
    double shift, turn, stated, stated_turn;
    int cells;
};

static void pool_add(struct pool *pool, struct result r)
{
    pool->shift += pow(r.rms / r.bound, 2);
    pool->turn += pow(r.rms_angle / r.bound_angle, 2);
    pool->stated += pow(r.stated / r.rms, 2);
    pool->stated_turn += pow(r.stated_angle / r.rms_angle, 2);
    pool->cells++;
}

static void pool_print(const char *what, const struct pool *pool, const char *target)
{
    double n = pool->cells;
    printf("%s: RMS / bound %.3f px, %.3f deg (target %s); stated / RMS %.2f, %.2f (target 0.90 to 1.10)\n", what,
           sqrt(pool->shift / n), sqrt(pool->turn / n), target, sqrt(pool->stated / n), sqrt(pool->stated_turn / n));
}

static void print_bias(const char *pattern, const struct cell *cell)
{
    struct result r = run_bias(cell);
    printf("%-8s r %3g | largest bias %.5f px, RMS %.5f px %.5f deg, lost %d\n", pattern, cell->radius, r.bias, r.rms,
           r.rms_angle / degree, r.failures);
    fflush(stdout);
    write_json("bias", pattern, cell, &r);
}

static const struct pattern {
    const char *name;
    double sigma[2];
} patterns[] = {{"normal", {1.2, 2.2}}, {"fine", {0.6, 1.0}}, {"coarse", {2.5, 4.0}}};

static void table_bias(int trials)
{
    puts("Bias, no noise, shifts 0 to 1 px (targets: normal 0.0005, fine 0.001)");
    for (int p = 0; p < 3; p++)
        print_bias(patterns[p].name, &(struct cell){patterns[p].sigma, 80, 0, 0, 0, trials / 20 + 1});
}

static void table_noise(int trials)
{
    const double radii[] = {53, 80, 133}, noises[] = {0.005, 0.01, 0.02};
    struct pool normal = {0}, fine = {0};
    puts("Noise, shifts 0, 0.3, 0.5 px");
    for (int r = 0; r < 3; r++)
        for (int n = 0; n < 3; n++)
            pool_add(&normal, print_noise("noise", "normal",
                                          &(struct cell){patterns[0].sigma, radii[r], noises[n], 0, NAN, trials}));
    for (int n = 0; n < 3; n++)
        pool_add(&fine, print_noise("noise", "fine", &(struct cell){patterns[1].sigma, 80, noises[n], 0, NAN, trials}));
    print_noise("noise", "coarse", &(struct cell){patterns[2].sigma, 80, 0.01, 0, NAN, trials});
    pool_print("normal, all nine", &normal, "1.05");
    pool_print("fine, all three", &fine, "1.10");
}

static void table_turn(int trials)
{
    const double turns[] = {0.05, 0.5, 2, 10, 45};
    struct pool pool = {0};
    puts("Rotation, random shifts, noise 1 %");
    for (int t = 0; t < 5; t++)
        pool_add(&pool, print_noise("turn", "normal",
                                    &(struct cell){patterns[0].sigma, 80, 0.01, 0, turns[t] * degree, trials}));
    pool_print("all five", &pool, "1.05");
}

static void table_blur(int trials)
{
    const double blurs[] = {0.5, 1};
    puts("Blur change (standard deviation), 2 degrees, noise 1 % (target 0.0018 px)");
    for (int b = 0; b < 2; b++)
        for (int p = 0; p < 2; p++)
            print_noise("blur", patterns[p].name,
                        &(struct cell){patterns[p].sigma, 80, 0.01, blurs[b], 2 * degree, trials});
}

/* The thesis's measure (section 4.1.4.3): two perpendicular segments on a grain, their four ends followed; a rigid
 * motion keeps the lengths and the angle between them. A grain of radius 50 px, segments of 50 px, ends of radius 12
 * px. */
static int segment_change(uint64_t key, struct motion truth, double *length, double *angle)
{
    enum { ENDS = 4, CENTRE = 62, SIDE = 2 * CENTRE + 1 };
    const double half = 25, ends[ENDS][2] = {{-half, 0}, {half, 0}, {0, -half}, {0, half}};
    struct dots dots = dots_make(58, patterns[0].sigma, key);
    struct canvas before = canvas_make(SIDE, SIDE, 0.8), after = canvas_make(SIDE, SIDE, 0.8);
    canvas_add(&before, &dots, CENTRE, CENTRE, 0, 0);
    canvas_add(&after, &dots, CENTRE + truth.u, CENTRE + truth.v, truth.angle, 0);
    struct photo reference = canvas_photo(&before, 1, 0, 0.01, 2 * key),
                 photo = canvas_photo(&after, 1, 0, 0.01, 2 * key + 1);
    struct icgn_options options = ICGN_DEFAULT;
    double x[ENDS], y[ENDS], c = cos(truth.angle), s = sin(truth.angle);
    static struct patch patch;
    int lost = 0;
    for (int k = 0; k < ENDS; k++) {
        struct shape shape = {.cx = CENTRE + ends[k][0], .cy = CENTRE + ends[k][1], .radius = 12};
        struct motion start = {truth.u + (c - 1) * ends[k][0] + s * ends[k][1] + 0.2,
                               truth.v - s * ends[k][0] + (c - 1) * ends[k][1] - 0.2, truth.angle};
        struct subset subset;
        struct fit fit = {0};
        lost |= subset_build(&reference, &shape, NULL, &subset) ||
                icgn_fit(&subset, &photo, start, &options, &patch, &fit) || !fit.converged;
        x[k] = shape.cx + fit.motion.u;
        y[k] = shape.cy + fit.motion.v;
        subset_free(&subset);
    }
    *length = hypot(x[1] - x[0], y[1] - y[0]) - 2 * half;
    *angle = remainder(atan2(y[3] - y[2], x[3] - x[2]) - atan2(y[1] - y[0], x[1] - x[0]) - 90 * degree, 360 * degree);
    dots_free(&dots);
    canvas_free(&before);
    canvas_free(&after);
    free(reference.pixels);
    free(photo.pixels);
    return lost;
}

static void table_segments(int trials)
{
    double sum[2] = {0}, square[2] = {0};
    int n = 0, lost = 0;
    for (int k = 0; k < 4 * trials; k++) {
        uint64_t key = seed + 900000 + (uint64_t)k;
        struct motion truth = {random_uniform(key, 20), random_uniform(key, 21),
                               (2 * random_uniform(key, 22) - 1) * degree};
        double change[2];
        if (segment_change(key, truth, &change[0], &change[1])) {
            lost++;
            continue;
        }
        for (int i = 0; i < 2; i++) {
            sum[i] += change[i];
            square[i] += change[i] * change[i];
        }
        n++;
    }
    double mean[2] = {sum[0] / n, sum[1] / n};
    printf(
        "Segments of 50 px, noise 1 %%, %d grains, lost %d: dS %.4f +- %.4f px (thesis 0.01 +- 0.05), d alpha %.4f +- "
        "%.4f deg (thesis 0.01 +- 0.06)\n",
        n, lost, mean[0], sqrt(square[0] / n - mean[0] * mean[0]), mean[1] / degree,
        sqrt(square[1] / n - mean[1] * mean[1]) / degree);
}

int main(int argc, char **argv)
{
    static const struct {
        const char *name;
        void (*run)(int trials);
    } tables[] = {{"bias", table_bias},
                  {"noise", table_noise},
                  {"turn", table_turn},
                  {"blur", table_blur},
                  {"segments", table_segments}};
    const char *only = "";
    int trials = 120;
    for (int k = 1; k + 1 < argc; k += 2) {
        if (!strcmp(argv[k], "--trials"))
            trials = atoi(argv[k + 1]);
        else if (!strcmp(argv[k], "--only"))
            only = argv[k + 1];
        else if (!strcmp(argv[k], "--json"))
            json = fopen(argv[k + 1], "w");
    }
    if (json)
        fputs("[", json);
    for (int t = 0; t < 5; t++)
        if (!*only || !strcmp(only, tables[t].name))
            tables[t].run(trials);
    if (json) {
        fputs("]\n", json);
        return fclose(json) ? 1 : 0;
    }
    return 0;
}
