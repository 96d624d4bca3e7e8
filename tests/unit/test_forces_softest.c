/* The stability figure against arches worked out by hand, and against the change of every grain's forces under small
 * motions, which is computed here grain by grain from the contact law alone. */
#include "tests/unit/force_checks.h"

#include "forces/questions/buckling.h"

static double smaller(double a, double b)
{
    return a < b ? a : b;
}

/* Two fixed discs and one between them, raised by the angle a over the line of the fixed ones, under the load P;
 * without friction. Thrust fn = P / (2 sin a). Upwards the arch has the stiffness 2 (kn sin^2 a - fn / d cos^2 a),
 * sideways 2 (kn cos^2 a - fn / d sin^2 a): it snaps through where tan^2 a < fn / (kn d). */
static double arch(double a, double thrust, struct forces *forces)
{
    struct packing packing;
    const double r = 0.01, kn = 1e6, s = sin(a), c = cos(a);
    struct force_options options = usual();
    options.law.kn = kn, options.law.mu = 0, options.start = START_ZERO;
    discs_begin(&packing, 3);
    disc_put(&packing, 0, -2 * r * c, 0, r);
    disc_put(&packing, 1, 2 * r * c, 0, r);
    disc_put(&packing, 2, 0, 2 * r * s, r);
    packing.grains.flags[0] = packing.grains.flags[1] = GRAIN_FIXED;
    packing.grains.load_y[2] = -2 * thrust * s;
    discs_touch(&packing, 1e-9);
    assert_int_equal(packing.contacts.count, 2);
    infer_and_check(&packing, &options, METHOD_QSM, forces);
    check_near(forces->contact.fn[0], thrust, 1e-6 * thrust);
    assert_int_equal(forces->softest.count, 0); /* nothing without being asked */
    check_done(stability_of_forces(&packing, &options, forces));
    packing_free(&packing);
    double turn = thrust / (kn * 2 * r);
    return smaller(2 * (s * s - turn * c * c), 2 * (c * c - turn * s * s));
}

static void arches_stable_and_unstable(void **state)
{
    (void)state;
    static const struct {
        double angle, thrust; /* thrust / (kn d) = 5e-5 thrust */
        int stable;
    } cases[] = {{0.1, 20, 1},  {0.1, 180, 1}, {0.1, 220, 0}, {0.05, 20, 1},
                 {0.05, 80, 0}, {0.9, 20, 1},  {0.78, 1e4, 1}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        struct forces forces;
        double expected = arch(cases[k].angle, cases[k].thrust, &forces);
        assert_int_equal(expected > 0, cases[k].stable);
        check_near(forces.stability[0], expected, 1e-9);
        check_near(forces.stability[1], expected, 1e-9);
        if (cases[k].angle < 0.5) { /* it snaps upwards or downwards */
            check_near(fabs(forces.softest.soft_y[2]), 1, 1e-6);
            check_near(forces.softest.soft_m[2], 0, 1e-12);
        }
        forces_free(&forces);
    }
}

/* ---- against the forces themselves ---- */

/* More than 1e-4 of the mean force, as docs/forces.md says. */
static int carries(const struct forces *forces, size_t c)
{
    double sum = 0, pushing = 0;
    for (size_t k = 0; k < forces->contact.count; k++)
        if (forces->contact.fn[k] > 0)
            sum += forces->contact.fn[k], pushing++;
    return forces->contact.fn[c] > 1e-4 * sum / pushing;
}

/* Motions of every grain (x, y, rotation times the mean radius) and every wall along its inward normal; N / kn. */
struct body_motion {
    size_t grains, walls;
    double *q;
};

static double motion_of(const struct body_motion *m, size_t body, int d)
{
    return m->q[3 * body + (size_t)d];
}

/* Forces that the contacts put on every body after the motion: fn = fn0 - kn (change of distance), ft = ft0 - kt
 * (slip), along the moved normal, with the moved lever arms. */
