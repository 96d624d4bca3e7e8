/* report: matching, comparisons, exports and pictures of states that the test makes itself. */
#include "tests/check.h"
#include "tests/touch.h"

#include <cairo.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/scene/scene.h"
#include "pipeline/speak/error.h"
#include "report/compare/budget.h"
#include "pipeline/draw/canvas.h"
#include "pipeline/draw/chart.h"
#include "pipeline/packing/packing_file.h"
#include "report/compare/compare.h"
#include "report/states/distribution.h"
#include "report/export/export.h"
#include "report/export/export_series.h"
#include "report/pictures/movie.h"
#include "report/page/html.h"
#include "report/pictures/force_map.h"
#include "report/compare/match.h"
#include "report/page/page.h"
#include "report/pictures/photo_map.h"
#include "pipeline/files/json.h"

/* ---- matching ---- */

/* 900 points on a jittered lattice, shuffled and moved by up to 0.3 radii: the truth is the shuffle. */
static void test_match_shuffled(void **unused)
{
    (void)unused;
    enum { N = 900 };
    static double ax[N + 2], ay[N + 2], bx[N], by[N], radius[N];
    long shuffle[N], found[N + 2];
    uint64_t state = 7;
    for (int k = 0; k < N; k++) {
        bx[k] = 1000 + 20 * (k % 30) + 2 * check_uniform(&state);
        by[k] = -500 + 20 * (k / 30) + 2 * check_uniform(&state);
        radius[k] = 9;
        shuffle[k] = k;
    }
    for (int k = N - 1; k > 0; k--) {
        int other = (int)(check_uniform(&state) * (k + 1));
        long keep = shuffle[k];
        shuffle[k] = shuffle[other], shuffle[other] = keep;
    }
    for (int k = 0; k < N; k++) {
        ax[k] = bx[shuffle[k]] + 2.7 * (check_uniform(&state) - 0.5);
        ay[k] = by[shuffle[k]] + 2.7 * (check_uniform(&state) - 0.5);
    }
    ax[N] = NAN, ay[N] = 0;                     /* lost */
    ax[N + 1] = bx[5] + 4.4, ay[N + 1] = by[5]; /* a second circle on a grain that is already found */
    struct match_points a = {N + 2, ax, ay}, b = {N, bx, by};
    check_done(match_grains(&a, &b, radius, found));
    for (int k = 0; k < N; k++)
        assert_int_equal(found[k], shuffle[k]);
    assert_int_equal(found[N], -1);
    assert_int_equal(found[N + 1], -1);
}

static void test_match_edges(void **unused)
{
    (void)unused;
    const double x[] = {0, 1e9}, y[] = {0, -1e9}, r[] = {1, 1}, near[] = {0.49, 0.51, 1e9};
    const double zero[] = {0, 0, -1e9};
    long found[3];
    struct match_points a = {3, near, zero}, b = {2, x, y}, none = {0, x, y};
    check_done(match_grains(&a, &b, r, found)); /* far apart: few cells all the same */
    assert_int_equal(found[0], 0);
    assert_int_equal(found[1], -1); /* beyond half a radius */
    assert_int_equal(found[2], 1);
    check_done(match_grains(&a, &none, r, found));
    assert_int_equal(found[0], -1);
    check_done(match_grains(&none, &b, r, found));
}

/* Differences of such places are no numbers. */
static void test_match_absurd_places(void **unused)
{
    (void)unused;
    const double x[] = {-1.5e308, 1.5e308, 0, 7}, y[] = {1.5e308, 0, -1.5e308, 7}, r[] = {1, 1e308, 1, 1};
    long found[4];
    struct match_points points = {4, x, y};
    check_done(match_grains(&points, &points, r, found));
    for (int k = 0; k < 3; k++)
        assert_int_equal(found[k], -1);
    assert_int_equal(found[3], 3);
}

/* ---- photo side ---- */

enum { GRAINS_COUNT = 20 };

static void make_photo(struct photo_grains *grains, size_t rows)
{
    static const char *const names[] = {"x_px", "y_px",     "radius_px", "angle", "s_x",
                                        "s_y",  "s_radius", "s_angle",   "flags", NULL};
    check_done(table_alloc(&PHOTO_GRAINS, grains, rows, names));
    for (size_t k = 0; k < rows; k++) {
        grains->x_px[k] = 50 + 40 * (double)(k % 5);
        grains->y_px[k] = 50 + 40 * (double)(k / 5);
        grains->radius_px[k] = 18;
        grains->angle[k] = 0;
        grains->s_x[k] = grains->s_y[k] = 0.1;
        grains->s_radius[k] = 0.05;
        grains->s_angle[k] = 1e-3;
    }
}

