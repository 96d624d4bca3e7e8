/* `calibration`, `calibration lens` and `calibration scale` from outside: photos of a plate that the test draws behind
 * a lens of its own formula, and lengths whose scale is known. */
#include "pipeline/speak/version.h"
#include "tests/commands.h"
#include "tests/dots.h"
#include "pipeline/files/json.h"

#include <complex.h>
#include <stdio.h>
#include <string.h>

enum { WIDTH = 480, HEIGHT = 360, TAKEN = 4, ACROSS = 17, DOWN = 13 };

/* The formula of pipeline/scene/lens.h, written again. */
struct brown {
    double x, y, k[3], p[3];
};
static const struct brown TRUTH = {246, 175, {-6e-8, 0, 0}, {4e-7, 0, 0}};

static double complex corrected(const struct brown *lens, double complex seen)
{
    double dx = creal(seen) - lens->x, dy = cimag(seen) - lens->y, r2 = dx * dx + dy * dy;
    double radial = 1 + r2 * (lens->k[0] + r2 * (lens->k[1] + r2 * lens->k[2])), more = 1 + lens->p[2] * r2;
    double x = dx * radial + (lens->p[0] * (r2 + 2 * dx * dx) + 2 * lens->p[1] * dx * dy) * more;
    double y = dy * radial + (2 * lens->p[0] * dx * dy + lens->p[1] * (r2 + 2 * dy * dy)) * more;
    return lens->x + x + I * (lens->y + y);
}

/* The inverse: what is a px off or less shrinks a hundredfold per step. */
static double complex seen_of(const struct brown *lens, double complex there)
{
    double complex seen = there;
    for (int k = 0; k < 20; k++)
        seen -= corrected(lens, seen) - there;
    return seen;
}

static double complex grid_point(int k)
{
    return (WIDTH - 1) * (k % ACROSS) / (ACROSS - 1.0) + I * ((HEIGHT - 1) * (k / ACROSS) / (DOWN - 1.0));
}

/* Root mean square per component of b - (s a + t) over the grid, s and t (turn, scale, shift) by least squares. */
static double apart(const struct brown *a, const struct brown *b)
{
    enum { N = ACROSS * DOWN };
    double complex from[N], to[N], mean_from = 0, mean_to = 0, product = 0;
    double square = 0, rest = 0;
    for (int k = 0; k < N; k++) {
        from[k] = corrected(a, grid_point(k)), to[k] = corrected(b, grid_point(k));
        mean_from += from[k] / N, mean_to += to[k] / N;
    }
    for (int k = 0; k < N; k++) {
        product += conj(from[k] - mean_from) * (to[k] - mean_to);
        square += pow(cabs(from[k] - mean_from), 2);
    }
    for (int k = 0; k < N; k++)
        rest += pow(cabs(to[k] - mean_to - product / square * (from[k] - mean_from)), 2) / N;
    return sqrt(rest / 2);
}

/* One speckled plate, moved and turned between the photos, each dot where the lens shows it. */
static void draw_plates(void)
{
    const double poses[TAKEN][3] = {{0, 0, 0}, {45, -12, 0.1}, {-38, 30, -0.12}, {6, -40, 0.05}};
    struct dots dots = dots_make(370, DOTS_NORMAL, 6000);
    for (int p = 0; p < TAKEN; p++) {
        struct canvas canvas = canvas_make(WIDTH, HEIGHT, 0.8);
        char path[40];
        for (size_t k = 0; k < dots.count; k++) {
            double complex there = 240 + poses[p][0] + I * (180 + poses[p][1]);
            there += cexp(-I * poses[p][2]) * (dots.x[k] + I * dots.y[k]);
            if (fabs(creal(there) - 240) > 280 || fabs(cimag(there) - 180) > 220)
                continue;
            double complex seen = seen_of(&TRUTH, there);
            canvas_add_dot(&canvas, creal(seen), cimag(seen), dots.sigma[k], dots.height[k], 0);
        }
        struct photo photo = canvas_photo(&canvas, 1, 0, 0.005, 6100 + (uint64_t)p);
        snprintf(path, sizeof path, "plate%d.tif", p);
        check_done(photo_write(path, &photo));
        free(photo.pixels);
        canvas_free(&canvas);
    }
    dots_free(&dots);
}

static struct brown lens_of(const cJSON *object)
{
    struct brown lens = {json_at(object, "centre_px.0"), json_at(object, "centre_px.1"), {0}, {0}};
    for (int k = 0; k < 3; k++) {
        lens.k[k] = json_at(object, "K.%d", k);
        lens.p[k] = json_at(object, "P.%d", k);
    }
    return lens;
}

