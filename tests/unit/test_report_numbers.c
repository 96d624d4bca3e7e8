/* Numbers and curves of the page that are made in report/ itself: quantiles, the degree of indeterminacy, and when a
 * test is an oedometer. Known by counting. */
#include "tests/rank_by_hand.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "pipeline/draw/pen.h"
#include "report/compare/figures.h"
#include "report/pictures/histogram.h"
#include "report/states/indeterminacy.h"
#include "report/page/page.h"
#include "report/pictures/page_picture.h"
#include "pipeline/numbers/quantiles.h"
#include "pipeline/packing/packing_file.h"

static char folder[] = "/tmp/test_report_numbers.XXXXXX";

static void test_quantiles(void **unused)
{
    (void)unused;
    double column[21];
    uint32_t flags[21] = {0};
    struct quantiles q;
    for (int k = 0; k < 21; k++)
        column[k] = (k * 8) % 21; /* 0 to 20, shuffled */
    check_done(quantiles_of(column, flags, GRAIN_DISTRUST, 21, &q));
    check_near(q.least, 0, 0);
    check_near(q.low, 1, 1e-12);
    check_near(q.middle, 10, 1e-12);
    check_near(q.high, 19, 1e-12);
    check_near(q.most, 20, 0);
    for (int k = 0; k < 21; k++)
        if (column[k] > 10)
            flags[k] = GRAIN_LOW_ZNCC;
        else if (column[k] == 0)
            column[k] = NAN;
    check_done(quantiles_of(column, flags, GRAIN_DISTRUST, 21, &q)); /* 1 to 10 are left */
    check_near(q.least, 1, 0);
    check_near(q.middle, 5.5, 1e-12);
    check_near(q.most, 10, 0);
    check_done(quantiles_of(NULL, flags, GRAIN_DISTRUST, 21, &q));
    assert_true(isnan(q.middle));
}

/* Two grains one above the other between four walls, a third one that carries nothing: contacts 0-1, 0-bottom, 1-top,
 * 0-left, 1-right, and a candidate 0-2. */
static void make_packing(struct packing *p, const double strain[2], double sxx, double syy)
{
    static const int64_t i[] = {0, 0, 1, 0, 1, 0}, j[] = {1, 3, 4, 5, 6, 2};
    static const double nx[] = {0, 0, 0, -1, 1, 1}, ny[] = {1, -1, 1, 0, 0, 0};
    static const char *const names[] = {"bottom", "top", "left", "right"};
    static const double walls[4][4] = {{-1, 0, 1, 0}, {1, 4, -1, 4}, {-1, 4, -1, 0}, {1, 0, 1, 4}};
    memset(p, 0, sizeof *p);
    p->length_m = NAN;
    memcpy(p->info.strain, (double[3]){strain[0], strain[1], 0}, sizeof p->info.strain);
    check_done(table_alloc(&GRAINS, &p->grains, 3, NULL));
    check_done(table_alloc(&WALLS, &p->walls, 4, NULL));
    check_done(table_alloc(&CONTACTS, &p->contacts, 6, NULL));
    for (int k = 0; k < 3; k++) {
        p->grains.x[k] = 3 * (k == 2), p->grains.y[k] = 1 + 2 * (k == 1), p->grains.radius[k] = 1;
        p->grains.mass[k] = p->grains.inertia[k] = 1;
        p->grains.flags[k] = k == 2 ? GRAIN_RATTLER : 0;
    }
    for (int w = 0; w < 4; w++) {
        strcpy(p->walls.name[w], names[w]);
        p->walls.x0[w] = walls[w][0], p->walls.y0[w] = walls[w][1];
        p->walls.x1[w] = walls[w][2], p->walls.y1[w] = walls[w][3], p->walls.radius[w] = 0;
    }
    p->walls.fy[1] = -2 * syy, p->walls.fx[3] = -4 * sxx; /* the right and the top wall are loaded */
    for (int c = 0; c < 6; c++) {
        p->contacts.i[c] = i[c], p->contacts.j[c] = j[c], p->contacts.nx[c] = nx[c], p->contacts.ny[c] = ny[c];
        double arm = c == 5 ? 1.5 : 1; /* to the middle of the overlap, or of the gap */
        p->contacts.x[c] = p->grains.x[i[c]] + arm * nx[c], p->contacts.y[c] = p->grains.y[i[c]] + arm * ny[c];
        p->contacts.overlap[c] = c == 5 ? 2 - hypot(3, 0) : 0;
        p->contacts.flags[c] = c == 5 ? CONTACT_CANDIDATE : 0;
    }
    p->forces = calloc(1, sizeof *p->forces);
    p->force_count = 1;
    strcpy(p->forces->method, "qsm");
    p->forces->mu = 0.5, p->forces->converged = 1;
    check_done(table_alloc(&CONTACT_FORCES, &p->forces->contact, 6, NULL));
    check_done(table_alloc(&RESIDUALS, &p->forces->residual, 3, NULL));
    for (int c = 0; c < 6; c++)
        p->forces->contact.fn[c] = c < 3 ? 2 * syy : 2 * sxx, p->forces->contact.ft[c] = 0;
    for (int k = 0; k < 3; k++)
        p->forces->residual.residual_x[k] = p->forces->residual.residual_y[k] = 0.01 * k;
}