/* A lacks row 3, has one circle too many and one flagged row far off; the others are off by (0.3, -0.4) and 0.1. */
static void test_compare_found(void **unused)
{
    (void)unused;
    struct photo_grains a, b;
    struct figures f = {.count = 0};
    make_photo(&a, GRAINS_COUNT);
    make_photo(&b, GRAINS_COUNT);
    for (int k = 0; k < GRAINS_COUNT; k++) {
        a.x_px[k] += 0.3, a.y_px[k] -= 0.4;
        a.radius_px[k] += 0.1;
    }
    a.x_px[3] = 1000; /* false, and row 3 of B missed */
    a.x_px[7] += 5;   /* found, but flagged: not in the errors */
    a.flags[7] = GRAIN_WEAK_EDGE;
    struct compare_photo pair = {.a = &a, .b = &b, .a_is_seen = 1};
    check_done(compare_photo(&pair, &f));
    check_near(figures_value(&f, "found"), 19, 0);
    check_near(figures_value(&f, "missed"), 1, 0);
    check_near(figures_value(&f, "false"), 1, 0);
    check_near(figures_value(&f, "flagged"), 1, 0);
    check_near(figures_value(&f, "compared"), 18, 0);
    check_near(figures_value(&f, "centre_rms_px"), 0.5 / sqrt(2), 1e-12);
    check_near(figures_value(&f, "centre_bias_x_px"), 0.3, 1e-12);
    check_near(figures_value(&f, "centre_bias_y_px"), -0.4, 1e-12);
    check_near(figures_value(&f, "centre_max_px"), 0.5, 1e-12);
    check_near(figures_value(&f, "centre_pull"), sqrt(0.125) / 0.1, 1e-9);
    check_near(figures_value(&f, "radius_bias_px"), 0.1, 1e-12);
    check_near(figures_value(&f, "radius_pull"), 2, 1e-9);
    assert_true(isnan(figures_value(&f, "displacement_rms_px")));
    table_free(&PHOTO_GRAINS, &a);
    table_free(&PHOTO_GRAINS, &b);
}

/* Grains turn by 30 degrees and move by (12, -7); A follows material 2 px beside the true centre without error, except
 * that all of A is off by 0.06 px to the right and 0.01 rad. */
static void test_compare_motion(void **unused)
{
    (void)unused;
    struct photo_grains a, b, a0, b0;
    struct figures f = {.count = 0};
    const double turn = M_PI / 6;
    make_photo(&a0, GRAINS_COUNT);
    make_photo(&b0, GRAINS_COUNT);
    make_photo(&a, GRAINS_COUNT);
    make_photo(&b, GRAINS_COUNT);
    for (int k = 0; k < GRAINS_COUNT; k++) {
        b.x_px[k] = b0.x_px[k] + 12, b.y_px[k] = b0.y_px[k] - 7;
        b0.angle[k] = 0.2, b.angle[k] = 0.2 + turn;
        a0.x_px[k] += 2; /* counter-clockwise as seen, y down: what is right of the centre goes up */
        a.x_px[k] = b.x_px[k] + 2 * cos(turn) + 0.06;
        a.y_px[k] = b.y_px[k] - 2 * sin(turn);
        a.angle[k] = turn + 0.01;
    }
    a.flags[0] = GRAIN_LOST;
    a.x_px[0] = NAN;
    struct compare_photo pair = {.a = &a, .b = &b, .a0 = &a0, .b0 = &b0};
    check_done(compare_photo(&pair, &f));
    check_near(figures_value(&f, "motion_compared"), 19, 0);
    check_near(figures_value(&f, "motion_flagged"), 1, 0);
    check_near(figures_value(&f, "displacement_rms_px"), 0.06 / sqrt(2), 1e-10);
    check_near(figures_value(&f, "displacement_bias_x_px"), 0.06, 1e-10);
    check_near(figures_value(&f, "displacement_bias_y_px"), 0, 1e-10);
    check_near(figures_value(&f, "rotation_rms_deg"), 0.01 * 180 / M_PI, 1e-10);
    check_near(figures_value(&f, "rotation_pull"), 10, 1e-9);
    a0.count--;
    assert_int_equal(compare_photo(&pair, &f), -1);
    a0.count++;
    table_free(&PHOTO_GRAINS, &a);
    table_free(&PHOTO_GRAINS, &b);
    table_free(&PHOTO_GRAINS, &a0);
    table_free(&PHOTO_GRAINS, &b0);
}

/* ---- SI side ---- */

/* A chain of four grains on a bottom wall: contacts 0-1, 1-2, 2-3 and 0-wall. */
static void make_chain(struct packing *p)
{
    memset(p, 0, sizeof *p);
    p->length_m = NAN;
    check_done(table_alloc(&GRAINS, &p->grains, 4, NULL));
    check_done(table_alloc(&WALLS, &p->walls, 1, NULL));
    check_done(table_alloc(&CONTACTS, &p->contacts, 4, NULL));
    for (int k = 0; k < 4; k++) {
        p->grains.x[k] = 0.02 * k, p->grains.y[k] = 0;
        p->grains.radius[k] = 0.01;
        p->contacts.i[k] = k < 3 ? k : 0, p->contacts.j[k] = k + 1;
        p->contacts.nx[k] = k < 3, p->contacts.ny[k] = k < 3 ? 0 : -1;
        p->contacts.x[k] = 0.02 * k + 0.01, p->contacts.y[k] = 0;
        p->contacts.overlap[k] = 1e-5;
    }
    p->contacts.x[3] = 0, p->contacts.y[3] = -0.01;
    strcpy(p->walls.name[0], "bottom");
    p->walls.x0[0] = -0.01, p->walls.x1[0] = 0.07, p->walls.y0[0] = p->walls.y1[0] = -0.01;
    p->walls.radius[0] = 0;
    p->forces = calloc(1, sizeof *p->forces);
    p->force_count = 1;
    strcpy(p->forces->method, "dem");
    check_done(table_alloc(&CONTACT_FORCES, &p->forces->contact, 4, NULL));
    for (int c = 0; c < 4; c++) {
        p->forces->contact.fn[c] = 10.0 * (c + 1);
        p->forces->contact.ft[c] = c;
    }
}

