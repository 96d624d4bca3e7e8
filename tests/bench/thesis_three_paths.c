/* Thesis 2.2: the ways to equilibrium in the plane of (fn, ft), and how fast. */
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "tests/bench/three_discs.h"

enum { STARTS = 1000 };
static struct three_path path;

static const double STARTS_SHOWN[][2] = {{200, 50},    {600, 300}, {900, -450},  {300, -400},
                                         {1400, -100}, {100, 700}, {5500, -1000}};
enum { SHOWN = sizeof STARTS_SHOWN / sizeof *STARTS_SHOWN };

static struct chart plane(const char *title)
{
    return (struct chart){.title = title, .x_label = "fn, N", .y_label = "ft, N"};
}

static int statics(struct chart *chart, double p, const char *name)
{
    struct chart_line *line = chart_add(chart, name, 2);
    if (!line)
        return -1;
    line->dashed = 1;
    for (int k = 0; k < 2; k++) /* ft = P / (2 sin 45) - fn, thesis (2.54) */
        chart_put(line, k ? 2200 : 0, p * sqrt(0.5) - (k ? 2200 : 0));
    return 0;
}

static int draw(struct chart *chart, const char *name)
{
    struct chart_line *line = chart_add(chart, name, THREE_LIMIT + 1);
    for (int k = 0; line && k <= path.count; k++)
        chart_put(line, path.fn[k], path.ft[k]);
    if (line)
        line->without_key = 1;
    return line ? 0 : -1;
}

static int figure_2_14(struct thesis *thesis)
{
    static const double aims[] = {-1, -0.5, 0, 0.5, 1};
    struct chart chart = plane("2.14 molecular dynamics");
    if (statics(&chart, THREE_P, "equilibrium"))
        return -1;
    thesis_line(thesis, "%8s %14s %10s %10s %8s", "aim", "F_noise / P", "fn, N", "ft, N", "m");
    for (int a = 0; a < 5; a++) {
        double best = 0, nearest = INFINITY;
        for (double noise = 1; noise < 1e5; noise *= 1.03) {
            struct three_rest rest = three_molecular(THREE_DAMPING, THREE_P * noise, NULL);
            double miss = fabs(three_mobilised(0.5, rest.fn, rest.ft) - aims[a]);
            if (miss < nearest - 1e-6)
                nearest = miss, best = noise;
        }
        char name[40];
        snprintf(name, sizeof name, "m %g", aims[a]);
        struct chart_line *line = chart_add(&chart, name, 2000);
        if (!line)
            return -1;
        struct three_rest rest = three_molecular(THREE_DAMPING, THREE_P * best, line);
        thesis_line(thesis, "%8g %14.4g %10.2f %10.2f %8.3f", aims[a], best, rest.fn, rest.ft,
                    three_mobilised(0.5, rest.fn, rest.ft));
    }
    return thesis_picture(thesis, &chart, 1);
}

static int figure_2_18(struct thesis *thesis)
{
    struct chart chart = plane("2.18 contact dynamics");
    if (statics(&chart, THREE_P, "equilibrium"))
        return -1;
    thesis_line(thesis, "%8s %8s %12s %12s %8s %6s", "fn0", "ft0", "fn", "ft", "m", "its");
    for (int s = 0; s < SHOWN; s++) {
        three_dynamics(0.5, STARTS_SHOWN[s][0], STARTS_SHOWN[s][1], &path);
        int k = path.count;
        thesis_line(thesis, "%8g %8g %12.3f %12.3f %8.3f %6d", STARTS_SHOWN[s][0], STARTS_SHOWN[s][1], path.fn[k],
                    path.ft[k], three_mobilised(0.5, path.fn[k], path.ft[k]), k);
        if (s < SHOWN - 1 && draw(&chart, ""))
            return -1;
    }
    three_dynamics(0.5, 0, 0, &path);
    thesis_line(thesis, "from zero: fn %.2f N, ft %.2f N (thesis: 811.40, 270.45)", path.fn[path.count],
                path.ft[path.count]);
    return thesis_picture(thesis, &chart, 1);
}

/* |Fy| / P along the iterations; *slope: its factor per iteration, over the middle part. */
static int decay(struct chart *chart, const char *name, double *factor)
{
    struct chart_line *line = chart_add(chart, name, THREE_LIMIT + 1);
    for (int k = 0; line && k <= path.count; k++)
        chart_put(line, k, fabs(path.fy[k]) / THREE_P);
    int half = path.count / 2;
    *factor = half > 0 ? pow(fabs(path.fy[half] / path.fy[0]), 1.0 / half) : 0;
    return line ? 0 : -1;
}

