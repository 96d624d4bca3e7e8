/* The linear law and the Coulomb wedge, by hand. */
#include "tests/check.h"

#include <math.h>
#include <string.h>

#include "pipeline/laws/contact_spring.h"
#include "pipeline/speak/error.h"
#include "pipeline/packing/forces.h"
#include "pipeline/files/json.h"

static const struct contact_law law = {.row = &linear_law, .kn = 1000, .kt_over_kn = 0.5, .mu = 0.4};

static void overlap_gives_force(void **state)
{
    (void)state;
    const struct contact_law unknown = CONTACT_LAW_DEFAULT;
    struct contact_pair pair = contact_pair_of(&law, 1), none = contact_pair_of(&unknown, 1);
    check_near(contact_pair_force(&law, &pair, 0.002), 2, 1e-15);
    check_near(contact_pair_force(&law, &pair, 0), 0, 0);
    check_near(contact_pair_force(&law, &pair, -0.002), 0, 0); /* a gap pulls at nothing */
    assert_true(isnan(contact_pair_force(&unknown, &none, 1)));
    assert_true(contact_law_known(&law));
    assert_false(contact_law_known(&unknown));
}

static void increments(void **state)
{
    (void)state;
    double fn = 1, ft = 0.1;
    struct contact_pair pair = contact_pair_of(&law, 1);
    /* Approach by 1 mm (un < 0), slide by 0.2 mm: dfn = 1 N, dft = -0.1 N. */
    assert_int_equal(contact_pair_advance(&law, &pair, 0.4, -0.001, 0.0002, &fn, &ft), STATUS_STICK);
    check_near(fn, 2, 1e-15);
    check_near(ft, 0, 1e-15);
    /* Slide by 2 mm: dft = -1 N, beyond mu fn = 0.8 N. */
    assert_int_equal(contact_pair_advance(&law, &pair, 0.4, 0, 0.002, &fn, &ft), STATUS_SLIP);
    check_near(fn, 2, 1e-15);
    check_near(ft, -0.8, 1e-15);
    /* Part by 3 mm: open, no force left. */
    assert_int_equal(contact_pair_advance(&law, &pair, 0.4, 0.003, 0, &fn, &ft), STATUS_OPEN);
    check_near(fn, 0, 0);
    check_near(ft, 0, 0);
}

static void wedge(void **state)
{
    (void)state;
    double fn = 10, ft = 3;
    assert_int_equal(coulomb_clip(0.3, &fn, &ft), STATUS_STICK); /* the edge itself still sticks */
    fn = 10, ft = 7;
    assert_int_equal(coulomb_clip(0.3, &fn, &ft), STATUS_SLIP);
    check_near(fn, 10, 0); /* vertical projection: fn stays */
    check_near(ft, 3, 1e-15);
    fn = 10, ft = -7;
    coulomb_clip(0, &fn, &ft);
    check_near(ft, 0, 0);
    fn = -1, ft = 7;
    assert_int_equal(coulomb_clip(0.3, &fn, &ft), STATUS_OPEN);
    check_near(fn, 0, 0);
    check_near(ft, 0, 0);
    fn = NAN, ft = 7;
    assert_int_equal(coulomb_clip(0.3, &fn, &ft), STATUS_NOT_USED); /* a missing number is not an open contact */
    assert_true(isnan(fn) && isnan(ft));
    fn = 7, ft = NAN;
    assert_int_equal(coulomb_clip(0.3, &fn, &ft), STATUS_NOT_USED);
    assert_true(isnan(fn) && isnan(ft));
}

static int read_law(const char *text, struct contact_law *read)
{
    struct json *json = json_parse(text, strlen(text), "t.json");
    assert_non_null(json);
    int status = contact_law_read(json, json_root(json), read);
    json_free(json);
    return status;
}

static void from_the_scene(void **state)
{
    (void)state;
    struct contact_law read;
    check_done(read_law("{}", &read));
    assert_true(isnan(read.kn) && isnan(read.mu));
    check_near(read.kt_over_kn, 1, 0);
    check_near(read.mu_wall, 0, 0);
    check_done(read_law("{\"law\": \"linear\", \"kn_N_per_m\": 5e7, \"mu\": 0.5}", &read));
    check_near(read.kn, 5e7, 0);
    assert_int_equal(read_law("{\"kn\": 5e7}", &read), -1);
    assert_non_null(strstr(error_message(), "did you mean 'kn_N_per_m'?"));
    check_near(read.kn, 5e7, 0); /* untouched after a failure */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(overlap_gives_force),
        cmocka_unit_test(increments),
        cmocka_unit_test(wedge),
        cmocka_unit_test(from_the_scene),
    };
    return cmocka_run_group_tests_name("contact_law", tests, NULL, NULL);
}