/* The same chain with its grains numbered from the other end: normals turn over, fn and ft stay. */
static void make_reversed(struct packing *p)
{
    make_chain(p);
    for (int k = 0; k < 4; k++) {
        p->grains.x[k] = 0.06 - 0.02 * k;
        p->contacts.i[k] = k < 3 ? 2 - k : 3, p->contacts.j[k] = k < 3 ? 3 - k : 4;
        p->contacts.nx[k] = k < 3 ? -1 : 0;
    }
    touch(p);
}

static void test_compare_renumbered(void **unused)
{
    (void)unused;
    struct packing a, b;
    struct figures f = {.count = 0};
    make_reversed(&a);
    make_chain(&b);
    check_done(compare_packings(&a, &b, NULL, "dem", &f));
    check_near(figures_value(&f, "contacts_common"), 4, 0);
    check_near(figures_value(&f, "contact_f1"), 1, 0);
    check_near(figures_value(&f, "r_fn"), 1, 1e-12);
    check_near(figures_value(&f, "r_ft"), 1, 1e-12);
    check_near(figures_value(&f, "dist_N"), 0, 1e-12);
    packing_free(&a);
    packing_free(&b);
}

/* A misses contact 1-2 (fn 20, ft 1), invents 1-3 (fn 6), lists 0-wall as a candidate only, and is off by (3, 4) at
 * 0-1. */
static void test_compare_lists(void **unused)
{
    (void)unused;
    struct packing a, b;
    struct figures f = {.count = 0};
    make_chain(&a);
    make_chain(&b);
    a.contacts.i[1] = 1, a.contacts.j[1] = 3;
    a.forces->contact.fn[1] = 6, a.forces->contact.ft[1] = 0;
    a.contacts.flags[3] = CONTACT_CANDIDATE;
    a.forces->contact.fn[0] += 3, a.forces->contact.ft[0] += 4;
    check_done(compare_packings(&a, &b, NULL, NULL, &f));
    check_near(figures_value(&f, "contacts_a"), 3, 0);
    check_near(figures_value(&f, "contacts_b"), 4, 0);
    check_near(figures_value(&f, "contacts_candidates"), 1, 0);
    check_near(figures_value(&f, "contact_precision"), 2.0 / 3, 1e-12);
    check_near(figures_value(&f, "contact_recall"), 0.5, 1e-12);
    check_near(figures_value(&f, "contact_f1"), 4.0 / 7, 1e-12);
    /* differences: 5 at 0-1, 0 at 2-3 and 0-wall, 6 at 1-3, hypot(20, 1) at 1-2 */
    check_near(figures_value(&f, "dist_N"), (5 + 6 + hypot(20, 1)) / 5, 1e-12);
    const double fa[] = {13, 30, 40}, fb[] = {10, 30, 40};
    check_near(figures_value(&f, "r_fn"), pearson(fa, fb, 3), 1e-12);
    assert_int_equal(compare_packings(&a, &b, "qsm", NULL, &f), -1);
    double *errors, sum = 0, largest = 0;
    size_t count;
    check_done(compare_force_errors(&a, &b, NULL, NULL, &errors, &count)); /* 3, 0, 0, 6, 20 over <fn> */
    assert_int_equal(count, 5);
    for (size_t k = 0; k < count; k++) {
        sum += errors[k];
        largest = fmax(largest, errors[k]);
    }
    check_near(sum, 29 / figures_value(&f, "mean_fn_b_N"), 1e-12);
    check_near(largest, 20 / figures_value(&f, "mean_fn_b_N"), 1e-12);
    free(errors);
    packing_free(&a);
    packing_free(&b);
}

/* By hand: x = 1 2 3 4, y = 2 1 4 3: r = 3/5. */
static void test_pearson(void **unused)
{
    (void)unused;
    const double x[] = {1, 2, 3, 4}, y[] = {2, 1, 4, 3}, flat[] = {5, 5, 5, 5}, minus[] = {8, 6, 4, 2};
    check_near(pearson(x, y, 4), 0.6, 1e-14);
    check_near(pearson(x, minus, 4), -1, 1e-14);
    assert_true(isnan(pearson(x, flat, 4)));
    assert_true(isnan(pearson(x, y, 1)));
}

/* ---- statistics ---- */

/* fn = 10 20 30 40: mean 25; fn / mean = 0.4 0.8 1.2 1.6 in bins 1, 3, 4 and 6, each a quarter over 0.25. */
static void test_distribution(void **unused)
{
    (void)unused;
    struct packing p;
    double density[DISTRIBUTION_BINS];
    make_chain(&p);
    assert_int_equal(force_distribution(p.forces, density), 4);
    for (int b = 0; b < DISTRIBUTION_BINS; b++)
        if (b == 1 || b == 3 || b == 4 || b == 6)
            check_near(density[b], 1, 1e-12);
        else
            assert_true(isnan(density[b]));
    p.forces->contact.fn[0] = 0; /* open, and one that is not known */
    p.forces->contact.fn[1] = NAN;
    assert_int_equal(force_distribution(p.forces, density), 2);
    check_near(density[3], 2, 1e-12); /* 30 / 35 */
    check_near(density[4], 2, 1e-12); /* 40 / 35 */
    packing_free(&p);
}

/* Three contacts along x, one of them turned to 61 degrees; the wall does not count. */
static void test_rose(void **unused)
{
    (void)unused;
    struct packing p;
    double share[ROSE_BINS], mean_fn[ROSE_BINS];
    make_chain(&p);
    p.contacts.nx[1] = cos(61 * M_PI / 180), p.contacts.ny[1] = sin(61 * M_PI / 180);
    p.contacts.nx[2] = -1; /* fn 10, 20, 30: mean 20 */
    contact_rose(&p, p.forces, share, mean_fn);
    for (int b = 0; b < ROSE_BINS; b++) {
        int along_x = b == 0 || b == 18, turned = b == 6 || b == 24;
        check_near(share[b], along_x ? 2 * 6 : turned ? 6 : 0, 1e-12); /* 6 directions in 36 bins: mean 1/6 */
        if (along_x || turned)
            check_near(mean_fn[b], 1, 1e-12); /* (10 + 30) / 2 and 20 */
        else
            assert_true(isnan(mean_fn[b]));
    }
    packing_free(&p);
}

