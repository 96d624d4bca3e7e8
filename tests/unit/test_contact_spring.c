/* Contact laws against their closed forms (docs/theory.md section 5), integrals done here by small steps, and cycles
 * that must not create energy. */
#include "tests/check.h"

#include <math.h>

#include "pipeline/laws/contact_spring.h"

static const double PI = 3.141592653589793;
/* Tolomeo and McDowell 2022: ballast. */
static const struct contact_law ROUGH = {.row = &pohrt_popov_law,
                                         .young = 60e9,
                                         .poisson = 0.25,
                                         .kt_over_kn = 2 * 0.75 / 1.75,
                                         .fractal = 2.13,
                                         .roughness = 2.61e-5};
static const double RADIUS = 2.36e-3;

static struct contact_law law_of(const struct law *row)
{
    struct contact_law law = ROUGH;
    law.row = row;
    if (row->linear)
        law.kn = 1e7;
    return law;
}

static void ballast_has_the_published_numbers(void **state)
{
    (void)state;
    struct contact_pair pair = contact_pair_of(&ROUGH, RADIUS);
    check_near(pair.area, 6.68e-7, 0.002 * 6.68e-7); /* R is published to 0.2 % */
    check_near(pair.threshold, 1775, 0.002 * 1775);
    double below = contact_pair_stiffness(&ROUGH, &pair, pair.threshold * (1 - 1e-12));
    double above = contact_pair_stiffness(&ROUGH, &pair, pair.threshold * (1 + 1e-12));
    check_near(below, above, 1e-9 * above);
    check_near(above, 2.95e7, 0.01e7);
}

static void hertz_is_hertz(void **state)
{
    (void)state;
    struct contact_law law = law_of(&hertz_mindlin_law);
    struct contact_pair pair = contact_pair_of(&law, RADIUS);
    double modulus = 60e9 / (2 * (1 - 0.0625)), x = 3e-6, force = 4.0 / 3 * modulus * sqrt(RADIUS) * pow(x, 1.5);
    check_near(contact_pair_force(&law, &pair, x), force, 1e-12 * force);
    check_near(contact_pair_overlap(&law, &pair, force), x, 1e-12 * x);
    double shear = 60e9 / (2 * 1.25), kt = 8 * shear / (2 * (2 - 0.25)) * sqrt(RADIUS * x);
    struct contact_spring spring = {0};
    contact_spring_press(&law, &pair, x, &spring);
    check_near(spring.stiffness, 2 * modulus * sqrt(RADIUS * x), 1e-12 * spring.stiffness);
    check_near(law.kt_over_kn * spring.stiffness, kt, 1e-12 * kt);
    /* PFC: fn = 2 (2 r)^1/2 G / (3 (1 - nu)) x^3/2, k = (3 r G^2 fn / (1 - nu)^2)^1/3 with r = 2 R1 R2 / (R1 + R2) = 2
     * R */
    law = law_of(&hertz_pfc_law);
    double r = 2 * RADIUS, fn = 2 * sqrt(2 * r) * shear / (3 * 0.75) * pow(x, 1.5);
    check_near(contact_pair_force(&law, &pair, x), fn, 1e-12 * fn);
    double kn = cbrt(3 * r * shear * shear * fn / (0.75 * 0.75));
    check_near(contact_pair_stiffness(&law, &pair, fn), kn, 1e-12 * kn);
}

/* dF = k(F) dx by the midpoint rule from 0 against the closed form, below and above the threshold. */
static void rough_loading_is_the_integral_of_its_stiffness(void **state)
{
    (void)state;
    struct contact_pair pair = contact_pair_of(&ROUGH, RADIUS);
    double a = 0.2567 * 2.13, E = 60e9 / (2 * (1 - 0.0625)), root = sqrt(pair.area);
    double x = contact_pair_overlap(&ROUGH, &pair, 10), dx = 1e-9;
    for (double f = 10; f < 3500;) {
        double half = f;
        for (int pass = 0; pass < 3; pass++) { /* F at the middle of the step */
            double k = half < pair.threshold ? PI / 10 * 2.13 * E * root * pow(half / (2.61e-5 * E * root), a)
                                             : cbrt(6 * E * E * half * RADIUS);
            half = f + 0.5 * dx * k;
        }
        f = 2 * half - f;
        x += dx;
        check_near(contact_pair_force(&ROUGH, &pair, x), f, 2e-6 * f);
        check_near(contact_pair_overlap(&ROUGH, &pair, f), x, 2e-6 * x);
    }
    check_near(contact_pair_force(&ROUGH, &pair, contact_pair_overlap(&ROUGH, &pair, 3)), 3, 1e-12);
}