static double h_of(const struct packing *packing, const struct forces *forces)
{
    double h;
    check_done(indeterminacy(packing, forces, &h));
    return h;
}

/* By the rank of the equations, where walls are smooth when no force says otherwise; what the file says comes first. */
static void test_indeterminacy(void **unused)
{
    (void)unused;
    struct packing p;
    double equations;
    make_packing(&p, (double[2]){0, 0}, 1, 1);
    check_near(h_of(&p, p.forces), h_by_hand(&p, 0.5, 0, &equations), 0);
    check_near(h_of(&p, NULL), h_by_hand(&p, 0.5, 0.5, &equations), 0);
    assert_true(h_of(&p, NULL) > h_of(&p, p.forces));
    p.forces->contact.ft[1] = 0.1; /* the bottom is rough */
    check_near(h_of(&p, p.forces), h_by_hand(&p, 0.5, 0.5, &equations), 0);
    p.forces->contact.ft[1] = 0, p.forces->mu = 0;
    check_near(h_of(&p, p.forces), h_by_hand(&p, 0, 0, &equations), 0);
    p.walls.fx[2] = 4; /* left and right loaded: one of them reacts */
    check_near(h_of(&p, p.forces), h_by_hand(&p, 0, 0, &equations), 0);
    p.grains.flags[1] = GRAIN_FIXED;
    check_near(h_of(&p, p.forces), h_by_hand(&p, 0, 0, &equations), 0);
    p.indeterminacy = (struct indeterminacy){1, 17, 3};
    check_near(h_of(&p, p.forces), 17, 0);
    packing_free(&p);
}

/* The page of two states, the second one strained by that much. */
static char *page_of(double across, double along)
{
    char paths[2][256], *list[2] = {paths[0], paths[1]};
    struct series series;
    struct html html;
    struct scene scene = {.name = "two states"};
    struct page page = {.scene = &scene, .maps = 0, .folder = NULL};
    for (int k = 0; k < 2; k++) {
        struct packing p;
        struct provenance provenance = PROVENANCE_DEFAULT;
        snprintf(paths[k], sizeof paths[k], "%s/%04d.forces.hdf", folder, k);
        make_packing(&p, (double[2]){k * across, k * along}, 1, 2 + k);
        provenance.stage = "forces";
        provenance.index = k;
        memcpy(provenance.strain, p.info.strain, sizeof provenance.strain);
        check_done(packing_write(paths[k], &p, &provenance));
        packing_free(&p);
    }
    check_done(series_read(list, 2, &series));
    check_near(series.rows[1].packing.applied[0][0], 1, 1e-12);
    check_near(series.rows[1].packing.applied[1][1], 3, 1e-12);
    check_done(html_begin(&html));
    check_done(page_write(&page, &series, &html));
    check_done(html_end(&html));
    series_free(&series);
    for (int k = 0; k < 2; k++)
        unlink(paths[k]);
    return html.text;
}