/* The plate moves by at most 48 px and 7 degrees. */
#define LENS "calibration lens --radius 18 --search-px 50 --search-deg 8 "

/* The number that follows `words`. */
static double number_after(const char *text, const char *words)
{
    const char *at = strstr(text, words);
    assert_non_null(at);
    return strtod(at + strlen(words), NULL);
}

/* The picture: one dot and one arrow per place and per followed point; its captions say the lens's own numbers. */
static void check_picture(const cJSON *object, const struct brown *lens)
{
    char *svg = check_svg("lens.svg");
    double largest = 0;
    for (int k = 0; k < ACROSS * DOWN; k++)
        largest = fmax(largest, cabs(corrected(lens, grid_point(k)) - grid_point(k)));
    check_near(number_after(svg, ">correction: largest "), largest, 1e-4);
    /* Residuals of single photos are as large as rms_px says; their means over the photos are smaller. */
    double left = number_after(strstr(svg, "left at the points"), "RMS ");
    check_at_most(left, json_at(object, "rms_px"));
    check_at_most(json_at(object, "rms_px") / 4, left);
    size_t dots = text_count(svg, "stroke:none;fill-rule:nonzero"), points = (size_t)json_at(object, "points");
    assert_int_equal(text_count(svg, "stroke-width:1;"), dots + 2); /* and two frames */
    assert_true(dots >= ACROSS * DOWN + points / (TAKEN - 1));
    free(svg);
}

static void a_drawn_plate_gives_its_lens(void **state)
{
    (void)state;
    const struct brown none = {240, 180, {0}, {0}};
    command_done(LENS "--reference plate0.tif plate1.tif plate2.tif plate3.tif -o lens.json --picture lens.svg");
    cJSON *object = json_of("lens.json", "film.lens/1");
    struct brown found = lens_of(object);
    assert_string_equal(json_text_at(object, "map"), "corrected from seen");
    assert_true(apart(&none, &TRUTH) > 0.1);
    check_at_most(apart(&found, &TRUTH), 0.01);
    check_at_most(apart(&found, &TRUTH), 4 * json_at(object, "s_map_px"));
    check_at_most(json_at(object, "s_map_px"), 0.01);
    check_near(json_at(object, "photos"), TAKEN - 1, 0);
    check_near(json_at(object, "size_px.0"), WIDTH, 0);
    check_near(json_at(object, "size_px.1"), HEIGHT, 0);
    for (int a = 0; a < 8; a++)
        for (int b = 0; b < 8; b++) {
            double value = json_at(object, "covariance.%d.%d", a, b);
            check_near(value, json_at(object, "covariance.%d.%d", b, a), 1e-9 * fabs(value));
        }
    check_picture(object, &found);
    cJSON_Delete(object);
}

static void what_is_no_plate_is_refused(void **state)
{
    (void)state;
    struct canvas canvas = canvas_make(WIDTH, HEIGHT, 0.5);
    struct photo photo = canvas_photo(&canvas, 1, 0, 0, 1);
    check_done(photo_write("blank.tif", &photo));
    photo.height -= 60;
    check_done(photo_write("small.tif", &photo));
    free(photo.pixels);
    canvas_free(&canvas);
    command_fails(2, "--reference is needed", "calibration lens plate1.tif plate2.tif -o no.json");
    command_fails(2, "give at least 2 photos", "calibration lens --reference plate0.tif plate1.tif -o no.json");
    command_fails(2, "--radius 2: give a number from 8 to 1000",
                  "calibration lens --radius 2 --reference plate0.tif plate1.tif plate2.tif -o no.json");
    command_fails(3, "missing.tif", LENS "--reference missing.tif plate1.tif plate2.tif -o no.json");
    command_fails(3, "missing.tif", LENS "--reference plate0.tif missing.tif plate2.tif -o no.json");
    command_fails(3, "small.tif", LENS "--reference plate0.tif small.tif plate1.tif -o no.json");
    command_fails(3, "points", LENS "--reference blank.tif blank.tif blank.tif -o no.json");
    command_fails(1, "no/lens.svg",
                  LENS "--reference plate0.tif plate1.tif plate2.tif -o kept.json --picture no/lens.svg");
    assert_true(file_exists("kept.json"));
    assert_false(file_exists("no.json"));
}

/* ---- scale ---- */