static void forces_after(const struct packing *packing, const struct forces *forces, double kt, int slips,
                         double radius, const struct body_motion *m, double *out)
{
    const struct contacts *contacts = &packing->contacts;
    memset(out, 0, 3 * (m->grains + m->walls) * sizeof *out);
    for (size_t c = 0; c < contacts->count; c++) {
        size_t i = (size_t)contacts->i[c], j = (size_t)contacts->j[c];
        if (!carries(forces, c))
            continue;
        struct vec at = vec(packing->grains.x[i], packing->grains.y[i]);
        struct vec n = vec(contacts->nx[c], contacts->ny[c]), t = vec_turn(n);
        struct vec w0 = vec_sub(packing_partner(packing, c), at), w = w0;
        double mine = vec_dot(vec_sub(vec(contacts->x[c], contacts->y[c]), at), n), other = vec_norm(w0) - mine;
        int wall = j >= m->grains;
        if (wall) {
            struct vec in = wall_inward(&packing->walls, j - m->grains);
            w = vec_add(w, vec_scale(motion_of(m, j, 0), in));
        } else {
            w = vec_add(w, vec(motion_of(m, j, 0), motion_of(m, j, 1)));
        }
        w = vec_sub(w, vec(motion_of(m, i, 0), motion_of(m, i, 1)));
        struct vec normal = wall ? n : vec_unit(w), tangent = vec_turn(normal);
        double grown = wall ? vec_dot(vec_sub(w, w0), n) : vec_norm(w) - vec_norm(w0);
        double slip = vec_dot(vec_sub(w, w0), t) - mine * motion_of(m, i, 2) / radius -
                      (wall ? 0 : other * motion_of(m, j, 2) / radius);
        double fn = forces->contact.fn[c] / KN - grown;
        double ft =
            forces->contact.ft[c] / KN -
            (wall || (slips && forces->contact.status[c] == STATUS_SLIP) ? 0 : kt * slip); /* walls without friction */
        struct vec f = vec_add(vec_scale(fn, normal), vec_scale(ft, tangent));
        out[3 * i] -= f.x, out[3 * i + 1] -= f.y;
        out[3 * i + 2] -= (mine + grown / 2) * ft / radius;
        if (wall) {
            out[3 * j] += vec_dot(f, wall_inward(&packing->walls, j - m->grains));
        } else {
            out[3 * j] += f.x, out[3 * j + 1] += f.y;
            out[3 * j + 2] -= (other + grown / 2) * ft / radius;
        }
    }
}

/* Smallest eigenvalue of a small dense symmetric matrix, by Jacobi rotations. */
static double least_eigenvalue(size_t n, double *k)
{
    double least = INFINITY;
    for (int sweep = 0; sweep < 12; sweep++)
        for (size_t p = 0; p < n; p++)
            for (size_t q = p + 1; q < n; q++) {
                if (fabs(k[p * n + q]) < 1e-15)
                    continue;
                double angle = 0.5 * atan2(2 * k[p * n + q], k[q * n + q] - k[p * n + p]);
                double c = cos(angle), s = sin(angle);
                for (size_t r = 0; r < n; r++) {
                    double a = k[r * n + p], b = k[r * n + q];
                    k[r * n + p] = c * a - s * b, k[r * n + q] = s * a + c * b;
                }
                for (size_t r = 0; r < n; r++) {
                    double a = k[p * n + r], b = k[q * n + r];
                    k[p * n + r] = c * a - s * b, k[q * n + r] = s * a + c * b;
                }
            }
    for (size_t p = 0; p < n; p++)
        least = smaller(least, k[p * n + p]);
    return least;
}

/* Which of the 3 (grains + walls) motions are there: grains that carry and are not fixed; the right and the top wall,
 * whose opposites react. */
static size_t moving(const struct packing *packing, const struct forces *forces, size_t *index)
{
    size_t n = 0, grains = packing->grains.count;
    for (size_t k = 0; k < grains; k++) {
        int held = 0;
        for (size_t c = 0; c < packing->contacts.count; c++)
            held |=
                carries(forces, c) && (packing->contacts.i[c] == (int64_t)k || packing->contacts.j[c] == (int64_t)k);
        for (size_t d = 0; d < 3 && held && !(packing->grains.flags[k] & GRAIN_FIXED); d++)
            index[n++] = 3 * k + d;
    }
    for (size_t w = 0; w < packing->walls.count; w++)
        if (!strcmp(packing->walls.name[w], "right") || !strcmp(packing->walls.name[w], "top"))
            index[n++] = 3 * (grains + w);
    return n;
}

static double least_by_motions(const struct packing *packing, const struct forces *forces, double kt, int slips)
{
    size_t bodies = packing->grains.count + packing->walls.count, all = 3 * bodies;
    size_t *index = calloc(all, sizeof *index), n = moving(packing, forces, index);
    double *k = calloc(n * n, sizeof *k), *more = calloc(all, sizeof *more), *less = calloc(all, sizeof *less);
    struct body_motion m = {packing->grains.count, packing->walls.count, calloc(all, sizeof(double))};
    double radius = 0;
    for (size_t g = 0; g < packing->grains.count; g++)
        radius += packing->grains.radius[g] / (double)packing->grains.count;
    const double step = 1e-6 * radius;
    for (size_t b = 0; b < n; b++) {
        m.q[index[b]] = step;
        forces_after(packing, forces, kt, slips, radius, &m, more);
        m.q[index[b]] = -step;
        forces_after(packing, forces, kt, slips, radius, &m, less);
        m.q[index[b]] = 0;
        for (size_t a = 0; a < n; a++) { /* -dF/dq, its symmetric part */
            double entry = -(more[index[a]] - less[index[a]]) / (2 * step);
            k[a * n + b] += entry / 2, k[b * n + a] += entry / 2;
        }
    }
    double least = least_eigenvalue(n, k);
    free(index), free(k), free(more), free(less), free(m.q);
    return least;
}