static void test_oedometer(void **unused)
{
    (void)unused;
    char *page = page_of(1e-5, 4e-3);
    assert_non_null(strstr(page, "Earth pressure at rest"));
    assert_non_null(strstr(page, "Oedometric curve"));
    assert_non_null(strstr(page, "Degree of indeterminacy"));
    assert_non_null(strstr(page, "Unbalanced force on the grains"));
    assert_non_null(strstr(page, "Normal stress by orientation"));
    free(page);
    page = page_of(-2e-3, 4e-3); /* a biaxial test */
    assert_null(strstr(page, "Earth pressure at rest"));
    free(page);
}

/* A photo with 40 columns of level 1000 and 60 of 40000; a frame that holds the columns 20 to 59 of the rows 10 to 29.
 */
static void test_histogram(void **unused)
{
    (void)unused;
    struct photo photo;
    struct histogram histogram;
    struct scene scene = {.frame = {.given = 1, .corners_px = {{20, 10}, {59, 10}, {59, 29}, {20, 29}}}};
    check_done(photo_alloc(&photo, 100, 50));
    photo.bits = 16;
    for (int k = 0; k < 100 * 50; k++)
        photo.pixels[k] = k % 100 < 40 ? 1000 : 40000;
    histogram_make(&photo, NULL, &histogram);
    assert_int_equal(histogram.pixels, 5000);
    check_near(histogram.density[1000 / 256], 0.4, 1e-12);
    check_near(histogram.density[40000 / 256], 0.6, 1e-12);
    histogram_make(&photo, &scene, &histogram);
    assert_int_equal(histogram.pixels, 40 * 20);
    check_near(histogram.density[1000 / 256], 0.5, 1e-12);
    photo_free(&photo);
}

static int draw_dot(struct canvas *canvas, const void *radius)
{
    pen_circle(canvas, &(struct pen){0}, 50, 50, *(const double *)radius);
    return 0;
}

/* A picture is on the page, and in the folder under its title. */
static void test_pictures(void **unused)
{
    (void)unused;
    static const char *const extensions[] = {"svg", "pdf", "png"}, *const begins[] = {"<?xml", "%PDF", "\211PNG"};
    const double radius = 20;
    struct picture picture = {"../A dot: 1 & <two>", 100, 100, draw_dot, &radius};
    struct html html;
    for (int k = 0; k < 3; k++) {
        char path[300], begin[5] = "";
        check_done(html_begin(&html));
        html.pictures = folder;
        html.extension = extensions[k];
        check_done(picture_put(&picture, CANVAS_SVG, &html));
        check_done(html_end(&html));
        assert_non_null(strstr(html.text, "data:image/svg+xml"));
        html_free(&html);
        snprintf(path, sizeof path, "%s/A-dot-1-two.%s", folder, extensions[k]);
        FILE *stream = fopen(path, "rb");
        assert_non_null(stream);
        assert_int_equal(fread(begin, 1, 4, stream), 4);
        fclose(stream);
        assert_memory_equal(begin, begins[k], 4);
        unlink(path);
    }
    canvas_forget_fonts();
}