/* A chart of nothing draws nothing; logarithmic axes leave out what is not positive. */
static void test_chart(void **unused)
{
    (void)unused;
    struct canvas canvas;
    unsigned char *svg;
    size_t length;
    struct chart chart = {.title = "t", .x_label = "x", .y_label = "y", .log_y = 1};
    struct chart_line *line = chart_add(&chart, "a", 4);
    assert_non_null(line);
    assert_true(chart_is_empty(&chart));
    chart_put(line, 1, -1);
    chart_put(line, NAN, 1);
    assert_true(chart_is_empty(&chart));
    chart_put(line, 1, 1);
    assert_false(chart_is_empty(&chart));
    check_done(canvas_begin_memory(&canvas, CANVAS_SVG, 300, 200)); /* one point: axes of some length all the same */
    chart_draw(&chart, &canvas, 300, 200);
    check_done(canvas_take(&canvas, &svg, &length));
    assert_int_equal(memcmp(svg, "<?xml", 5), 0);
    free(svg);
    chart.log_y = 0;
    chart_put(line, 1 - 0x1p-53, 1 - 0x1p-53); /* one rounding away: still as many ticks as for one point, not 10^9 */
    line->y[0] = NAN;
    check_done(canvas_begin_memory(&canvas, CANVAS_SVG, 300, 200));
    chart_draw(&chart, &canvas, 300, 200);
    check_done(canvas_take(&canvas, &svg, &length));
    check_at_most((double)length, 1e5);
    free(svg);
    chart_free(&chart);
    chart_free(&chart);
}

/* ---- text ---- */

static char *text_of(int (*write)(const struct loaded *, FILE *), const struct loaded *loaded)
{
    char *text = NULL;
    size_t length;
    FILE *stream = open_memstream(&text, &length);
    check_done(write(loaded, stream));
    fclose(stream);
    return text;
}

static int contacts_as_csv(const struct loaded *loaded, FILE *stream)
{
    return export_csv(loaded, "contacts", stream);
}

static void test_csv(void **unused)
{
    (void)unused;
    struct loaded loaded = {.path = strdup("a.hdf"), .is_si = 1};
    make_chain(&loaded.packing);
    loaded.packing.contacts.un[0] = 1.0 / 3;
    loaded.packing.contacts.flags[1] = CONTACT_NEW | CONTACT_WALL;
    char *text = text_of(contacts_as_csv, &loaded), *rest, *line = strtok_r(text, "\n", &rest);
    assert_non_null(strstr(line, "i [1],j [1],nx [1],"));
    assert_non_null(strstr(line, "un [m],"));
    assert_non_null(strstr(line, "flags [1],flag_names,dem_fn [N],dem_ft [N],"));
    line = strtok_r(NULL, "\n", &rest);
    assert_non_null(strstr(line, "0,1,1,0,0.01,0,"));
    assert_non_null(strstr(line, ",0.33333333333333331,,")); /* every digit; a missing ut is an empty cell */
    line = strtok_r(NULL, "\n", &rest);
    assert_non_null(strstr(line, ",589824,new|wall,20,1,"));
    free(text);
    loaded_free(&loaded);
}

/* However many methods a file has, none is left out. */
static void test_csv_of_many_methods(void **unused)
{
    (void)unused;
    enum { METHODS = 40 };
    struct loaded loaded = {.path = strdup("a.hdf"), .is_si = 1};
    struct packing *packing = &loaded.packing;
    make_chain(packing);
    packing->forces = realloc(packing->forces, METHODS * sizeof *packing->forces);
    memset(packing->forces + 1, 0, (METHODS - 1) * sizeof *packing->forces);
    packing->force_count = METHODS;
    for (int f = 1; f < METHODS; f++) {
        check_done(table_alloc(&CONTACT_FORCES, &packing->forces[f].contact, packing->contacts.count, NULL));
        snprintf(packing->forces[f].method, NAME_LENGTH, "m%d", f);
    }
    char *text = text_of(contacts_as_csv, &loaded);
    assert_non_null(strstr(text, ",m15_fn [N],"));
    assert_non_null(strstr(text, ",m39_fn [N],"));
    free(text);
    loaded_free(&loaded);
}

static int walls_as_csv(const struct loaded *loaded, FILE *stream)
{
    return export_csv(loaded, "walls", stream);
}

/* Names come from files: none ends its cell, and none is a formula to a spreadsheet. */
static void test_csv_names(void **unused)
{
    (void)unused;
    struct loaded loaded = {.path = strdup("a.hdf"), .is_si = 1};
    make_chain(&loaded.packing);
    strcpy(loaded.packing.forces[0].method, "=a\",b");
    char *text = text_of(contacts_as_csv, &loaded);
    assert_non_null(strstr(text, "flags [1],flag_names,_a__b_fn [N],_a__b_ft [N],"));
    free(text);
    static const char *const names[] = {"=1+1", "+1", "-1", "@x", "a\"b,c"};
    static const char *const cells[] = {"\"'=1+1\",", "\"'+1\",", "\"'-1\",", "\"'@x\",", "\"a\"\"b,c\","};
    for (int k = 0; k < 5; k++) {
        strcpy(loaded.packing.walls.name[0], names[k]);
        text = text_of(walls_as_csv, &loaded);
        assert_int_equal(strncmp(text + strcspn(text, "\n") + 1, cells[k], strlen(cells[k])), 0);
        free(text);
    }
    loaded_free(&loaded);
}

