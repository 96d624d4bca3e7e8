/* `report map`, `film`, `histogram` and `page` from outside, on nine discs whose every number is known: what stands in
 * the SVG and in the page, and which pixels of a photo show through. */
#include "tests/commands.h"
#include "tests/touch.h"
#include "tests/lattice.h"

#include <cairo.h>
#include <stdio.h>

#include "pipeline/scene/photo.h"

/* ---- inputs ---- */

/* 400 x 400 px: bright left of the middle of the box (x = 200), dark right of it. */
static void write_photo(const char *path, int from, int size, unsigned dark)
{
    struct photo photo = {0};
    check_done(photo_alloc(&photo, size, size));
    for (int y = 0; y < size; y++)
        for (int x = 0; x < size; x++)
            photo.pixels[(size_t)y * (size_t)size + (size_t)x] = (uint16_t)(x + from < 200 ? 50000 : dark);
    check_done(photo_write(path, &photo));
    photo_free(&photo);
}

/* State 0 by two methods of 1 and 1.1 times the truth; state 1 with flags, a candidate and corner discs, no forces. */
static void write_states(void)
{
    struct packing p;
    lattice_make(&p, "dem");
    lattice_write(&p, "truth/0000.truth.hdf", 0);
    lattice_make(&p, "dem");
    lattice_write(&p, "truth/0001.truth.hdf", 1);
    for (int s = 0; s < 2; s++) {
        char path[40];
        lattice_make(&p, "map");
        for (int c = 0; c < LATTICE_CONTACTS; c++)
            p.forces->contact.fn[c] *= 1 + 0.1 * s;
        for (int c = 5; c < 7; c++) { /* slip: by their status, or without one because |ft| = mu fn */
            p.forces->contact.ft[c] = (c == 5 ? 0.5 : -0.5) * p.forces->contact.fn[c];
            p.forces->contact.status[c] = STATUS_SLIP;
        }
        if (s)
            free(p.forces->contact.status), p.forces->contact.status = NULL;
        p.forces->converged = !s, p.forces->iterations = 77;
        snprintf(path, sizeof path, "%04d.forces.hdf", s);
        lattice_write(&p, path, s);
    }
    lattice_make(&p, "map");
    forces_free(p.forces);
    p.force_count = 0;
    p.contacts.flags[2] |= CONTACT_CANDIDATE;
    p.grains.flags[0] = GRAIN_RATTLER, p.grains.flags[1] = GRAIN_LOW_ZNCC, p.grains.flags[2] = GRAIN_FLOATING;
    strcpy(p.walls.name[3], "bottom-left"); /* a disc in the place of the left wall */
    p.walls.x0[3] = p.walls.y0[3] = 0, p.walls.radius[3] = 0.004;
    touch(&p);
    lattice_write(&p, "0002.contacts.hdf", 2);
}

static void write_photo_side(void)
{
    struct photo_grains g;
    for (int s = 0; s < 2; s++) {
        char path[60];
        lattice_photo(&g, 3 * s, -5 * s, 0.02 * s);
        snprintf(path, sizeof path, "truth/%04d.photo-truth.hdf", s);
        lattice_photo_write(&g, path, "simulate", s);
        lattice_photo(&g, 3.06 * s, -5 * s, 0.021 * s);
        g.flags[8] = s ? GRAIN_LOW_ZNCC : 0;
        snprintf(path, sizeof path, "%04d.tracks.hdf", s);
        lattice_photo_write(&g, path, "tracker", s);
    }
    lattice_photo(&g, 0.3, -0.4, 0);
    for (int k = 0; k < LATTICE_GRAINS; k++)
        g.radius_px[k] += 0.1;
    lattice_photo_write(&g, "0000.grains.hdf", "findgrains", 0);
}

/* ---- SVG ---- */

/* Lines run from centre to centre (to the foot on a wall), small forces first, as wide as the force: 0.22 radii for
 * the mean one. The view: the box and a margin of 3 % of it; three more lines stand in the legend. */