/* For people three digits and units that can be read; counts stay whole, and near one four decimals. */
static void test_figures(void **unused)
{
    (void)unused;
    static const struct {
        double value;
        const char *units, *shown;
    } cases[] = {{0.00779214, "1", "0.00779"},
                 {5.46748e-06, "m", "5.47 um"},
                 {-5.4e-8, "m", "-0.0540 um"},
                 {4.64354e-05, "m/px", "46.4 um/px"},
                 {0.0125, "m", "12.5 mm"},
                 {726667, "Pa", "727 kPa"},
                 {-73712.3, "Pa", "-73.7 kPa"},
                 {2.7e6, "Pa", "2.70 MPa"},
                 {12.3, "Pa", "12.3 Pa"},
                 {1850, "1", "1850"},
                 {123456, "1", "123456"},
                 {0, "1", "0"},
                 {-0.0, "m", "0 um"},
                 {0.99953, "1", "0.9995"},
                 {2.5913e-16, "1", "2.59e-16"},
                 {602.6543, "N", "603 N"},
                 {0.0284123, "px", "0.0284 px"},
                 {NAN, "px", "-"}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        struct figures figures = {.count = 0};
        char *text = NULL, expected[128];
        size_t length;
        FILE *stream = open_memstream(&text, &length);
        figures_add(&figures, "name", cases[k].value, cases[k].units, "what");
        check_done(figures_print(&figures, stream));
        fclose(stream);
        const char *space = strchr(cases[k].shown, ' ');
        int digits = space ? (int)(space - cases[k].shown) : (int)strlen(cases[k].shown);
        snprintf(expected, sizeof expected, "%-62s %12.*s%s\n", "what", digits, cases[k].shown, space ? space : "");
        assert_string_equal(text, expected);
        free(text);
    }
}

/* A list that is full must not lose figures in silence. */
static void test_figures_too_many(void **unused)
{
    (void)unused;
    struct figures figures = {.count = 0};
    enum { ROOM = sizeof figures.list / sizeof *figures.list };
    for (int k = 0; k < ROOM; k++)
        figures_add(&figures, "name", k, "1", "what");
    FILE *stream = fopen("/dev/null", "w");
    assert_non_null(stream);
    check_done(figures_print(&figures, stream));
    figures_add(&figures, "name", 0, "1", "one too many");
    assert_int_equal(figures_print(&figures, stream), -1);
    assert_int_equal(figures_write_json(&figures, "/tmp/test_report_numbers.json"), -1);
    fclose(stream);
}

/* What the page warns of in a state whose Weber stresses are off the applied ones by these shares. */
static char *warnings_of(double xx, double yy)
{
    char name[] = "0000";
    struct series_row row = {.name = name, .packing.force_count = 1};
    struct series series = {.rows = &row, .count = 1};
    const struct scene scene = {0};
    struct force_summary *forces = &row.packing.forces[0];
    struct html html;
    strcpy(forces->method, "qsm");
    row.packing.applied[0][0] = 2e4, row.packing.applied[1][1] = 5e4;
    forces->weber[0][0] = 2e4 * (1 + xx), forces->weber[1][1] = 5e4 * (1 + yy);
    forces->overlaps_over_loads = NAN;
    check_done(html_begin(&html));
    check_done(page_warnings(&scene, &series, &html));
    check_done(html_end(&html));
    return html.text;
}

static void test_stress_is_warned_of(void **unused)
{
    (void)unused;
    static const struct {
        double xx, yy;
        int said[2];
    } cases[] = {{0.09, -0.09, {0, 0}}, {0.11, 0, {1, 0}}, {0, -0.11, {0, 1}}, {-0.3, 0.5, {1, 1}}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        char *text = warnings_of(cases[k].xx, cases[k].yy);
        assert_int_equal(strstr(text, "Weber stress xx is more than") != NULL, cases[k].said[0]);
        assert_int_equal(strstr(text, "Weber stress yy is more than") != NULL, cases[k].said[1]);
        free(text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_quantiles),        cmocka_unit_test(test_indeterminacy),
        cmocka_unit_test(test_oedometer),        cmocka_unit_test(test_histogram),
        cmocka_unit_test(test_pictures),         cmocka_unit_test(test_figures),
        cmocka_unit_test(test_figures_too_many), cmocka_unit_test(test_stress_is_warned_of)};
    if (!mkdtemp(folder))
        return 1;
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    rmdir(folder);
    return failed;
}