/* A grain at (100.4, 50.7) that turned by 90 degrees and did not move: the material at (100, 51) goes round it. */
static void test_dic(void **unused)
{
    (void)unused;
    struct loaded loaded = {.path = strdup("a.hdf")};
    double rx, ry, rot, radius, dx, dy, angle;
    check_done(table_alloc(&PHOTO_GRAINS, &loaded.grains, 1, NULL));
    loaded.grains.x_px[0] = loaded.grains.x_ref_px[0] = 100.4;
    loaded.grains.y_px[0] = loaded.grains.y_ref_px[0] = 50.7;
    loaded.grains.radius_px[0] = 20;
    loaded.grains.angle[0] = M_PI / 2;
    char *text = text_of(export_dic, &loaded);
    assert_int_equal(sscanf(text, "1 %lf %lf %lf %lf %lf %lf %lf", &rx, &ry, &rot, &radius, &dx, &dy, &angle), 7);
    check_near(rx, 100, 0);
    check_near(ry, 51, 0);
    check_near(100 + dx, 100.4 + 0.3, 1e-12); /* it was 0.3 below the centre: now 0.3 to its right */
    check_near(51 + dy, 50.7 + 0.4, 1e-12);   /* it was 0.4 to the left: now 0.4 below */
    check_near(angle, M_PI / 2, 1e-14);
    free(text);
    loaded_free(&loaded);
}

static void test_other_exports(void **unused)
{
    (void)unused;
    struct loaded loaded = {.path = strdup("a.hdf"), .is_si = 1};
    make_chain(&loaded.packing);
    char *text = text_of(export_xyz, &loaded);
    assert_int_equal(strncmp(text, "4\nProperties=id:I:1:pos:R:3:radius:R:1:", 38), 0);
    free(text);
    text = text_of(export_conf, &loaded);
    assert_int_equal(strncmp(text, "4\n0.000000000000000e+00 ", 24), 0);
    free(text);
    loaded.packing.info.strain[0] = loaded.packing.info.strain[2] = NAN; /* not known: not 0 */
    loaded.packing.info.strain[1] = 0.25;
    free(loaded.packing.grains.angle);
    loaded.packing.grains.angle = NULL;
    text = text_of(export_conf, &loaded);
    assert_non_null(strstr(text, " nan 1 1\n"));
    assert_non_null(strstr(text, "\nnan -2.500000000000000e-01 nan 0 nan -2.500000000000000e-01 nan nan nan\n"));
    free(text);
    loaded_free(&loaded);
    struct loaded photo = {.path = strdup("b.hdf")};
    assert_int_equal(export_conf(&photo, stdout), -1);
    assert_int_equal(export_dic(&photo, stdout), -1);
    assert_int_equal(export_csv(&photo, "walls", stdout), -1);
    loaded_free(&photo);
}

static int as_bonds(const struct loaded *loaded, FILE *stream)
{
    return export_lammps_local(loaded, "dem", stream);
}

static void test_lammps(void **unused)
{
    (void)unused;
    struct loaded loaded = {.path = strdup("a.hdf"), .is_si = 1};
    make_chain(&loaded.packing);
    loaded.packing.info.index = 7;
    char *text = text_of(export_lammps, &loaded);
    assert_int_equal(strncmp(text, "ITEM: TIMESTEP\n7\nITEM: NUMBER OF ATOMS\n4\nITEM: BOX BOUNDS ff ff ff\n-0.01", 72),
                     0);
    assert_non_null(strstr(text, "ITEM: ATOMS id type x y z radius angle flags\n0 1 0 0 0 0.01 "));
    free(text);
    text = text_of(as_bonds, &loaded); /* three bonds; the wall contact is not one */
    assert_non_null(strstr(text, "ITEM: NUMBER OF ENTRIES\n3\n"));
    assert_non_null(strstr(text, "\n1 1 2 1.0000000000000001e-05 20 1\n"));
    free(text);
    assert_int_equal(export_lammps_local(&loaded, "qsm", stdout), -1);
    loaded_free(&loaded);
}

/* ---- pictures and pages ---- */

static void write_chain(const char *path, int64_t index, double shift)
{
    struct packing p;
    struct provenance provenance = PROVENANCE_DEFAULT;
    make_chain(&p);
    for (int k = 0; k < 4; k++) {
        p.grains.mass[k] = p.grains.inertia[k] = 1;
        p.grains.x[k] += shift;
    }
    touch(&p);
    p.forces->iterations = 77;
    p.forces->infeasible = 1;
    p.forces->imbalance = 0.81;
    p.forces->data_misfit = 2.5;
    provenance.stage = "forces";
    provenance.index = index;
    provenance.time_s = 10 - (double)index; /* not the order of the names */
    check_done(packing_write(path, &p, &provenance));
    packing_free(&p);
}

static void png_size(const char *path, unsigned size[2])
{
    unsigned char head[24];
    FILE *stream = fopen(path, "rb");
    assert_non_null(stream);
    assert_int_equal(fread(head, 1, sizeof head, stream), sizeof head);
    fclose(stream);
    for (int k = 0; k < 2; k++)
        size[k] = (unsigned)head[16 + 4 * k] << 24 | (unsigned)head[17 + 4 * k] << 16 |
                  (unsigned)head[18 + 4 * k] << 8 | head[19 + 4 * k];
}