static void lines_are_as_wide_as_the_forces(void **state)
{
    (void)state;
    enum { MOST = 60 };
    struct svg_stroke blue[MOST], red[MOST];
    const double scale = 1000 / (1.06 * LATTICE_BOX), mean = 4 * (450 + 330) / 24.0;
    command_done("report map 0000.forces.hdf --width 1000 -o map.svg");
    char *svg = check_svg("map.svg");
    size_t sticking = svg_strokes(svg, "rgb(0%,44.7", blue, MOST), slipping = svg_strokes(svg, "rgb(83.5", red, MOST);
    /* the legend: three widths and a sample of each colour */
    assert_int_equal(sticking, LATTICE_CONTACTS - 2 + 3 + 1);
    assert_int_equal(slipping, 2 + 1);
    for (int k = 0; k < 2; k++) {
        check_near(red[k].width, 0.22 * LATTICE_RADIUS * scale * LATTICE_V(1) / mean, 0.01);
        check_near(red[k].x0, scale * (0.03 * LATTICE_BOX + 0.03), 0.01);
        check_near(fabs(red[k].y1 - red[k].y0), 2 * LATTICE_RADIUS * scale, 0.01);
    }
    double before = 0, up = 0, wide = 0;
    for (int k = 0; k < LATTICE_CONTACTS - 2; k++) {
        assert_true(blue[k].width >= before - 1e-9);
        before = blue[k].width;
        int lying = fabs(blue[k].x1 - blue[k].x0) > fabs(blue[k].y1 - blue[k].y0);
        double length = hypot(blue[k].x1 - blue[k].x0, blue[k].y1 - blue[k].y0) / scale;
        assert_true(fabs(length - 0.02) < 1e-5 || fabs(length - 0.01) < 1e-5);
        *(lying ? &wide : &up) += blue[k].width / (0.22 * LATTICE_RADIUS * scale) * mean;
    }
    check_near(wide, 4 * 330, 0.5);
    check_near(up, 4 * 450 - 2 * LATTICE_V(1), 0.5);
    free(svg);
}

static void contacts_without_forces_are_lines_too(void **state)
{
    (void)state;
    enum { MOST = 60 };
    struct svg_stroke blue[MOST];
    command_done("report map 0002.contacts.hdf --width 1000 --title 'a <title>' -o contacts.svg");
    char *svg = check_svg("contacts.svg");
    assert_int_equal(svg_strokes(svg, "rgb(0%,44.7", blue, MOST), LATTICE_CONTACTS + 1); /* with the legend's */
    for (int c = 0; c < LATTICE_CONTACTS; c++)
        check_near(blue[c].width, c == 2 ? 1 : 2, 1e-6);              /* the candidate, dotted */
    assert_int_equal(text_count(svg, "stroke-dasharray"), 1 + 1 + 1); /* the candidate, the rattler, its legend */
    free(svg);
}

/* ---- pixels ---- */

struct pixels {
    int width, height, stride;
    cairo_surface_t *surface;
};

static struct pixels pixels_of(const char *path)
{
    cairo_surface_t *surface = cairo_image_surface_create_from_png(path);
    assert_int_equal(cairo_surface_status(surface), CAIRO_STATUS_SUCCESS);
    return (struct pixels){cairo_image_surface_get_width(surface), cairo_image_surface_get_height(surface),
                           cairo_image_surface_get_stride(surface), surface};
}

static unsigned pixel(const struct pixels *pixels, double x, double y)
{
    uint32_t value;
    assert_true(x >= 0 && y >= 0 && x < pixels->width && y < pixels->height);
    memcpy(&value, cairo_image_surface_get_data(pixels->surface) + (size_t)y * (size_t)pixels->stride + 4 * (size_t)x,
           4);
    return value & 0xFFFFFF;
}

/* The upper margin shows the photo alone: white up to the middle of the box, then black under a veil of 35 %. */
static void check_halves(const char *path, int width, unsigned dark)
{
    struct pixels pixels = pixels_of(path);
    check_png(path, width, -1);
    assert_int_equal(pixels.width, width);
    for (int x = 2; x < width - 2; x += 3)
        if (fabs(x - width / 2.0) > 4)
            assert_int_equal(pixel(&pixels, x, 2), x < width / 2 ? 0xFFFFFF : dark);
    cairo_surface_destroy(pixels.surface);
}

static void photos_lie_below_the_map(void **state)
{
    (void)state;
    const unsigned veiled = 0x595959; /* 0.35 * 255 */
    command_done("report map 0000.forces.hdf --scene scene.json --photo 0000.tif --width 900 -o over.png");
    check_halves("over.png", 900, veiled);
    command_done("report map 0000.forces.hdf --scene scene.json --photo 0000.tif --width 200 -o coarse.png");
    check_halves("coarse.png", 200, veiled); /* blocks of pixels */
    command_done("report map 0000.tracks.hdf --photo 0000.tif --width 700 --arrows 10 -o tracks.png");
    check_halves("tracks.png", 700, 0);
    command_done("report film --quiet --scene scene.json --method map --width 800 0000.forces.hdf 0001.forces.hdf "
                 "-o frames");
    check_halves("frames/0000.png", 800, veiled);
    check_halves("frames/0001.png", 800, veiled);
}