static double press(const struct contact_law *law, const struct contact_pair *pair, double x, struct contact_spring *s)
{
    contact_spring_press(law, pair, x, s);
    return s->fn;
}

static void plastic_unloading_and_reloading(void **state)
{
    (void)state;
    struct contact_law law = law_of(&pohrt_popov_plastic_law);
    struct contact_pair pair = contact_pair_of(&law, RADIUS);
    struct contact_spring spring = {0};
    double E = 60e9 / (2 * (1 - 0.0625)), top = contact_pair_overlap(&law, &pair, 800);
    check_near(press(&law, &pair, top, &spring), 800, 1e-9);
    /* Hertz's stiffness at F: (6 E^2 F R)^1/3, by a difference quotient. */
    double dx = 1e-11, f0 = press(&law, &pair, top - 1e-7, &spring), f1 = press(&law, &pair, top - 1e-7 + dx, &spring);
    check_near((f1 - f0) / dx, cbrt(6 * E * E * f0 * RADIUS), 1e-4 * (f1 - f0) / dx);
    /* No force is left while the surfaces still overlap; reloading comes back to the peak, then goes on as virgin. */
    double left = top - 1.5 * cbrt(800.0 * 800) / cbrt(6 * E * E * RADIUS);
    assert_true(left > 0.1 * top);
    check_near(press(&law, &pair, 0.99 * left, &spring), 0, 0);
    check_near(press(&law, &pair, left + 0.5 * (top - left), &spring), 800 * pow(0.5, 1.5), 1e-9);
    check_near(press(&law, &pair, top, &spring), 800, 1e-9);
    double more = contact_pair_overlap(&law, &pair, 1200);
    check_near(press(&law, &pair, more, &spring), 1200, 1e-9);
    check_near(spring.peak, 1200, 1e-9);
    /* Elastic: back on the way it came. */
    struct contact_spring elastic = {0};
    press(&ROUGH, &pair, top, &elastic);
    check_near(press(&ROUGH, &pair, 0.5 * top, &elastic), contact_pair_force(&ROUGH, &pair, 0.5 * top), 0);
}

/* Stored energy is the integral of F dx up to here (plastic: from here down). */
static void stored_energy_is_the_work(void **state)
{
    (void)state;
    static const struct law *const rows[] = {&linear_law, &hertz_mindlin_law, &pohrt_popov_law,
                                             &pohrt_popov_plastic_law};
    for (size_t k = 0; k < 4; k++) {
        struct contact_law law = law_of(rows[k]);
        struct contact_pair pair = contact_pair_of(&law, RADIUS);
        double top = contact_pair_overlap(&law, &pair, 3000), work = 0;
        struct contact_spring spring = {0};
        press(&law, &pair, top, &spring);
        double stored = contact_spring_energy(&law, &pair, top, &spring);
        int steps = 200000;
        for (int n = 0; n < steps; n++)
            work += press(&law, &pair, top * (n + 0.5) / steps, &spring) * top / steps;
        check_near(stored, work, 1e-6 * work);
    }
}

