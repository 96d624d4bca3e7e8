/* The page warns of what is beyond its limits, and of nothing that is within: each limit from both sides. */
#include "tests/check.h"

#include <math.h>
#include <string.h>

#include "pipeline/scene/scene.h"
#include "report/page/page.h"

/* One state of one method: everything as it should be. */
struct state_of_one {
    struct series series;
    struct series_row row;
    char path[8], name[8];
};

static void make(struct state_of_one *one)
{
    *one = (struct state_of_one){.path = "path", .name = "0007"};
    struct force_summary *forces = &one->row.packing.forces[0];
    snprintf(forces->method, sizeof forces->method, "map");
    forces->converged = 1;
    forces->iterations = 5;
    forces->overlaps_over_loads = 1;
    for (int axis = 0; axis < 2; axis++)
        forces->weber[axis][axis] = one->row.packing.applied[axis][axis] = 1000;
    one->row.tracks = (struct photo_summary){.path = one->path, .grains = 1000, .zncc.middle = 0.99};
    one->row.packing.path = one->path;
    one->row.packing.force_count = 1;
    one->row.name = one->name;
    one->series.rows = &one->row;
    one->series.count = 1;
}

/* 1 when the page warns with these words; it may not warn of anything else. */
static int warns(struct state_of_one *one, const char *words)
{
    const struct scene scene = {0};
    struct html html;
    check_done(html_begin(&html));
    check_done(page_warnings(&scene, &one->series, &html));
    check_done(html_end(&html));
    int found = strstr(html.text, words) != NULL, any = strstr(html.text, "<h2>Warnings</h2>") != NULL;
    assert_int_equal(found, any);
    html_free(&html);
    return any;
}

/* `value` just within its limit and just beyond. */
static void check_limit(struct state_of_one *one, double *value, double within, double beyond, const char *words)
{
    double kept = *value;
    *value = within;
    assert_false(warns(one, words));
    *value = beyond;
    assert_true(warns(one, words));
    *value = kept;
}

static void test_limits_of_forces(void **state)
{
    (void)state;
    struct state_of_one one;
    make(&one);
    struct force_summary *forces = &one.row.packing.forces[0];
    assert_false(warns(&one, "anything"));
    check_limit(&one, &forces->weber[0][0], 1099, 1101, "stress xx is more than 10 % off");
    check_limit(&one, &forces->weber[0][0], 901, 899, "stress xx is more than 10 % off");
    check_limit(&one, &forces->weber[1][1], 901, 899, "stress yy is more than 10 % off");
    check_limit(&one, &forces->imbalance, 0.049, 0.051, "unbalanced force above 0.05");
    check_limit(&one, &forces->data_misfit, 1.49, 1.51, "misfit above 1.5");
    check_limit(&one, &forces->overlaps_over_loads, 1.39, 1.41, "more than 1.4 times the loads");
    check_limit(&one, &forces->overlaps_over_loads, 1 / 1.39, 1 / 1.41, "more than 1.4 times the overlaps");
    forces->converged = 0;
    assert_true(warns(&one, "did not converge"));
}

static void test_limits_of_photos(void **state)
{
    (void)state;
    struct state_of_one one;
    make(&one);
    check_limit(&one, &one.row.tracks.zncc.middle, 0.901, 0.899, "1 - median ZNCC above 0.1");
    one.row.tracks.distrusted = 50;
    assert_false(warns(&one, "flagged as not to be trusted"));
    one.row.tracks.distrusted = 51;
    assert_true(warns(&one, "flagged as not to be trusted"));
    one.row.tracks.distrusted = 0;
    one.row.packing.floating = 1;
    assert_true(warns(&one, "grains float"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_limits_of_forces),
                                       cmocka_unit_test(test_limits_of_photos)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