static int figure_2_19(struct thesis *thesis)
{
    struct chart chart = {.title = "2.19 contact dynamics", .x_label = "iteration", .y_label = "|Fy| / P", .log_y = 1};
    for (int s = 0; s < 3; s++) {
        char name[40];
        double factor;
        three_dynamics(0.5, STARTS_SHOWN[s][0], STARTS_SHOWN[s][1], &path);
        snprintf(name, sizeof name, "(%g, %g)", STARTS_SHOWN[s][0], STARTS_SHOWN[s][1]);
        if (decay(&chart, name, &factor))
            return -1;
        thesis_line(thesis, "start %-12s |Fy|/P shrinks by %.4f an iteration, %d iterations", name, factor, path.count);
    }
    return thesis_picture(thesis, &chart, 1);
}

static int figure_2_25(struct thesis *thesis)
{
    struct chart charts[] = {plane("2.25 equilibrium first"), plane("2.25 cone first")};
    if (statics(&charts[0], THREE_P, "equilibrium") || statics(&charts[1], THREE_P, "equilibrium"))
        return -1;
    thesis_line(thesis, "%8s %8s | equilibrium first: %9s %8s %4s | cone first: %9s %8s %4s", "fn0", "ft0", "fn", "m",
                "its", "fn", "m", "its");
    for (int s = 0; s < SHOWN; s++) {
        double fn[2], m[2];
        int its[2];
        for (int first = 0; first < 2; first++) {
            three_projections(THREE_P, 0.5, STARTS_SHOWN[s][0], STARTS_SHOWN[s][1], first, &path);
            fn[first] = path.fn[path.count], its[first] = path.count;
            m[first] = three_mobilised(0.5, fn[first], path.ft[path.count]);
            if (draw(&charts[first], ""))
                return -1;
        }
        thesis_line(thesis, "%8g %8g |                    %9.2f %8.3f %4d |             %9.2f %8.3f %4d",
                    STARTS_SHOWN[s][0], STARTS_SHOWN[s][1], fn[0], m[0], its[0], fn[1], m[1], its[1]);
    }
    return thesis_picture(thesis, charts, 2);
}

/* From equilibrium with 2 P in 100 steps of the load, and at once. */
static int figure_2_26(struct thesis *thesis)
{
    static const double mobilised[] = {-0.6, 0.2, 0.9};
    struct chart chart = plane("2.26 load taken off step by step");
    if (statics(&chart, THREE_P, "equilibrium, P") || statics(&chart, 2 * THREE_P, "equilibrium, 2 P"))
        return -1;
    for (int s = 0; s < 3; s++) {
        double fn0 = 2 * THREE_P * sqrt(0.5) / (1 + 0.5 * mobilised[s]), ft0 = 0.5 * mobilised[s] * fn0;
        double fn = fn0, ft = ft0;
        char name[40];
        snprintf(name, sizeof name, "m %g", mobilised[s]);
        struct chart_line *line = chart_add(&chart, name, 101);
        if (!line)
            return -1;
        chart_put(line, fn, ft);
        for (int k = 1; k <= 100; k++) {
            three_projections(THREE_P * (2 - 0.01 * k), 0.5, fn, ft, 0, &path);
            fn = path.fn[path.count], ft = path.ft[path.count];
            chart_put(line, fn, ft);
        }
        three_projections(THREE_P, 0.5, fn0, ft0, 0, &path);
        thesis_line(thesis, "m0 %5.2f: in steps fn %.3f ft %.3f, at once fn %.3f ft %.3f N", mobilised[s], fn, ft,
                    path.fn[path.count], path.ft[path.count]);
    }
    return thesis_picture(thesis, &chart, 1);
}

static int figure_2_27(struct thesis *thesis)
{
    static const double starts[][2] = {{600, 300}, {900, 100}, {200, -100}};
    struct chart chart = {
        .title = "2.27 projections and contact dynamics", .x_label = "iteration", .y_label = "|Fy| / P", .log_y = 1};
    for (int s = 0; s < 5; s++) {
        const double *start = starts[s < 3 ? s : s - 3];
        char name[40];
        double factor;
        if (s < 3)
            three_projections(THREE_P, 0.5, start[0], start[1], 0, &path);
        else
            three_dynamics(0.5, start[0], start[1], &path);
        snprintf(name, sizeof name, "%s (%g, %g)", s < 3 ? "qsm" : "cdm", start[0], start[1]);
        if (decay(&chart, name, &factor))
            return -1;
        thesis_line(thesis, "%-18s %3d iterations, %.4f an iteration", name, path.count, factor);
    }
    return thesis_picture(thesis, &chart, 1);
}

