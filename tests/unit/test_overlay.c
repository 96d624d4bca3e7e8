/* The picture of findgrains: how large a photo is drawn, what the caption says, where ticks, circles and the frame lie
 * in px of the photo, and in which colours. The picture is read back from its file. */
#include "tests/check.h"

#include <cairo.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "findgrains/picture/overlay.h"
#include "findgrains/picture/overlay_scale.h"
#include "pipeline/speak/error.h"

enum { WIDTH = 150, HEIGHT = 100, ZOOM = 4 };
static const uint32_t SKY = 0x56B4E9, VERMILLION = 0xD55E00, YELLOW = 0xF0E442, INK = 0x222222;
static char path[] = "/tmp/test_overlay.XXXXXX.png";

static void zoom_is_whole(void **state)
{
    static const struct {
        int width, height;
        double zoom;
        const char *words;
    } cases[] = {{850, 714, 4, "drawn 4 times as large"},           {714, 1001, 3, "drawn 3 times as large"},
                 {2500, 1000, 1, "drawn in its own size"},          {4001, 3000, 0.5, "drawn at 1/2 of its size"},
                 {7752, 10320, 1. / 3, "drawn at 1/3 of its size"}, {1, 1, 4, "drawn 4 times as large"}};
    (void)state;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        struct overlay_layout layout;
        struct overlay_facts facts = {.grains = 120, .flagged = 3};
        char words[OVERLAY_CAPTION_LINES * OVERLAY_CAPTION_LENGTH] = "";
        overlay_layout_make(cases[k].width, cases[k].height, &layout);
        overlay_layout_caption(&facts, &layout);
        for (int l = 0; l < OVERLAY_CAPTION_LINES; l++)
            strcat(words, layout.caption[l]);
        check_near(layout.zoom, cases[k].zoom, 1e-12);
        check_near(layout.photo_width, cases[k].width * cases[k].zoom, 1);
        check_near(layout.photo_height, cases[k].height * cases[k].zoom, 1);
        assert_true(layout.width > layout.photo_width && layout.height > layout.photo_height);
        assert_non_null(strstr(words, "120 grains, 3 flagged (dashed)"));
        assert_non_null(strstr(words, "ticks: px of the photo"));
        assert_non_null(strstr(words, cases[k].words));
        assert_null(strstr(words, "frame"));
        assert_null(strstr(words, "rows"));
    }
}

/* A long caption continues below, and the picture grows with it. */
static void caption_is_wrapped(void **state)
{
    struct overlay_layout narrow, wide;
    struct overlay_facts facts = {.grains = 12345, .flagged = 678, .numbered = 1, .has_frame = 1};
    (void)state;
    overlay_layout_make(60, 60, &narrow);
    overlay_layout_caption(&facts, &narrow);
    overlay_layout_make(1000, 1000, &wide);
    overlay_layout_caption(&facts, &wide);
    assert_string_equal(wide.caption[0],
                        "12345 grains, 678 flagged (dashed) · yellow: frame · in the circles: rows of the "
                        "file · ticks: px of the photo · drawn 4 times as large");
    assert_string_equal(wide.caption[1], "");
    assert_string_equal(narrow.caption[0], "12345 grains, 678 flagged (dashed)");
    assert_true(narrow.caption[1][0] && narrow.caption[2][0]);
    assert_true((narrow.height - narrow.photo_height) / narrow.text >
                (wide.height - wide.photo_height) / wide.text + 2);
}

static void numbers_need_room(void **state)
{
    struct overlay_layout layout;
    (void)state;
    overlay_layout_make(1434, 1078, &layout); /* drawn twice as large */
    check_near(layout.zoom, 2, 0);
    check_near(overlay_number_size(&layout, 3, 7), 0, 0);
    check_near(overlay_number_size(&layout, 100, 7), layout.text, 0);
    assert_true(overlay_number_size(&layout, 7.6, 7) >= 9);
    check_near(overlay_number_size(&layout, 7.6, 3700), 0, 0); /* four digits are wider */
    assert_true(2 * 10 * layout.zoom > 4 * 0.6 * overlay_number_size(&layout, 10, 3700));
}

static void other_endings_are_refused(void **state)
{
    static const char *const wrong[] = {"p.svg", "p.jpg", "p", "p.png.tif", "folder.png/p"};
    (void)state;
    check_done(overlay_check_path(NULL));
    check_done(overlay_check_path("p.png"));
    check_done(overlay_check_path("a.b/P.PNG"));
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
        assert_int_equal(overlay_check_path(wrong[k]), -1);
        assert_int_equal(error_status(), EXIT_INPUT);
        assert_int_equal(strncmp(error_message(), wrong[k], strlen(wrong[k])), 0);
    }
}