/* The common unit of width: frame 1, with forces 1.1 times as large, has wider lines than frame 0. */
static void frames_share_a_unit(void **state)
{
    (void)state;
    int blue[2] = {0};
    command_done("report film --quiet --width 1000 0000.forces.hdf 0001.forces.hdf -o plain");
    for (int s = 0; s < 2; s++) {
        struct pixels pixels = pixels_of(s ? "plain/0001.png" : "plain/0000.png");
        double scale = 1000 / (1.06 * LATTICE_BOX), y = scale * (0.03 + 0.03 * 0.06); /* through the middle row */
        for (int x = 0; x < pixels.width; x++) /* across the contact of column 2 between rows 1 and 2 */
            blue[s] += pixel(&pixels, x, y - scale * 0.01) == 0x0072B2;
        cairo_surface_destroy(pixels.surface);
    }
    double unit = 0.22 * LATTICE_RADIUS * 1000 / (1.06 * LATTICE_BOX) / (4 * (450 + 330) / 24.0 * 1.05);
    for (int s = 0; s < 2; s++) /* columns 0 and 2 stick there, column 1 slips; the edges' pixels are blends */
        check_near(blue[s], unit * (1 + 0.1 * s) * (LATTICE_V(0) + LATTICE_V(2)), 5);
    assert_true(blue[1] > blue[0]);
}

static void wrong_maps_are_refused(void **state)
{
    (void)state;
    file_write("bare.json", "{\"schema\": \"film.scene/1\", \"name\": \"no scale\"}");
    file_write("far.json", "{\"schema\": \"film.scene/1\", \"name\": \"far\", \"scale_m_per_px\": 2e-4, \"origin_px\": "
                           "[90000, 0]}");
    command_fails(2, "give one state file", "report map 0000.forces.hdf 0001.forces.hdf -o no.png");
    command_fails(2, "--width 10", "report map 0000.forces.hdf --width 10 -o no.png");
    command_fails(2, "--mean-fn 0", "report map 0000.forces.hdf --mean-fn 0 -o no.png");
    command_fails(2, "Give -o OUT", "report map 0000.forces.hdf");
    command_fails(2, "Give --scene", "report map 0000.forces.hdf --photo 0000.tif -o no.png");
    command_fails(3, "no.gif: no picture format", "report map 0000.forces.hdf -o no.gif");
    command_fails(3, "no forces of method 'qsm'", "report map 0000.forces.hdf --method qsm -o no.png");
    command_fails(3, "scale_m_per_px", "report map 0000.forces.hdf --scene bare.json --photo 0000.tif -o no.png");
    command_fails(3, "the photo does not show the packing",
                  "report map 0000.forces.hdf --scene far.json --photo 0000.tif -o no.png");
    command_fails(3, "missing.tif", "report map 0000.tracks.hdf --photo missing.tif -o no.png");
    command_fails(1, "no/map.pdf", "report map 0000.forces.hdf -o no/map.pdf");
    command_fails(2, "give the state files", "report film -o no");
    command_fails(3, "no forces of method 'qsm'", "report film --method qsm 0000.forces.hdf -o no");
    command_fails(3, "scale_m_per_px", "report film --scene bare.json 0000.forces.hdf -o no");
    command_fails(3, "missing.hdf", "report film 0000.forces.hdf missing.hdf -o no");
    command_fails(1, "scene.json/frames: the folder cannot be made",
                  "report film 0000.forces.hdf -o scene.json/frames");
    assert_false(file_exists("no.png") || file_exists("no"));
}

/* ---- histogram ---- */