static long json_allocations; /* until the one that fails */

static void *json_malloc(size_t size)
{
    return json_allocations-- == 0 ? NULL : malloc(size);
}

/* cJSON has no memory left after some allocations: the list is whole, or it is refused. */
static void check_lists_without_memory(char *const paths[], const char *output)
{
    cJSON_Hooks failing = {json_malloc, free};
    cJSON_InitHooks(&failing);
    int refused = 0, whole = 0;
    for (long k = 0; k < 60; k++) {
        char *text = NULL;
        size_t length = 0;
        FILE *stream = open_memstream(&text, &length);
        json_allocations = k;
        int status = export_hdf_series(paths, 2, output, stream);
        fclose(stream);
        refused += status != 0;
        whole += status == 0;
        assert_true(status || (strstr(text, "\"0001.forces.hdf\",\"time\":9}") &&
                               strstr(text, "\"0000.forces.hdf\",\"time\":10}") && strstr(text, "\"1.0\"")));
        free(text);
        error_clear();
    }
    cJSON_InitHooks(NULL);
    assert_true(refused > 5 && whole > 5);
}

/* Frames share one view, so that they have one size although the packing moves; the series is sorted by time. */
static void test_film_and_series(void **unused)
{
    (void)unused;
    char folder[] = "/tmp/test_report.XXXXXX", path[2][64], frames[64], output[64], frame[80], *text = NULL;
    unsigned size[2][2];
    size_t length;
    assert_non_null(mkdtemp(folder));
    for (int k = 0; k < 2; k++) {
        snprintf(path[k], sizeof path[k], "%s/%04d.forces.hdf", folder, k);
        write_chain(path[k], k, 0.03 * k);
    }
    char *paths[] = {path[0], path[1]};
    struct movie film = {.width = 300};
    snprintf(frames, sizeof frames, "%s/frames", folder);
    check_done(movie_write(&film, paths, 2, frames));
    for (int k = 0; k < 2; k++) {
        snprintf(frame, sizeof frame, "%s/%04d.png", frames, k);
        png_size(frame, size[k]);
        remove(frame);
    }
    assert_int_equal(size[0][0], 300);
    assert_memory_equal(size[0], size[1], sizeof size[0]);

    snprintf(output, sizeof output, "%s/all.hdf.series", folder);
    FILE *stream = open_memstream(&text, &length);
    check_done(export_hdf_series(paths, 2, output, stream));
    check_lists_without_memory(paths, output);
    assert_int_equal(export_hdf_series(paths, 2, "elsewhere/all.hdf.series", stream), -1);
    fclose(stream);
    assert_non_null(
        strstr(text, "[{\"name\":\"0001.forces.hdf\",\"time\":9},{\"name\":\"0000.forces.hdf\",\"time\":10}]"));
    free(text);
    remove(frames);
    film.width = 1e9; /* no picture is so wide: nothing is left behind */
    assert_int_equal(movie_write(&film, paths, 2, frames), -1);
    assert_int_equal(remove(frames), -1);
    remove(path[0]), remove(path[1]), remove(folder);
}

/* Round numbers: P L = 1e3 N/m, d = 0.01 m, z phi = pi: <fn> = 10 N; kn = 1e6: overlap 1e-5 m; 1e-4 m/px: 0.1 px. */
static void test_budget(void **unused)
{
    (void)unused;
    struct figures f = {.count = 0};
    struct budget b = BUDGET_DEFAULT;
    b.pressure = 1e5, b.length = 0.01, b.diameter = 0.01, b.z = M_PI, b.solid = 1, b.kn = 1e6, b.scale = 1e-4;
    b.s_centre = 0.03, b.s_radius = 0.04, b.s_motion = 0.01;
    budget_figures(&b, &f);
    check_near(figures_value(&f, "kappa"), 1000, 1e-9);
    check_near(figures_value(&f, "mean_fn_N"), 10, 1e-12);
    check_near(figures_value(&f, "mean_overlap_px"), 0.1, 1e-12);
    check_near(figures_value(&f, "s_overlap_px"), 0.05 * sqrt(2), 1e-12);
    check_near(figures_value(&f, "overlap_force_error"), sqrt(0.5), 1e-12);
    check_near(figures_value(&f, "mean_contact_missed"), 0.0786496035, 1e-9); /* normal tail beyond sqrt 2 */
    check_near(figures_value(&f, "change_force_error"), 0.1 * sqrt(2), 1e-12);
    check_near(figures_value(&f, "pressure_for_10_percent_Pa"), 1e5 * sqrt(50), 1e-3);
}

static const uint32_t BLUE = 0x0072B2;

static uint32_t pixel(const struct canvas *canvas, double x, double y)
{
    const unsigned char *data = cairo_image_surface_get_data(canvas->surface);
    int stride = cairo_image_surface_get_stride(canvas->surface);
    uint32_t value;
    memcpy(&value, data + (size_t)y * (size_t)stride + 4 * (size_t)x, 4);
    return value & 0xFFFFFF;
}

/* How many pixels of the column x are in the colour of a sticking contact. */
static int blue_in_column(const struct canvas *canvas, const struct force_map *map, double x)
{
    int count = 0;
    for (int y = 0; y < (int)map->view_height; y++)
        count += pixel(canvas, x, y) == BLUE;
    return count;
}