/* By hand: 3, 4, 5 triangles of 50 and 100 px; the second length is 2 % long against the first. */
static void lengths_give_the_scale(void **state)
{
    (void)state;
    command_done("calibration scale 10,20,40,60,5e-3 -o one.json");
    cJSON *object = json_of("one.json", "film.scale/1");
    check_near(json_at(object, "scale_m_per_px"), 1e-4, 1e-16);
    check_near(json_at(object, "s_scale_m_per_px"), 1e-4 * sqrt(2) * 0.5 / 50, 1e-16);
    assert_true(isnan(json_at(object, "scatter_px")));
    cJSON_Delete(object);

    command_done("calibration scale --error-px 0.1 10,20,40,60,5e-3 0,0,60,80,1.02e-2 -o two.json");
    object = json_of("two.json", "film.scale/1");
    double scale = (50 * 5e-3 + 100 * 1.02e-2) / (50 * 50 + 100 * 100);
    double scatter = hypot(5e-3 / scale - 50, 1.02e-2 / scale - 100); /* larger than the error of a mark */
    check_near(json_at(object, "lengths"), 2, 0);
    check_near(json_at(object, "scale_m_per_px") / scale, 1, 1e-12);
    check_near(json_at(object, "scatter_px"), scatter, 1e-9);
    check_near(json_at(object, "s_scale_m_per_px") / (scale * scatter / sqrt(12500)), 1, 1e-9);
    cJSON_Delete(object);
}

/* Marks seen through a strong lens of known parameters, 2e-4 m/px behind it. */
static void the_lens_is_undone_first(void **state)
{
    (void)state;
    const struct brown strong = {250, 170, {-2e-7, 1e-13, 0}, {1e-6, -5e-7, 0}};
    double complex a = seen_of(&strong, 20 + 15 * I), b = seen_of(&strong, 460 + 345 * I);
    file_write("strong.json", "{\"schema\": \"film.lens/1\", \"map\": \"corrected from seen\", \"centre_px\": [250, "
                              "170], \"K\": [-2e-7, 1e-13, 0], \"P\": [1e-6, -5e-7, 0]}");
    for (int with = 0; with < 2; with++) {
        command_done("calibration scale %s %.15g,%.15g,%.15g,%.15g,%.15g -o lensed.json",
                     with ? "--lens strong.json" : "", creal(a), cimag(a), creal(b), cimag(b), 2e-4 * hypot(440, 330));
        cJSON *object = json_of("lensed.json", "film.scale/1");
        double off = json_at(object, "scale_m_per_px") / 2e-4 - 1;
        if (with)
            check_near(off, 0, 1e-10);
        else
            assert_true(fabs(off) > 1e-3);
        cJSON_Delete(object);
    }
}

static void wrong_lengths_are_refused(void **state)
{
    (void)state;
    command_fails(2, "which length?", "calibration scale -o no.json");
    command_fails(2, "--error-px x", "calibration scale --error-px x 0,0,3,4,1 -o no.json");
    command_fails(3, "length '0,0,3,4'", "calibration scale 0,0,3,4 -o no.json");
    command_fails(3, "length '0,0,3,4,1m'", "calibration scale 0,0,3,4,1m -o no.json");
    command_fails(3, "length 2: 0 px", "calibration scale 0,0,3,4,1 7,7,7,7,1 -o no.json");
    command_fails(3, "length 1: 5 px, -1 m", "calibration scale 0,0,3,4,-1 -o no.json");
    command_fails(1, "no/scale.json", "calibration scale 0,0,3,4,1 -o no/scale.json");
    command_fails(3, "missing.json", "calibration scale --lens missing.json 0,0,3,4,1 -o no.json");
    assert_false(file_exists("no.json"));
}

static void the_program_lists_its_commands(void **state)
{
    (void)state;
    static const char *const names[] = {"lens",     "scale", "stiffness", "rescale",
                                        "friction", "hertz", "laws",      "settlement"};
    command_done("calibration --help");
    for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
        char line[40];
        snprintf(line, sizeof line, "\n  %-10s ", names[k]);
        assert_int_equal(text_count(command_out, line), 1);
    }
    for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
        command_done("calibration %s --help", names[k]);
        assert_non_null(strstr(command_out, names[k]));
    }
    command_done("calibration --version");
    char version[100];
    snprintf(version, sizeof version, "calibration (film) %s\n", film_version);
    assert_string_equal(command_out, version);
    command_fails(2, "there is no such command", "calibration length");
    command_fails(2, "which command?", "calibration");
}

static int begin(void **state)
{
    if (folder_enter(state))
        return -1;
    draw_plates();
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_drawn_plate_gives_its_lens), cmocka_unit_test(what_is_no_plate_is_refused),
        cmocka_unit_test(lengths_give_the_scale),       cmocka_unit_test(the_lens_is_undone_first),
        cmocka_unit_test(wrong_lengths_are_refused),    cmocka_unit_test(the_program_lists_its_commands),
    };
    return cmocka_run_group_tests(tests, begin, folder_leave);
}