/* ---- pixels ---- */

/* A trusted grain, a flagged one, a lost one, and a frame, over a dark photo. */
static cairo_surface_t *picture(void)
{
    static const char *const names[] = {"x_px", "y_px", "radius_px", "flags", NULL};
    static const struct vec corners[4] = {{5, 10}, {140, 10}, {140, 95}, {5, 95}};
    struct photo photo;
    struct photo_grains grains;
    struct find_notes notes = {.levels = {.void_level = 1000, .grain_level = 30000}};
    check_done(photo_alloc(&photo, WIDTH, HEIGHT));
    for (int k = 0; k < WIDTH * HEIGHT; k++)
        photo.pixels[k] = 8000;
    check_done(zone_make(WIDTH, HEIGHT, corners, 0, &notes.zone));
    check_done(table_alloc(&PHOTO_GRAINS, &grains, 3, names));
    grains.x_px[0] = 40, grains.y_px[0] = 50, grains.radius_px[0] = 25;
    grains.x_px[1] = 105, grains.y_px[1] = 50, grains.radius_px[1] = 25, grains.flags[1] = GRAIN_CUT;
    grains.x_px[2] = NAN, grains.flags[2] = GRAIN_LOST;
    check_done(overlay_write(path, &photo, &grains, &notes));
    table_free(&PHOTO_GRAINS, &grains);
    photo_free(&photo);
    cairo_surface_t *surface = cairo_image_surface_create_from_png(path);
    assert_int_equal(cairo_surface_status(surface), CAIRO_STATUS_SUCCESS);
    return surface;
}

static uint32_t pixel(cairo_surface_t *surface, int x, int y)
{
    const unsigned char *data = cairo_image_surface_get_data(surface);
    uint32_t value;
    memcpy(&value, data + (size_t)y * (size_t)cairo_image_surface_get_stride(surface) + 4 * (size_t)x, 4);
    return value & 0xFFFFFF;
}

/* The pixel of the picture at a place in px of the photo, whose pixels have their centres at whole numbers. */
static uint32_t at(cairo_surface_t *surface, double x, double y)
{
    return pixel(surface, (int)((x + 0.5) * ZOOM), (int)((y + 0.5) * ZOOM));
}

/* Share of a circle that is of a colour. */
static double share(cairo_surface_t *surface, double x, double y, double radius, uint32_t colour)
{
    enum { STEPS = 720 };
    int count = 0;
    for (int k = 0; k < STEPS; k++) {
        double phi = 2 * M_PI * k / STEPS;
        count += at(surface, x + radius * cos(phi), y + radius * sin(phi)) == colour;
    }
    return (double)count / STEPS;
}

/* The longest way along a radius on which a circle is of the colour, px of the picture. */
static double thickness(cairo_surface_t *surface, double x, double y, double radius, uint32_t colour)
{
    const double step = 0.2 / ZOOM;
    int longest = 0;
    for (int k = 0; k < 360; k++) {
        int run = 0;
        for (double r = radius - 2; r < radius + 2; r += step) {
            run = at(surface, x + r * cos(k * M_PI / 180), y + r * sin(k * M_PI / 180)) == colour ? run + 1 : 0;
            longest = run > longest ? run : longest;
        }
    }
    return longest * step * ZOOM;
}

static void colours_say_what_is_flagged(void **state)
{
    (void)state;
    cairo_surface_t *surface = picture();
    double trusted = share(surface, 40, 50, 25, SKY), flagged = share(surface, 105, 50, 25, VERMILLION);
    printf("  of the circles' length: %.2f sky blue, %.2f vermillion\n", trusted, flagged);
    assert_true(trusted > 0.5); /* what is left is blended with the photo */
    assert_true(flagged > 0.4 && flagged < 0.75);
    check_near(share(surface, 40, 50, 25, VERMILLION), 0, 0);
    check_near(share(surface, 105, 50, 25, SKY), 0, 0);
    double thin = thickness(surface, 40, 50, 25, SKY), thick = thickness(surface, 105, 50, 25, VERMILLION);
    printf("  at most %.1f and %.1f px thick\n", thin, thick);
    check_near(thin, 2, 0.8);
    check_near(thick, 3.6, 0.8);
    int yellow = 0;
    for (int k = 0; k < 10; k++)
        yellow += at(surface, 20 + 11 * k, 10) == YELLOW || at(surface, 20 + 11 * k, 9.9) == YELLOW;
    assert_int_equal(yellow, 10);
    cairo_surface_destroy(surface);
}