/* Lines run between centres and are as wide as the force: 10, 20, 30 N in steps of one width. */
static void test_map_widths(void **unused)
{
    (void)unused;
    struct packing p;
    struct canvas canvas;
    int width[3];
    make_chain(&p);
    for (int c = 0; c < 4; c++)
        p.forces->contact.ft[c] = 0;
    struct force_map map = {.packing = &p, .forces = p.forces, .width = 1600, .mean_fn = 25, .title = "a"};
    check_done(force_map_measure(&map));
    check_done(canvas_begin_memory(&canvas, CANVAS_PNG, map.width, map.height));
    check_done(force_map_draw(&map, &canvas));
    cairo_surface_flush(canvas.surface);
    for (int c = 0; c < 3; c++)
        width[c] = blue_in_column(&canvas, &map, map.scale * (0.02 * c + 0.01 - map.x0));
    double unit = 0.22 * 0.01 * map.scale * 10 / 25; /* px of 10 N */
    for (int c = 0; c < 3; c++)
        check_near(width[c], unit * (c + 1), 2); /* the edges' pixels are blends */
    canvas_discard(&canvas);
    packing_free(&p);
}

/* Rims where the grains are seen: the trusted one sky blue, the flagged one purple; the arrow of the trusted one ends
 * where its stretched motion does, the flagged one has none. */
static void test_photo_map(void **unused)
{
    (void)unused;
    static const char *const names[] = {"x_px", "y_px", "radius_px", "x_ref_px", "y_ref_px", "flags", NULL};
    struct photo_grains g;
    struct canvas canvas;
    int arrow_end = 0;
    check_done(table_alloc(&PHOTO_GRAINS, &g, 3, names));
    g.x_px[0] = 100, g.y_px[0] = 100, g.radius_px[0] = 40, g.x_ref_px[0] = 97, g.y_ref_px[0] = 100;
    g.x_px[1] = 300, g.y_px[1] = 100, g.radius_px[1] = 40, g.x_ref_px[1] = 290, g.y_ref_px[1] = 100;
    g.flags[1] = GRAIN_LOW_ZNCC;
    g.flags[2] = GRAIN_LOST; /* has no place */
    struct photo_map map = {.grains = &g, .width = 1000, .arrows = NAN};
    check_done(photo_map_measure(&map));
    check_near(map.arrows, 20, 1e-9); /* 3 px become at most 80 px: 26, rounded down */
    check_done(canvas_begin_memory(&canvas, CANVAS_PNG, map.width, map.height));
    check_done(photo_map_draw(&map, &canvas));
    cairo_surface_flush(canvas.surface);
    double y = map.scale * (100 - map.y0);
    assert_int_equal(pixel(&canvas, map.scale * (60 - map.x0), y), 0x56B4E9);
    assert_int_equal(pixel(&canvas, map.scale * (340 - map.x0), y), 0xCC79A7);
    for (double x = 0; x < map.width; x++)
        if (pixel(&canvas, x, y) == 0xD55E00)
            arrow_end = (int)x;
    check_near(arrow_end, map.scale * (160 - map.x0), 6); /* 100 + 20 * 3, less the thin tip */
    canvas_discard(&canvas);
    table_free(&PHOTO_GRAINS, &g);
    struct photo_map nothing = {.grains = &g, .width = 100, .arrows = NAN};
    assert_int_equal(photo_map_measure(&nothing), -1);
}

static void test_map_nothing(void **unused)
{
    (void)unused;
    struct packing p = {.length_m = NAN};
    struct force_map map = {.packing = &p, .width = 400};
    assert_int_equal(force_map_measure(&map), -1);
    assert_int_equal(error_status(), EXIT_INPUT);
}

/* Base64 of RFC 4648, section 10; nothing from outside becomes markup. */
static void test_html(void **unused)
{
    (void)unused;
    struct html html;
    check_done(html_begin(&html));
    html_picture(&html, "image/png", (const unsigned char *)"fooba", 5, "<script>'\"&\n");
    html_number(&html, NAN, 3);
    html_number(&html, -0.0, 3);
    check_done(html_end(&html));
    assert_non_null(strstr(html.text, "base64,Zm9vYmE=\""));
    assert_non_null(strstr(html.text, "&lt;script&gt;&#39;&quot;&amp;"));
    assert_null(strstr(html.text, "<script"));
    assert_non_null(strstr(html.text, "<td>–</td><td>0</td>"));
    html_free(&html);
    html_free(&html);
}

/* A series of one state with a method that did not converge, and a name that must not become markup. */
static void test_page(void **unused)
{
    (void)unused;
    char folder[] = "/tmp/test_report.XXXXXX", path[64];
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/0000.forces.hdf", folder);
    write_chain(path, 0, 0);
    char *paths[] = {path};
    struct series series;
    struct html html;
    struct scene scene = {.name = "a <b> & c"};
    struct page page = {.scene = &scene, .maps = 1};
    check_done(series_read(paths, 1, &series));
    check_done(html_begin(&html));
    check_done(page_write(&page, &series, &html));
    check_done(html_end(&html));
    assert_non_null(strstr(html.text, "<title>a &lt;b&gt; &amp; c</title>"));
    assert_non_null(strstr(html.text, "dem: in 1 of 1 states it did not converge (worst 77 iterations, 0000)"));
    assert_non_null(strstr(html.text, "a contact must have been missed"));
    assert_non_null(strstr(html.text, "unbalanced (worst 0.81, 0000)"));
    assert_non_null(strstr(html.text, "misfit above 1.5 (worst 2.5, 0000)"));
    assert_non_null(strstr(html.text, "src=\"data:image/png;base64,"));
    assert_null(strstr(html.text, "<script"));
    assert_null(strstr(html.text, "http:"));
    assert_null(strstr(html.text, "https:"));
    html_free(&html);
    series_free(&series);
    remove(path);
    remove(folder);
}

