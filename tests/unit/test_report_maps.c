/* Force maps side by side: one method and one unit of width for all of them, and no line that covers the others. */
#include "tests/check.h"

#include <cairo.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "pipeline/scene/scene.h"
#include "pipeline/speak/error.h"
#include "pipeline/draw/canvas.h"
#include "pipeline/packing/packing_file.h"
#include "report/compare/compare.h"
#include "report/pictures/movie.h"
#include "report/pictures/force_map.h"
#include "report/states/method_choice.h"
#include "report/page/page.h"

static char folder[] = "/tmp/test_report_maps.XXXXXX";

/* Three grains of 10 mm radius in a row on a bottom wall: contacts 0-1, 1-2 and 0-bottom, forces by `count`
 * methods. */
static void make_row(struct packing *p, const char *const methods[], size_t count)
{
    memset(p, 0, sizeof *p);
    p->length_m = NAN;
    check_done(table_alloc(&GRAINS, &p->grains, 3, NULL));
    check_done(table_alloc(&WALLS, &p->walls, 1, NULL));
    check_done(table_alloc(&CONTACTS, &p->contacts, 3, NULL));
    for (int k = 0; k < 3; k++) {
        p->grains.x[k] = 0.02 * k, p->grains.y[k] = 0, p->grains.radius[k] = 0.01;
        p->grains.mass[k] = p->grains.inertia[k] = 1;
        p->contacts.i[k] = k < 2 ? k : 0, p->contacts.j[k] = k < 2 ? k + 1 : 3;
        p->contacts.nx[k] = k < 2, p->contacts.ny[k] = k < 2 ? 0 : -1;
        p->contacts.x[k] = k < 2 ? 0.02 * k + 0.01 : 0, p->contacts.y[k] = k < 2 ? 0 : -0.01;
        p->contacts.overlap[k] = 1e-5;
    }
    strcpy(p->walls.name[0], "bottom");
    p->walls.x0[0] = -0.01, p->walls.x1[0] = 0.05, p->walls.y0[0] = p->walls.y1[0] = -0.01, p->walls.radius[0] = 0;
    p->forces = calloc(count + 1, sizeof *p->forces);
    p->force_count = count;
    for (size_t f = 0; f < count; f++) {
        strcpy(p->forces[f].method, methods[f]);
        p->forces[f].converged = 1;
        check_done(table_alloc(&CONTACT_FORCES, &p->forces[f].contact, 3, NULL));
        for (int c = 0; c < 3; c++)
            p->forces[f].contact.fn[c] = 10, p->forces[f].contact.ft[c] = 0;
    }
}

static void write_row(struct packing *p, int64_t index, char path[64])
{
    struct provenance provenance = PROVENANCE_DEFAULT;
    snprintf(path, 64, "%s/%04d.forces.hdf", folder, (int)index);
    provenance.stage = "forces";
    provenance.index = index;
    check_done(packing_write(path, p, &provenance));
    packing_free(p);
}

/* ---- methods ---- */

static void test_default_order(void **unused)
{
    (void)unused;
    static const char *const order[] = {"series", "map", "qsm", "cdm", "cem", "dem", "abc", "zzz"};
    static const char *const names[] = {"abc", "cdm", "cem", "dem", "map", "qsm", "series", "zzz"}; /* as in a file */
    struct packing p;
    const struct forces *forces;
    for (size_t k = 0; k < 8; k++)
        for (size_t other = 0; other < 8; other++)
            assert_int_equal(method_order(order[k], order[other]) < 0, k < other);
    make_row(&p, names, 8);
    for (size_t k = 0; k < 8; k++) {
        assert_string_equal(method_default(&p)->method, order[k]);
        for (size_t f = 0; f < p.force_count; f++) /* take it away */
            if (!strcmp(p.forces[f].method, order[k]))
                strcpy(p.forces[f].method, "zzzz");
    }
    check_done(method_choose(&p, "a.hdf", "zzzz", &forces));
    assert_string_equal(forces->method, "zzzz");
    assert_int_equal(method_choose(&p, "a.hdf", "map", &forces), -1);
    assert_non_null(strstr(error_message(), "a.hdf: has no forces of method 'map'"));
    packing_free(&p);
    make_row(&p, NULL, 0);
    check_done(method_choose(&p, "a.hdf", NULL, &forces));
    assert_null(forces);
    packing_free(&p);
}