/* Two grey levels: two dots, as far above each other as their shares say. */
static void check_hills(const char *path, double bright)
{
    enum { MOST = 60 };
    struct svg_stroke grid[MOST];
    double y[MOST], least = INFINITY;
    char *svg = check_svg(path);
    size_t lines = svg_strokes(svg, "stroke:rgb(88", grid, MOST), dots = 0;
    for (size_t k = 1; k < lines;
         k++) /* those across stand at 1, 2, 5, 10 times a power: the least step is a factor of 2 */
        if (grid[k].y0 == grid[k].y1 && grid[k - 1].y0 == grid[k - 1].y1)
            least = fmin(least, grid[k - 1].y0 - grid[k].y0);
    for (const char *at = svg; (at = strstr(at, "fill:rgb(0%,44.7")); at++) {
        const char *d = strstr(at, "d=\"M ");
        assert_true(d && dots < MOST && sscanf(d, "d=\"M %*f %lf", &y[dots++]) == 1);
    }
    assert_int_equal(dots, 2 + 1); /* the dark level, the bright one, the key */
    assert_true(least > 0 && isfinite(least));
    check_near((y[0] - y[1]) / least, log2(bright / (1 - bright)), 3e-3);
    free(svg);
}

/* What is inside the frame counts, and nothing else: 70 of its 100 columns are bright, the same picture as of that part
 * alone; of the whole photo half is bright. */
static void the_frame_decides_what_counts(void **state)
{
    (void)state;
    write_photo("part.tif", 130, 100, 9000);
    file_write("frame.json", "{\"schema\": \"film.scene/1\", \"name\": \"f\", \"scale_m_per_px\": 2e-4, \"frame\": "
                             "{\"corners_px\": [[129.5, 99.5], [229.5, 99.5], [229.5, 199.5], [129.5, 199.5]]}}");
    command_done("report histogram 0000.tif -o whole.svg");
    command_done("report histogram --scene frame.json 0000.tif -o framed.svg");
    command_done("report histogram part.tif -o part.svg");
    check_hills("whole.svg", 0.5);
    check_hills("framed.svg", 0.7);
    check_hills("part.svg", 0.7);
    char *framed = file_text("framed.svg"), *part = file_text("part.svg");
    assert_string_equal(framed, part);
    free(framed), free(part);
    command_done("report histogram 0000.tif -o levels.png");
    check_png("levels.png", 640, 400);
}

static void write_found(const char *path, const char *found)
{
    struct photo_grains g;
    struct provenance provenance = PROVENANCE_DEFAULT;
    lattice_photo(&g, 0, 0, 0);
    provenance.stage = "findgrains", provenance.coordinates = "seen";
    struct state_writer *writer = state_create(path, &provenance);
    assert_non_null(writer);
    check_done(state_write(writer, "grains", &PHOTO_GRAINS, &g));
    if (found)
        check_done(state_write_text(writer, "grains", "found", found));
    check_done(state_commit(writer));
    table_free(&PHOTO_GRAINS, &g);
}

/* A vertical line where the threshold is: 30000 of 0 to 65535, between the two hills at 9000 and 50000. */
static void the_threshold_is_marked(void **state)
{
    (void)state;
    enum { MOST = 60 };
    struct svg_stroke lines[MOST];
    write_found("found.hdf", "{\"threshold\": 30000}");
    write_found("silent.hdf", NULL);
    write_found("other.hdf", "{\"rims\": 3}");
    command_done("report histogram --grains found.hdf part.tif -o marked.svg");
    command_done("report histogram part.tif -o plain.svg");
    char *marked = check_svg("marked.svg"), *plain = check_svg("plain.svg");
    size_t before = svg_strokes(plain, "rgb(83.5", lines, MOST), after = svg_strokes(marked, "rgb(83.5", lines, MOST);
    assert_int_equal(before, 0);
    assert_true(after >= 1);
    check_near(lines[0].x1, lines[0].x0, 1e-6);
    assert_true(fabs(lines[0].y1 - lines[0].y0) > 0);
    free(marked), free(plain);
    command_fails(3, "silent.hdf: does not say what findgrains found",
                  "report histogram --grains silent.hdf 0000.tif -o no.png");
    command_fails(3, "other.hdf: does not say the threshold", "report histogram --grains other.hdf 0000.tif -o no.png");
    command_fails(3, "missing.tif", "report histogram missing.tif -o no.png");
    command_fails(3, "missing.json", "report histogram --scene missing.json 0000.tif -o no.png");
    command_fails(2, "one photo at a time", "report histogram 0000.tif part.tif -o no.png");
    command_fails(2, "which photo?", "report histogram -o no.png");
    assert_false(file_exists("no.png"));
}

/* ---- page ---- */

/* The row that begins with the cell `name` and holds these cells, ends of a table's row included. */
static void check_row(const char *html, const char *cells)
{
    if (!strstr(html, cells))
        print_error("no row %s\n", cells);
    assert_non_null(strstr(html, cells));
}