/* A file's name is no address: it neither runs as a script nor leads elsewhere. Nothing is loaded from anywhere. */
static void test_page_links(void **unused)
{
    (void)unused;
    char folder[] = "/tmp/test_report.XXXXXX", path[100], beside[40];
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/javascript:alert(1);'\xE9%%41.forces.hdf", folder);
    snprintf(beside, sizeof beside, "%s/", folder);
    write_chain(path, 0, 0);
    char *paths[] = {path};
    struct series series;
    struct html html;
    struct scene scene = {.name = "names"};
    struct page page = {.scene = &scene, .maps = 1, .folder = beside};
    check_done(series_read(paths, 1, &series));
    check_done(html_begin(&html));
    check_done(page_write(&page, &series, &html)); /* the picture's title holds the name, which is no UTF-8 */
    check_done(html_end(&html));
    assert_non_null(strstr(html.text, "<a href=\"./javascript%3Aalert%281%29%3B%27%E9%2541.forces.hdf\">"));
    assert_null(strstr(html.text, "href=\"j"));
    assert_non_null(strstr(html.text, "Content-Security-Policy\" content=\"default-src 'none'; img-src data:"));
    html_free(&html);
    series_free(&series);
    remove(path);
    remove(folder);
}

/* A photo out of order by the camera's clock, one without a time between, and a copy under another name. */
static void test_page_order(void **unused)
{
    (void)unused;
    struct series_row rows[] = {{.name = "0000", .index = 0, .taken = "2018:05:17 14:00:00"},
                                {.name = "0001", .index = 1},
                                {.name = "0002", .index = 2, .taken = "2018:05:17 13:59:59"},
                                {.name = "0003", .index = 3, .taken = "2018:05:17 14:00:05"}};
    struct series_input inputs[] = {{"0003.tracks.hdf", "0003.tif", "b7"},
                                    {"0000.tracks.hdf", "0000.tif", "a1"},
                                    {"0001.tracks.hdf", "0000.tif", "a1"},
                                    {"0002.tracks.hdf", "0002.tif", "b7"}};
    struct series series = {.rows = rows, .count = 4, .inputs = inputs, .input_count = 4};
    const struct scene scene = {0};
    struct html html;
    check_done(html_begin(&html));
    check_done(page_warnings(&scene, &series, &html));
    check_done(html_end(&html));
    assert_non_null(strstr(html.text, "photo 0002 was taken at 2018:05:17 13:59:59, before photo 0000"));
    assert_null(strstr(html.text, "photo 0003 was"));
    assert_non_null(strstr(html.text, "0002.tif and 0003.tif have the same content"));
    assert_null(strstr(html.text, "0000.tif and"));
    html_free(&html);
}

/* What is skipped is named first, once, and is no gap; what is missing without a word is one. */
static void test_gaps_are_named(void **unused)
{
    (void)unused;
    struct series_row rows[] = {{.name = "0001", .index = 1},
                                {.name = "0003", .index = 3},
                                {.name = "0007", .index = 7},
                                {.name = "0009", .index = 9}};
    struct series series = {.rows = rows, .count = 4};
    long skip[] = {2, 4, 10};
    struct scene scene = {.photos = {.first = 1, .last = 10, .skip = skip, .skip_count = 1}};
    struct html html;
    for (size_t count = 1; count <= 3; count += 2) {
        scene.photos.skip_count = count;
        check_done(html_begin(&html));
        check_done(page_warnings(&scene, &series, &html));
        check_done(html_end(&html));
        const char *first = strstr(html.text, "<li>");
        assert_non_null(first);
        const char *expected = count == 1 ? "<li>photo 0002 is skipped (photos.skip)"
                                          : "<li>photos 0002, 0004, 0010 are skipped (photos.skip)";
        assert_int_equal(strncmp(first, expected, strlen(expected)), 0);
        assert_null(strstr(first + strlen("<li>photos 0002"), "0002"));
        assert_non_null(
            strstr(first, count == 1 ? "photos 0004 to 0006 are missing" : "photos 0005 to 0006 are missing"));
        assert_non_null(strstr(first, "photo 0008 is missing"));
        html_free(&html);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_gaps_are_named),
        cmocka_unit_test(test_match_shuffled),
        cmocka_unit_test(test_match_edges),
        cmocka_unit_test(test_match_absurd_places),
        cmocka_unit_test(test_compare_found),
        cmocka_unit_test(test_compare_motion),
        cmocka_unit_test(test_compare_lists),
        cmocka_unit_test(test_compare_renumbered),
        cmocka_unit_test(test_pearson),
        cmocka_unit_test(test_csv),
        cmocka_unit_test(test_csv_names),
        cmocka_unit_test(test_csv_of_many_methods),
        cmocka_unit_test(test_dic),
        cmocka_unit_test(test_other_exports),
        cmocka_unit_test(test_map_widths),
        cmocka_unit_test(test_map_nothing),
        cmocka_unit_test(test_photo_map),
        cmocka_unit_test(test_html),
        cmocka_unit_test(test_lammps),
        cmocka_unit_test(test_film_and_series),
        cmocka_unit_test(test_budget),
        cmocka_unit_test(test_distribution),
        cmocka_unit_test(test_rose),
        cmocka_unit_test(test_chart),
        cmocka_unit_test(test_page),
        cmocka_unit_test(test_page_order),
        cmocka_unit_test(test_page_links),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    canvas_forget_fonts();
    return failed;
}