/* Compared without a name: map, although cdm is the first in the file. */
static void test_compare_default(void **unused)
{
    (void)unused;
    static const char *const names[] = {"cdm", "map"};
    struct packing a, b;
    struct figures f = {.count = 0};
    make_row(&a, names, 2);
    make_row(&b, names, 1);
    for (int c = 0; c < 3; c++)
        a.forces[1].contact.fn[c] = 20;
    check_done(compare_packings(&a, &b, NULL, NULL, &f));
    check_near(figures_value(&f, "mean_fn_a_N"), 20, 1e-12);
    packing_free(&a);
    packing_free(&b);
}

static void test_common(void **unused)
{
    (void)unused;
    struct methods m = {.states = 2};
    assert_null(methods_common(&m));
    for (int k = 0; k < 2; k++) {
        methods_add(&m, "cdm", k, 10 + k);
        methods_add(&m, "cem", 1, NAN);
    }
    assert_string_equal(methods_common(&m), "cem"); /* it converged in all states */
    methods_add(&m, "map", 1, 30);
    assert_string_equal(methods_common(&m), "cem"); /* not in all states */
    methods_add(&m, "map", 0, 50);
    assert_string_equal(methods_common(&m), "map");
    methods_add(&m, "series", 0, NAN);
    methods_add(&m, "series", 0, NAN);
    assert_string_equal(methods_common(&m), "series");
    check_near(methods_mean_fn(&m, "map"), 40, 1e-12);
    check_near(methods_mean_fn(&m, NULL), (10 + 11 + 30 + 50) / 4.0, 1e-12);
    assert_true(isnan(methods_mean_fn(&m, "series")));
    assert_int_equal(methods_find(&m, "cdm"), 2);
    struct methods never = {.states = 2};
    methods_add(&never, "cem", 1, 1);
    methods_add(&never, "cem", 0, 1);
    methods_add(&never, "cdm", 0, 1);
    methods_add(&never, "cdm", 0, 1);
    assert_string_equal(methods_common(&never), "cdm");
}

/* ---- pictures ---- */

/* How many pixels of the column x of a PNG are in the colour of a sticking contact. */
static int blue_in_column(cairo_surface_t *surface, double x, double height)
{
    const unsigned char *data = cairo_image_surface_get_data(surface);
    int count = 0, stride = cairo_image_surface_get_stride(surface);
    for (int y = 0; y < (int)height; y++) {
        uint32_t value;
        memcpy(&value, data + (size_t)y * (size_t)stride + 4 * (size_t)x, 4);
        count += (value & 0xFFFFFF) == 0x0072B2;
    }
    return count;
}

static int blue_of_file(const char *path, double x, double height)
{
    cairo_surface_t *surface = cairo_image_surface_create_from_png(path);
    assert_int_equal(cairo_surface_status(surface), CAIRO_STATUS_SUCCESS);
    int count = blue_in_column(surface, x, height);
    cairo_surface_destroy(surface);
    return count;
}

enum { STATES = 4 };

/* Map converged in states 0 and 1 only, cdm in 2 and 3 only; forces by map grow from 10 to 40 N: mean 25 N. */
static void write_states(char path[STATES][64])
{
    static const char *const names[] = {"cdm", "map"};
    for (int k = 0; k < STATES; k++) {
        struct packing p;
        make_row(&p, names, 2);
        p.forces[0].converged = k > 1, p.forces[1].converged = k < 2;
        for (int c = 0; c < 3; c++)
            p.forces[1].contact.fn[c] = 10 * (k + 1);
        write_row(&p, k, path[k]);
    }
}

/* One method in all maps although another one converged here and there, and widths that grow with the load. */
static void test_page_maps(void **unused)
{
    (void)unused;
    char path[STATES][64], *paths[STATES];
    struct series series;
    struct html html;
    struct scene scene = {.name = "row"};
    struct page page = {.scene = &scene, .maps = STATES};
    write_states(path);
    for (int k = 0; k < STATES; k++)
        paths[k] = path[k];
    check_done(series_read(paths, STATES, &series));
    check_done(html_begin(&html));
    html.pictures = folder;
    html.extension = "png";
    check_done(page_write(&page, &series, &html));
    check_done(html_end(&html));
    for (int k = 0; k < STATES; k++) {
        char title[64];
        snprintf(title, sizeof title, "%04d: forces by map", k);
        assert_non_null(strstr(html.text, title));
        snprintf(title, sizeof title, "%04d: forces by cdm", k);
        if (k < STATES - 1)
            assert_null(strstr(html.text, title));
        else
            assert_non_null(strstr(html.text, title)); /* the last one by every method */
    }
    assert_non_null(strstr(html.text, "Widths comparable between the maps: ⟨fn⟩ = 25 N"));
    for (int k = 0; k < STATES; k++) { /* 60 mm wide, margin 3 %: contact 0-1 at 10 mm; unit 0.22 radii at 25 N */
        char file[128];
        double scale = 1000 / (0.06 * 1.06), view = scale * (0.02 + 0.06 * 0.06);
        snprintf(file, sizeof file, "%s/%04d-forces-by-map.png", folder, k);
        check_near(blue_of_file(file, scale * (0.02 + 0.06 * 0.03), view), 0.22 * 0.01 * scale * 10 * (k + 1) / 25, 2);
    }
    html_free(&html);
    series_free(&series);
    for (int k = 0; k < STATES; k++)
        unlink(path[k]);
}