/* Load, shear, unload, shear back: the work done on the contact over a closed path is never negative. */
static void cycles_create_no_energy(void **state)
{
    (void)state;
    static const struct law *const rows[] = {&linear_law, &hertz_mindlin_law, &pohrt_popov_law,
                                             &pohrt_popov_plastic_law};
    uint64_t random = 3;
    for (size_t k = 0; k < 4; k++)
        for (int trial = 0; trial < 50; trial++) {
            struct contact_law law = law_of(rows[k]);
            struct contact_pair pair = contact_pair_of(&law, RADIUS);
            struct contact_spring spring = {0};
            double top = contact_pair_overlap(&law, &pair, 500), work = 0, size = 0;
            double p[4], q[4]; /* a closed smooth path: overlap and slide as sums of waves */
            for (int w = 0; w < 4; w++)
                p[w] = check_uniform(&random), q[w] = 2 * PI * check_uniform(&random);
            double last_x = NAN, last_y = 0, last_fn = 0, last_ft = 0;
            int steps = 4000;
            for (int n = 0; n <= 2 * steps; n++) { /* first round: to settle; second: to judge */
                double s = 2 * PI * n / steps;
                double x = top * (1 + 0.4 * p[0] * sin(s + q[0]) + 0.4 * p[1] * sin(2 * s + q[1]));
                double y = top * (0.5 * p[2] * sin(s + q[2]) + 0.5 * p[3] * sin(3 * s + q[3]));
                double before = n ? spring.stiffness : 0;
                press(&law, &pair, x, &spring);
                contact_spring_slide(&law, before, n ? y - last_y : 0, &spring);
                if (n > steps) {
                    double part[2] = {0.5 * (spring.fn + last_fn) * (x - last_x),
                                      -0.5 * (spring.ft + last_ft) * (y - last_y)};
                    work += part[0] + part[1];
                    size += fabs(part[0]) + fabs(part[1]);
                }
                last_x = x, last_y = y, last_fn = spring.fn, last_ft = spring.ft;
            }
            check_at_most(-work, 1e-4 * size);
            if (law.row->linear)
                check_near(work, 0, 1e-9 * size);
        }
}

/* 10^5 steps along a random path with friction and separations: what was done on the contact is never less than what it
 * stores, and not negative whenever it has parted. */
static void random_paths_create_no_energy(void **state)
{
    (void)state;
    enum { CORNERS = 200, LEG = 500 };
    static const struct law *const rows[] = {&linear_law, &hertz_mindlin_law, &pohrt_popov_law,
                                             &pohrt_popov_plastic_law};
    uint64_t random = 17;
    for (size_t k = 0; k < 4; k++) {
        struct contact_law law = law_of(rows[k]);
        struct contact_pair pair = contact_pair_of(&law, RADIUS);
        struct contact_spring spring = {0};
        double top = contact_pair_overlap(&law, &pair, 500), work = 0, size = 0, x = 0, y = 0;
        double excess = 0; /* of what is stored over what was done: largest */
        int partings = 0;
        for (int corner = 0; corner < CORNERS; corner++) {
            double dx = (top * (1.8 * check_uniform(&random) - 0.3) - x) / LEG;
            double dy = top * (check_uniform(&random) - 0.5) / LEG;
            for (int n = 0; n < LEG; n++, x += dx, y += dy) {
                double fn = spring.fn, ft = spring.ft, before = spring.stiffness;
                if (x + dx > 0) {
                    press(&law, &pair, x + dx, &spring);
                    contact_spring_slide(&law, before, dy, &spring);
                    coulomb_clip(0.4, &spring.fn, &spring.ft);
                } else {
                    partings += x > 0;
                    spring = (struct contact_spring){0};
                }
                double part[2] = {0.5 * (spring.fn + fn) * dx, -0.5 * (spring.ft + ft) * dy};
                work += part[0] + part[1];
                size += fabs(part[0]) + fabs(part[1]);
                double stored = spring.fn > 0 ? contact_spring_energy(&law, &pair, x + dx, &spring) : 0;
                check_at_most(stored - work, 1e-5 * size);
                excess = fmax(excess, (stored - work) / size);
            }
        }
        print_message("%s: %d steps, %d partings, work %.2f of what passed, energy made at most %.1e of it\n",
                      law.row->name, CORNERS * LEG, partings, work / size, excess);
        assert_in_range(partings, 5, CORNERS);
        check_at_most(0.05 * size, work); /* friction took a good part */
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ballast_has_the_published_numbers),
        cmocka_unit_test(hertz_is_hertz),
        cmocka_unit_test(rough_loading_is_the_integral_of_its_stiffness),
        cmocka_unit_test(plastic_unloading_and_reloading),
        cmocka_unit_test(stored_energy_is_the_work),
        cmocka_unit_test(cycles_create_no_energy),
        cmocka_unit_test(random_paths_create_no_energy),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
