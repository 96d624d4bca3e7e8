/* loads.csv: its three headers, its empty cells, and each mistake with its line. Truth: a rectangle of walls of known
 * lengths under a known stress, by hand. */
#include "tests/check.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "pipeline/speak/error.h"
#include "pipeline/packing/loads.h"

static const char name[] = "test_loads.csv.tmp";

static void write_text(const char *text)
{
    FILE *file = fopen(name, "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
    error_clear();
}

/* A frame 2 m wide and 3 m high, counter-clockwise, turned by `angle` about its lower left corner. */
static void make_walls(struct walls *walls, double angle)
{
    static const char *const names[] = {"bottom", "right", "top", "left"};
    const struct vec corner[] = {{0, 0}, {2, 0}, {2, 3}, {0, 3}};
    memset(walls, 0, sizeof *walls);
    check_done(table_alloc(&WALLS, walls, 4, NULL));
    for (int k = 0; k < 4; k++) {
        struct vec from = vec_rotate(corner[k], angle), to = vec_rotate(corner[(k + 1) % 4], angle);
        strncpy(walls->name[k], names[k], NAME_LENGTH);
        walls->x0[k] = from.x;
        walls->y0[k] = from.y;
        walls->x1[k] = to.x;
        walls->y1[k] = to.y;
        walls->radius[k] = 0;
    }
}

enum { BOTTOM, RIGHT, TOP, LEFT };

static void check_load(const struct walls *walls, int w, double fx, double fy)
{
    check_near(walls->fx[w], fx, 1e-12 * (1 + fabs(fx)));
    check_near(walls->fy[w], fy, 1e-12 * (1 + fabs(fy)));
}

static void by_wall(void **state)
{
    (void)state;
    struct walls walls;
    make_walls(&walls, 0);
    write_text("index,wall,fx_N,fy_N\n0,top,1,2\n5,top, 0 ,-1500.5\r\n\n5,right,-2e3,\n6,top,9,9\n");
    check_done(loads_apply(name, 5, NAN, &walls));
    check_load(&walls, TOP, 0, -1500.5);
    check_near(walls.fx[RIGHT], -2000, 0);
    assert_true(isnan(walls.fy[RIGHT]));
    assert_true(isnan(walls.fx[LEFT]) && isnan(walls.fy[LEFT]) && isnan(walls.fx[BOTTOM]));
    table_free(&WALLS, &walls);
}

static void by_stress(void **state)
{
    (void)state;
    struct walls walls;
    make_walls(&walls, 0);
    write_text("\xEF\xBB\xBFindex, sxx_Pa, syy_Pa, sxy_Pa\n3,100,200,10\n");
    check_done(loads_apply(name, 3, 0.5, &walls));
    /* Compression pushes inwards: right wall (3 m x 0.5 m): -sxx on x, -sxy on y. */
    check_load(&walls, RIGHT, -150, -15);
    check_load(&walls, LEFT, 150, 15);
    check_load(&walls, TOP, -10, -200);
    check_load(&walls, BOTTOM, 10, 200);
    /* The loads of a closed frame are in balance, also their moment about the corner: sxy is symmetric. */
    table_free(&WALLS, &walls);
    assert_int_equal((make_walls(&walls, 0), loads_apply(name, 3, NAN, &walls)), -1);
    assert_non_null(strstr(error_message(), "grains.length_m"));
    table_free(&WALLS, &walls);
}

/* A pressure stays along the normal of a turned frame. */
static void by_stress_turned(void **state)
{
    (void)state;
    struct walls walls;
    make_walls(&walls, 0.3);
    write_text("index,sxx_Pa,syy_Pa,sxy_Pa\n0,100,100,0\n");
    check_done(loads_apply(name, 0, 1, &walls));
    check_load(&walls, RIGHT, -300 * cos(0.3), -300 * sin(0.3));
    check_load(&walls, TOP, 200 * sin(0.3), -200 * cos(0.3));
    table_free(&WALLS, &walls);
}

/* An empty syy: top and bottom are fixed, the side walls of a slightly turned frame stay loaded. */
static void a_component_that_is_not_known(void **state)
{
    (void)state;
    struct walls walls;
    make_walls(&walls, 0.01);
    write_text("index,sxx_Pa,syy_Pa,sxy_Pa\n0,100,,0\n");
    check_done(loads_apply(name, 0, 1, &walls));
    check_near(walls.fx[RIGHT], -300 * cos(0.01), 1e-10);
    check_near(walls.fy[RIGHT], 0, 1e-10);
    assert_true(isnan(walls.fy[TOP]) && isnan(walls.fy[BOTTOM]));
    table_free(&WALLS, &walls);
}

static void by_corner(void **state)
{
    (void)state;
    struct walls walls;
    make_walls(&walls, 0);
    write_text("index,corner,fx_N,fy_N\n0,bottom-left,1,2\n0,bottom-right,-3,4\n0,top-left,5,-7\n");
    check_done(loads_apply(name, 0, NAN, &walls));
    /* The fourth hinge: minus the sum, (-3, 1). Each wall takes half of the two at its ends. */
    check_load(&walls, BOTTOM, -1, 3);
    check_load(&walls, RIGHT, -3, 2.5);
    check_load(&walls, TOP, 1, -3);
    check_load(&walls, LEFT, 3, -2.5);
    write_text("index,corner,fx_N,fy_N\n0,bottom-left,1,2\n0,top-left,5,-7\n");
    assert_int_equal(loads_apply(name, 0, NAN, &walls), -1);
    assert_non_null(strstr(error_message(), "'bottom-right' and 'top-right' are missing"));
    table_free(&WALLS, &walls);
}

static void check_refused(const char *text, const char *expected)
{
    struct walls walls;
    make_walls(&walls, 0);
    write_text(text);
    int status = loads_apply(name, 0, 1, &walls);
    if (status != -1 || !strstr(error_message(), expected))
        print_error("text: %s\nexpected: %s\nmessage: %s\n", text, expected, error_message());
    assert_int_equal(status, -1);
    assert_int_equal(error_status(), EXIT_INPUT);
    assert_non_null(strstr(error_message(), expected));
    assert_non_null(strstr(error_message(), name));
    table_free(&WALLS, &walls);
}

static void mistakes(void **state)
{
    (void)state;
    check_refused("", "the first line must be one of");
    check_refused("0,top,1,2\n", ":1: the first line must be one of");
    check_refused("index,wall,fx,fy\n0,top,1,2\n", ":1: the first line must be one of");
    check_refused("index;wall;fx_N;fy_N\n0;top;1,5;2\n", ":1: the cells are separated by ';'");
    check_refused("index,wall,fx_N,fy_N\n1,top,1,2\n", "no row for photo 0");
    check_refused("index,wall,fx_N,fy_N\n", "no row for photo 0");
    check_refused("index,wall,fx_N,fy_N\n0,top,1,2\n0,top,1,2\n", ":3: photo 0 has this load twice");
    check_refused("index,wall,fx_N,fy_N\n0,up,1,2\n", ":2: unknown wall 'up': give one of: bottom, right");
    check_refused("index,wall,fx_N,fy_N\n7,up,1,2\n0,top,1,2\n", ":2: unknown wall"); /* in any row */
    check_refused("index,corner,fx_N,fy_N\n0,top,1,2\n", ":2: unknown corner 'top'");
    check_refused("index,wall,fx_N,fy_N\n\n\n0x0,top,1,2\n", ":4: '0x0' is no index");
    check_refused("index,wall,fx_N,fy_N\n-1,top,1,2\n", ":2: '-1' is no index");
    check_refused("index,wall,fx_N,fy_N\n,top,1,2\n", ":2: '' is no index");
    check_refused("index,wall,fx_N,fy_N\n0,top,1e999,2\n", ":2: '1e999' is not a number");
    check_refused("index,wall,fx_N,fy_N\n0,top,nan,2\n", ":2: 'nan' is not a number");
    check_refused("index,wall,fx_N,fy_N\n0,top,1,2,3\n", ":2: 5 cells");
    check_refused("index,wall,fx_N,fy_N\n0,top,1\n", ":2: 3 cells");
    check_refused("index,sxx_Pa,syy_Pa,sxy_Pa\n0,1,2,x\n", ":2: 'x' is not a number");
    assert_int_equal(loads_apply("no-such.csv", 0, 1, NULL), -1);
    assert_int_equal(error_status(), EXIT_INPUT);
}

static void a_wall_that_is_not_there(void **state)
{
    (void)state;
    struct walls walls = {0};
    write_text("index,wall,fx_N,fy_N\n0,top,1,2\n");
    assert_int_equal(loads_apply(name, 0, 1, &walls), -1);
    assert_non_null(strstr(error_message(), "there is no wall 'top'"));
    table_free(&WALLS, &walls);
}

static void check_refused_of_all(const char *text, const char *words)
{
    static const int64_t photos[] = {3, 4, 6};
    struct loads_press press;
    write_text(text);
    assert_int_equal(loads_check(name, photos, 3, &press), -1);
    assert_int_equal(error_status(), EXIT_INPUT);
    if (!strstr(error_message(), words))
        fail_msg("'%s' does not say '%s'", error_message(), words);
}

/* What a series needs is looked at before its first photo is: rows in any order, others may be missing or twice. */
static void all_photos_of_a_series(void **state)
{
    static const int64_t photos[] = {3, 4, 6};
    struct loads_press press;
    (void)state;
    write_text("index,wall,fx_N,fy_N\n6,top,0,-3\n3,top,0,-1\n4,top,0,-2\n5,top,0,9\n5,top,0,9\n");
    check_done(loads_check(name, photos, 3, &press));
    check_near(press.most, 3, 1e-12);
    assert_false(press.per_area);
    write_text("index,corner,fx_N,fy_N\n3,top-left,2,-2\n3,top-right,-2,-2\n3,bottom-left,2,2\n");
    check_done(loads_check(name, photos, 1, &press));
    check_near(press.most, 2, 1e-12);
    write_text("index,sxx_Pa,syy_Pa,sxy_Pa\n3,100,200,\n4,,500,\n");
    check_done(loads_check(name, photos, 2, &press));
    check_near(press.most, 500, 1e-12);
    assert_true(press.per_area);
    check_refused_of_all("index,wall,fx_N,fy_N\n3,top,0,-1\n6,top,0,-3\n", "no row for photo 4");
    check_refused_of_all("index,wall,fx_N,fy_N\n3,top,0,-1\n4,top,0,-2\n6,top,0,-3\n4,left,1,\n4,top,0,-2\n",
                         ":6: photo 4 has this load twice");
}

/* Of every kind of table; a load cell that shows a little less than nothing is forgiven. */
static void loads_that_pull(void **state)
{
    static const int64_t photos[] = {3, 4, 6};
    struct loads_press press;
    (void)state;
    check_refused_of_all("index,wall,fx_N,fy_N\n3,top,0,-1\n4,top,0,2\n4,right,1,\n6,top,0,-3\n",
                         "photo 4: the loads pull outwards");
    check_refused_of_all("index,sxx_Pa,syy_Pa,sxy_Pa\n3,1,1,0\n4,1,,0\n6,-1e4,-1e5,\n", "photo 6: the loads pull");
    check_refused_of_all("index,corner,fx_N,fy_N\n3,top-left,-1,1\n3,top-right,1,1\n3,bottom-left,-1,-1\n",
                         "photo 3: the loads pull");
    write_text("index,wall,fx_N,fy_N\n3,top,0,0.5\n4,top,0,-50\n6,top,,-100\n");
    check_done(loads_check(name, photos, 3, &press));
    check_done(loads_check(name, photos, 1, &press));
}

static int remove_file(void **state)
{
    (void)state;
    return unlink(name);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(by_wall),
        cmocka_unit_test(by_stress),
        cmocka_unit_test(by_stress_turned),
        cmocka_unit_test(a_component_that_is_not_known),
        cmocka_unit_test(by_corner),
        cmocka_unit_test(mistakes),
        cmocka_unit_test(a_wall_that_is_not_there),
        cmocka_unit_test(all_photos_of_a_series),
        cmocka_unit_test(loads_that_pull),
    };
    return cmocka_run_group_tests_name("loads", tests, NULL, remove_file);
}