/* The third disc of the thesis on two fixed ones, with friction; light and heavy. */
static void three_discs_with_friction(void **state)
{
    (void)state;
    static const double loads[] = {1530, 1e4, 4e4}; /* the last is too heavy */
    for (int k = 0; k < 3; k++) {
        struct packing packing;
        struct forces forces;
        struct force_options options = usual();
        const double r = 0.01, a = 0.2, kt = 0.05;
        options.start = START_ZERO, options.law.kt_over_kn = kt;
        discs_begin(&packing, 3);
        disc_put(&packing, 0, -2 * r * cos(a), 0, r);
        disc_put(&packing, 1, 2 * r * cos(a), 0, r);
        disc_put(&packing, 2, 0, 2 * r * sin(a), r);
        packing.grains.flags[0] = packing.grains.flags[1] = GRAIN_FIXED;
        packing.grains.load_y[2] = -loads[k];
        discs_touch(&packing, 1e-9);
        infer_and_check(&packing, &options, METHOD_QSM, &forces);
        check_done(stability_of_forces(&packing, &options, &forces));
        double expected = least_by_motions(&packing, &forces, kt, 0);
        check_near(forces.stability[0], expected, 1e-7);
        assert_int_equal(expected > 0, k < 2);
        forces_free(&forces);
        packing_free(&packing);
    }
}

static int keep_state(const struct packing *packing, const struct simulation_state *state, void *user)
{
    (void)state;
    copy_packing(packing, user);
    return 0;
}

/* A packing at rest: stable, the eigenvalue as by motions; a loose one is softer. */
static void a_packing_at_rest(void **state)
{
    (void)state;
    struct packing packing = {0};
    struct simulation simulation = SIMULATION_DEFAULT;
    const struct grade grading[] = {{13, 8e-3}, {7, 12e-3}, {6, 14e-3}, {4, 20e-3}};
    struct force_options options = usual();
    struct forces forces;
    simulation.grading = grading, simulation.grade_count = 4;
    simulation.law = (struct contact_law){.row = &linear_law, .kn = KN, .kt_over_kn = 1, .mu = 0.5};
    simulation.kappa = 100;
    simulation.tolerance = 1e-9;
    check_done(simulate(&simulation, keep_state, &packing));
    options.start = START_OVERLAP;
    infer_and_check(&packing, &options, METHOD_QSM, &forces);
    for (size_t c = 5; c < packing.contacts.count;
         c += 8) /* told to slip, but for the first, which would let a grain spin */
        forces.contact.status[c] = forces.contact.fn[c] > 0 ? STATUS_SLIP : forces.contact.status[c];
    check_done(stability_of_forces(&packing, &options, &forces));
    assert_true(forces.stability[0] > 1e-3);
    check_at_most(1e-3, forces.stability[0] - forces.stability[1]);
    check_near(forces.stability[1], least_by_motions(&packing, &forces, 1, 1), 1e-6);
    check_at_most(forces.stability[1], forces.stability[0] + 1e-12);
    check_near(forces.stability[0], least_by_motions(&packing, &forces, 1, 0), 1e-6);
    double squares = 0;
    for (size_t g = 0; g < forces.softest.count; g++)
        squares +=
            pow(forces.softest.soft_x[g], 2) + pow(forces.softest.soft_y[g], 2) + pow(forces.softest.soft_m[g], 2);
    check_at_most(squares, 1 + 1e-9);
    check_at_most(0.3, squares);
    forces_free(&forces);
    packing_free(&packing);
}

/* A row of discs pressed between two walls, without friction: every disc can leave sideways, and pushes harder to do so
 * the harder it is pressed. No contact at all: nothing to be said. */
static void a_buckling_row(void **state)
{
    (void)state;
    struct packing packing;
    struct forces forces;
    struct force_options options = usual();
    const double r = 0.01, press = 500;
    options.law.mu = 0, options.start = START_ZERO;
    discs_begin(&packing, 3);
    for (size_t k = 0; k < 3; k++)
        disc_put(&packing, k, r * (1 + 2 * (double)k), 2 * r, r);
    discs_box(&packing, 6 * r, 4 * r, 0);
    discs_load_wall(&packing, "right", -press, 0);
    discs_touch(&packing, 1e-9);
    infer_and_check(&packing, &options, METHOD_QSM, &forces);
    check_done(stability_of_forces(&packing, &options, &forces));
    /* Sideways the chain has K = -(fn / d) [1 -1 0; -1 2 -1; 0 -1 1], whose eigenvalues are 0, 1 and 3 times that. */
    check_near(forces.stability[0], -3 * press / (2 * r) / KN, 1e-9);
    check_near(fabs(forces.softest.soft_y[1]), 2 / sqrt(6), 1e-5);
    check_near(forces.softest.soft_y[0] / forces.softest.soft_y[1], -0.5, 1e-4);
    forces_free(&forces);
    packing_free(&packing);
    discs_begin(&packing, 1);
    disc_put(&packing, 0, 0.3, 0.3, 0.1);
    discs_box(&packing, 1, 1, 0);
    discs_touch(&packing, 1e-9);
    check_done(infer_forces(&packing, &options, METHOD_QSM, &forces));
    check_done(stability_of_forces(&packing, &options, &forces));
    assert_true(isnan(forces.stability[0]));
    forces_free(&forces);
    packing_free(&packing);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(arches_stable_and_unstable),
        cmocka_unit_test(three_discs_with_friction),
        cmocka_unit_test(a_packing_at_rest),
        cmocka_unit_test(a_buckling_row),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