static void a_page_says_how_close_it_is(void **state)
{
    (void)state;
    command_done("report page --quiet --scene scene.json --truth truth --maps 1 --pictures pictures --format pdf "
                 "-o page.html 0000.grains.hdf 0000.tracks.hdf 0001.tracks.hdf 0000.forces.hdf 0001.forces.hdf");
    char *html = file_text("page.html");
    assert_non_null(strstr(html, "<title>nine &lt;discs&gt;</title>"));
    assert_null(strstr(html, "<script"));
    /* found, missed, false, flagged; 0.5 / sqrt(2) px; over 0.1 px; 0.1 px of radius, biased, over 0.05 px */
    check_row(html,
              "<tr><td class=\"left\">0000</td><td>9</td><td>0</td><td>0</td><td>0</td><td>0.354</td><td>3.54</td>"
              "<td>0.1</td><td>0.1</td><td>2</td></tr>");
    /* 8 tracked, 1 flagged; 0.06 px to the right: rms per axis, largest, over 0.1 px; 0.001 rad */
    check_row(html, "<tr><td class=\"left\">0001</td><td>8</td><td>1</td><td>0.0424</td><td>0.06</td><td>0.424</td>"
                    "<td>0.0573</td><td>0.0573</td><td>1</td></tr>");
    /* all contacts; r(fn) 1, r(ft) unknown; dist: two contacts by ft 75 N of 24, over 130 N; <fn> */
    check_row(html,
              "<tr><td class=\"left\">0000</td><td class=\"left\">map</td><td>1</td><td>1</td><td>1</td><td>1</td>"
              "<td>–</td><td>1</td><td>0.0481</td><td>130</td><td>130</td></tr>");
    check_row(html, "<td>143</td><td>130</td></tr>");
    assert_non_null(strstr(html, "map: in 1 of 2 states it did not converge (worst 77 iterations, 0001)"));
    assert_int_equal(text_count(html, "<figure"), text_count(html, "</figure>"));
    assert_true(text_count(html, "data:image/") > 5);
    free(html);
    char *pdf = file_text("pictures/0001-forces-by-map.pdf");
    assert_int_equal(strncmp(pdf, "%PDF-", 5), 0);
    free(pdf);
}

static void contacts_alone_make_a_page(void **state)
{
    (void)state;
    command_done("report page --quiet --scene scene.json --maps 2 -o contacts.html 0002.contacts.hdf");
    char *html = file_text("contacts.html");
    assert_non_null(strstr(html, "0002: contacts"));
    assert_null(strstr(html, "Against the truth"));
    free(html);
}

static void wrong_pages_are_refused(void **state)
{
    (void)state;
    command_fails(2, "give the state files", "report page --scene scene.json -o no.html");
    command_fails(2, "give one of: svg, pdf, png", "report page --scene scene.json --format gif -o no.html x.hdf");
    command_fails(2, "--maps x", "report page --scene scene.json --maps x -o no.html x.hdf");
    command_fails(3, "missing.hdf", "report page --scene scene.json -o no.html missing.hdf");
    command_fails(3, "nowhere/0000.photo-truth.hdf",
                  "report page --scene scene.json --truth nowhere -o no.html 0000.grains.hdf");
    command_fails(3, "nowhere/0000.truth.hdf",
                  "report page --scene scene.json --truth nowhere -o no.html 0000.forces.hdf");
    command_fails(1, "scene.json/pictures",
                  "report page --quiet --scene scene.json --pictures scene.json/pictures "
                  "-o no.html 0000.forces.hdf");
    assert_false(file_exists("no.html"));
}

static int begin(void **state)
{
    if (folder_enter(state) || system("mkdir truth"))
        return -1;
    file_write("scene.json", LATTICE_SCENE);
    write_photo("0000.tif", 0, 400, 9000);
    write_photo("0001.tif", 0, 400, 9000);
    write_states();
    write_photo_side();
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lines_are_as_wide_as_the_forces), cmocka_unit_test(contacts_without_forces_are_lines_too),
        cmocka_unit_test(photos_lie_below_the_map),        cmocka_unit_test(frames_share_a_unit),
        cmocka_unit_test(wrong_maps_are_refused),          cmocka_unit_test(the_frame_decides_what_counts),
        cmocka_unit_test(the_threshold_is_marked),         cmocka_unit_test(a_page_says_how_close_it_is),
        cmocka_unit_test(contacts_alone_make_a_page),      cmocka_unit_test(wrong_pages_are_refused),
    };
    return cmocka_run_group_tests(tests, begin, folder_leave);
}