/* The middles of dark runs on the paper, along the photo's lower side or down its right one, `off` px from it, in px of
 * the photo. */
static int find_ticks(cairo_surface_t *surface, int down, int off, double *ticks, int room)
{
    int count = 0, begin = -1, end = ZOOM * (down ? HEIGHT : WIDTH);
    for (int k = 0; k <= end; k++) {
        int dark = k < end && pixel(surface, down ? ZOOM * WIDTH + off : k, down ? k : ZOOM * HEIGHT + off) < 0xC0C0C0;
        if (dark && begin < 0)
            begin = k;
        if (!dark && begin >= 0) {
            assert_true(count < room);
            ticks[count++] = 0.5 * (begin + k) / ZOOM - 0.5;
            begin = -1;
        }
    }
    return count;
}

/* Letters are 12 px: a number every 20 px of the photo, a tick every 5. */
static void ticks_are_px_of_the_photo(void **state)
{
    double ticks[64];
    (void)state;
    cairo_surface_t *surface = picture();
    for (int down = 0; down < 2; down++) {
        int length = down ? HEIGHT : WIDTH, count = find_ticks(surface, down, 1, ticks, 64);
        assert_int_equal(count, (length + 4) / 5);
        for (int k = 0; k < count; k++)
            check_near(ticks[k], 5 * k, 0.26);
        count = find_ticks(surface, down, 4, ticks, 64);
        assert_int_equal(count, (length + 19) / 20);
        for (int k = 0; k < count; k++)
            check_near(ticks[k], 20 * k, 0.26);
        for (int k = 0; k < count; k++) /* across, over the photo's first pixels */
            assert_true(pixel(surface, down ? 1 : ZOOM * 20 * k + 2, down ? ZOOM * 20 * k + 2 : 1) > 0xA0A0A0);
    }
    cairo_surface_destroy(surface);
}

/* Letters are thin: their pixels are blended with what is around. */
static int is_near(uint32_t one, uint32_t two)
{
    int near = 1;
    for (int shift = 0; shift < 24; shift += 8)
        near = near && abs((int)(one >> shift & 255) - (int)(two >> shift & 255)) < 50;
    return near;
}

/* Whether some pixel of a box is about of the colour; x1 and y1 excluded. */
static int has(cairo_surface_t *surface, int x0, int y0, int x1, int y1, uint32_t colour)
{
    for (int y = y0; y < y1; y++)
        for (int x = x0; x < x1; x++)
            if (is_near(pixel(surface, x, y), colour))
                return 1;
    return 0;
}

/* Row numbers stand in the middle of their circles, the caption below the numbers of the ticks. */
static void texts_are_there(void **state)
{
    (void)state;
    cairo_surface_t *surface = picture();
    int middle = ZOOM * 50 + 2, below = cairo_image_surface_get_height(surface);
    assert_true(has(surface, ZOOM * 40 - 6, middle - 7, ZOOM * 40 + 10, middle + 7, SKY));
    assert_true(has(surface, ZOOM * 105 - 6, middle - 7, ZOOM * 105 + 10, middle + 7, VERMILLION));
    assert_true(has(surface, 6, ZOOM * HEIGHT + 30, 200, below, INK));
    assert_true(has(surface, ZOOM * WIDTH + 8, 0, cairo_image_surface_get_width(surface), 12, INK)); /* 0 */
    cairo_surface_destroy(surface);
}

static char *read_bytes(size_t *length)
{
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    fseek(file, 0, SEEK_END);
    *length = (size_t)ftell(file);
    rewind(file);
    char *bytes = malloc(*length);
    assert_non_null(bytes);
    assert_int_equal(fread(bytes, 1, *length, file), *length);
    fclose(file);
    return bytes;
}

static void again_the_same_bytes(void **state)
{
    size_t one, two;
    (void)state;
    cairo_surface_destroy(picture());
    char *first = read_bytes(&one);
    cairo_surface_destroy(picture());
    char *second = read_bytes(&two);
    assert_int_equal(one, two);
    assert_memory_equal(first, second, one);
    free(first);
    free(second);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(zoom_is_whole),
        cmocka_unit_test(caption_is_wrapped),
        cmocka_unit_test(numbers_need_room),
        cmocka_unit_test(other_endings_are_refused),
        cmocka_unit_test(colours_say_what_is_flagged),
        cmocka_unit_test(ticks_are_px_of_the_photo),
        cmocka_unit_test(texts_are_there),
        cmocka_unit_test(again_the_same_bytes),
    };
    int file = mkstemps(path, 4);
    if (file < 0)
        return 1;
    close(file);
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    remove(path);
    canvas_forget_fonts();
    return failed;
}