/* A film has one method, too: its unit is the mean of map, 25 N. */
static void test_film_method(void **unused)
{
    (void)unused;
    char path[STATES][64], *paths[STATES], frames[64], frame[80];
    struct movie film = {.width = 1000};
    write_states(path);
    for (int k = 0; k < STATES; k++)
        paths[k] = path[k];
    snprintf(frames, sizeof frames, "%s/frames", folder);
    check_done(movie_write(&film, paths, STATES, frames));
    double scale = 1000 / (0.06 * 1.06), view = scale * (0.02 + 0.06 * 0.06);
    for (int k = 0; k < STATES; k++) {
        snprintf(frame, sizeof frame, "%s/%04d.png", frames, k);
        check_near(blue_of_file(frame, scale * (0.02 + 0.06 * 0.03), view), 0.22 * 0.01 * scale * 10 * (k + 1) / 25, 2);
        unlink(frame);
        unlink(path[k]);
    }
    film.method = "qsm";
    write_states(path);
    assert_int_equal(movie_write(&film, paths, STATES, frames), -1);
    for (int k = 0; k < STATES; k++)
        unlink(path[k]);
    rmdir(frames);
}

/* A force of a thousand units is drawn as eight, and stays within walls and rims. */
static void test_wide_lines(void **unused)
{
    (void)unused;
    static const char *const names[] = {"map"};
    struct packing p;
    struct canvas canvas;
    make_row(&p, names, 1);
    p.grains.radius[0] = 0.002; /* mean radius 7.33 mm: eight units are 12.9 mm */
    p.walls.x0[0] = -0.002;     /* the left end of what is there; the line to the wall would reach -6.5 mm */
    p.forces[0].contact.fn[2] = 1e4;
    struct force_map map = {.packing = &p, .forces = p.forces, .width = 1000, .mean_fn = 10, .title = "a"};
    check_done(force_map_measure(&map));
    double unit = 0.22 * 0.022 / 3 * map.scale;
    check_near(force_map_line_width(&map, 10), unit, 1e-9);
    check_near(force_map_line_width(&map, 70), 7 * unit, 1e-9);
    check_near(force_map_line_width(&map, 90), 8 * unit, 1e-9);
    check_near(force_map_line_width(&map, 1e4), 8 * unit, 1e-9);
    assert_int_equal(force_map_cut_lines(&map), 1);
    check_done(canvas_begin_memory(&canvas, CANVAS_PNG, map.width, map.height));
    check_done(force_map_draw(&map, &canvas));
    cairo_surface_flush(canvas.surface);
    for (double x = 0; x < map.margin - 1; x++)
        assert_int_equal(blue_in_column(canvas.surface, x, map.view_height), 0);
    double inside = map.scale * (0.0055 - map.x0), outside = map.scale * (0.0075 - map.x0);
    assert_true(blue_in_column(canvas.surface, inside, map.view_height) > 4 * unit); /* half of eight: 6.45 mm */
    check_near(blue_in_column(canvas.surface, outside, map.view_height), unit, 2);
    canvas_discard(&canvas);
    p.forces[0].contact.fn[2] = 80;
    assert_int_equal(force_map_cut_lines(&map), 0);
    packing_free(&p);
}

static void remove_all(void)
{
    char command[128];
    snprintf(command, sizeof command, "rm -rf '%s'", folder);
    if (system(command))
        fprintf(stderr, "%s stays\n", folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_default_order), cmocka_unit_test(test_compare_default),
                                       cmocka_unit_test(test_common),        cmocka_unit_test(test_page_maps),
                                       cmocka_unit_test(test_film_method),   cmocka_unit_test(test_wide_lines)};
    if (!mkdtemp(folder))
        return 1;
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    remove_all();
    canvas_forget_fonts();
    return failed;
}