/* ---- how fast, from 1000 starts ---- */

static void solve(int projections, size_t k)
{
    double fn, ft;
    three_start(THREE_SPREAD, 0.5, k, &fn, &ft);
    if (projections)
        three_projections(THREE_P, 0.5, fn, ft, 0, &path);
    else
        three_dynamics(0.5, fn, ft, &path);
}

static int convergence(struct thesis *thesis, int projections)
{
    struct chart charts[] = {
        {.title = "iterations", .x_label = "Fy at the start / P", .y_label = "iterations", .from_zero = 1},
        {.title = "what is left", .x_label = "Fy at the start / P", .y_label = "Fy / P, 1e-16"}};
    struct chart_line *count = thesis_scatter(&charts[0], "", STARTS), *left = thesis_scatter(&charts[1], "", STARTS);
    int least = THREE_LIMIT, most = 0, at_once = 0, down = 0, slow = 0;
    if (!count || !left)
        return -1;
    for (size_t k = 0; k < STARTS; k++) {
        solve(projections, k);
        int its = path.count;
        thesis_point(count, path.fy[0] / THREE_P, its);
        thesis_point(left, path.fy[0] / THREE_P, 1e16 * path.fy[its] / THREE_P);
        least = its < least ? its : least, most = its > most ? its : most;
        at_once += its <= 2;
        slow += its > 2, down += its > 2 && path.fy[0] < 0;
    }
    thesis_line(thesis,
                "%d to %d iterations; %.1f %% of the starts end within 2; of the others %.0f %% began with Fy < 0",
                least, most, 100.0 * at_once / STARTS, slow ? 100.0 * down / slow : 0);
    return thesis_picture(thesis, charts, 2);
}

static int velocity(struct thesis *thesis, int projections)
{
    struct chart chart = {
        .title = "velocity of convergence", .x_label = "|Fy| at the start, N", .y_label = "N per iteration"};
    struct chart_line *line = thesis_scatter(&chart, "", STARTS);
    double xx = 0, xy = 0, n = 0, x_sum = 0, y_sum = 0, yy = 0;
    if (!line)
        return -1;
    for (size_t k = 0; k < STARTS; k++) {
        solve(projections, k);
        double from = fabs(path.fy[0]), v = (from - fabs(path.fy[path.count])) / fmax(1, path.count);
        thesis_point(line, from, v);
        if (path.count > 2)
            n++, x_sum += from, y_sum += v, xx += from * from, xy += from * v, yy += v * v;
    }
    double r = (xy - x_sum * y_sum / n) / sqrt((xx - x_sum * x_sum / n) * (yy - y_sum * y_sum / n));
    thesis_line(thesis,
                "velocity against |Fy| at the start, starts that take more than 2 iterations (%g): r = %.4f, %.4f "
                "per iteration",
                n, r, xy / xx);
    return thesis_picture(thesis, &chart, 1);
}

static int figure_2_20(struct thesis *thesis)
{
    return convergence(thesis, 0);
}

static int figure_2_21(struct thesis *thesis)
{
    return velocity(thesis, 0);
}

static int figure_2_28(struct thesis *thesis)
{
    return convergence(thesis, 1);
}

static int figure_2_29(struct thesis *thesis)
{
    return velocity(thesis, 1);
}

const struct figure FIGURES_THREE_PATHS[] = {{"2.14", "paths of molecular dynamics", figure_2_14},
                                             {"2.18", "paths of contact dynamics", figure_2_18},
                                             {"2.19", "convergence of contact dynamics", figure_2_19},
                                             {"2.20", "iterations of contact dynamics, 1000 starts", figure_2_20},
                                             {"2.21", "velocity of contact dynamics", figure_2_21},
                                             {"2.25", "paths of the projections, in both orders", figure_2_25},
                                             {"2.26", "projections in steps of the load", figure_2_26},
                                             {"2.27", "convergence of the projections", figure_2_27},
                                             {"2.28", "iterations of the projections, 1000 starts", figure_2_28},
                                             {"2.29", "velocity of the projections", figure_2_29},
                                             {NULL, NULL, NULL}};
