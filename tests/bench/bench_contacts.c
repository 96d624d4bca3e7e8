/* How right is the contact network? Packings of the virtual 1g2e with known contacts, seen with errors of centres and
 * radii, go through find_contacts; precision, recall and F1 against the error of the radii, the injected radius offset
 * and scale. bench_contacts [--grains N] [--kappa K] [--seed S] [--only errors|offset|reliability|forces|speed]
 * [--truth FILE]
 * [--save FILE]. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "contacts/find_contacts.h"
#include "forces/infer_forces.h"
#include "pipeline/error.h"
#include "pipeline/random.h"
#include "simulation/simulate.h"

#define MEAN_RADIUS_PX 100.0 /* of the full-size photos */

/* ---- the packing whose contacts are known ---- */

static int keep_copy(const struct packing *packing, const struct simulation_state *state, void *user)
{
    struct packing *copy = user;
    (void)state;
    packing_free(copy);
    copy->length_m = packing->length_m;
    return table_copy(&GRAINS, &copy->grains, &packing->grains) || table_copy(&WALLS, &copy->walls, &packing->walls) ||
                   table_copy(&CONTACTS, &copy->contacts, &packing->contacts)
               ? -1
               : 0;
}

/* The real grading (thesis, Table 4.1), shrunk to about `grains` rods. */
static int make_truth(long grains, double kappa, uint64_t seed, struct packing *truth)
{
    struct grade grading[] = {{798 * grains / 1850, 8e-3},
                              {426 * grains / 1850, 12e-3},
                              {406 * grains / 1850, 14e-3},
                              {220 * grains / 1850, 20e-3}};
    struct simulation simulation = SIMULATION_DEFAULT;
    simulation.seed = seed;
    simulation.grading = grading;
    simulation.grade_count = 4;
    simulation.law = (struct contact_law){.kind = LAW_LINEAR, .kn = 1.09e7, .kt_over_kn = 1, .mu = 0.53};
    simulation.kappa = kappa;
    simulation.preparation_mu = 0.2;
    return simulate(&simulation, keep_copy, truth);
}

static double mean_radius(const struct packing *truth)
{
    double sum = 0;
    for (size_t k = 0; k < truth->grains.count; k++)
        sum += truth->grains.radius[k];
    return sum / (double)truth->grains.count;
}

/* ---- what a photo would tell ---- */

struct seen {
    double s;      /* px: error of x, y and radius, each */
    double offset; /* px: added to every radius */
    double lambda; /* every radius times this */
    uint64_t key;
};

static struct scene scene_of(const struct packing *truth)
{
    struct scene scene = {.path = "bench", .scale = mean_radius(truth) / MEAN_RADIUS_PX};
    scene.grains.density = scene.grains.length = NAN;
    long w[4];
    const char *const sides[] = {"bottom", "right", "top", "left"};
    for (int k = 0; k < 4; k++)
        w[k] = walls_find(&truth->walls, sides[k]);
    if (w[0] < 0 || w[1] < 0 || w[2] < 0 || w[3] < 0)
        return scene;
    double left = truth->walls.x0[w[3]], right = truth->walls.x0[w[1]], low = truth->walls.y0[w[0]],
           high = truth->walls.y0[w[2]];
    scene.frame.given = 1;
    scene.frame.corners_px[CORNER_TOP_LEFT] = scene_pixels(&scene, vec(left, high));
    scene.frame.corners_px[CORNER_TOP_RIGHT] = scene_pixels(&scene, vec(right, high));
    scene.frame.corners_px[CORNER_BOTTOM_RIGHT] = scene_pixels(&scene, vec(right, low));
    scene.frame.corners_px[CORNER_BOTTOM_LEFT] = scene_pixels(&scene, vec(left, low));
    for (int k = 0; k < 4; k++) /* a frame clicked by hand */
        scene.frame.corners_px[k] = vec(round(scene.frame.corners_px[k].x), round(scene.frame.corners_px[k].y));
    return scene;
}

static int look(const struct packing *truth, const struct scene *scene, const struct seen *seen,
                struct photo_grains *grains)
{
    static const char *const columns[] = {"x_px", "y_px", "radius_px", "s_x", "s_y", "s_radius", "flags", NULL};
    if (table_alloc(&PHOTO_GRAINS, grains, truth->grains.count, columns))
        return -1;
    for (size_t k = 0; k < grains->count; k++) {
        struct vec px = scene_pixels(scene, vec(truth->grains.x[k], truth->grains.y[k]));
        grains->x_px[k] = px.x + seen->s * random_normal(seen->key, 3 * k);
        grains->y_px[k] = px.y + seen->s * random_normal(seen->key, 3 * k + 1);
        grains->radius_px[k] = seen->lambda * truth->grains.radius[k] / scene->scale + seen->offset +
                               seen->s * random_normal(seen->key, 3 * k + 2);
        grains->s_x[k] = grains->s_y[k] = grains->s_radius[k] = seen->s;
    }
    return 0;
}

/* ---- the score ---- */

struct score {
    double found, right, expected; /* contacts: found; found and true; true */
    double wall_found, wall_right, wall_expected;
    double bin_count[10], bin_true[10], bin_probability[10];
};

/* The true contacts by their pair. */
struct contact_key {
    int64_t i, j;
    size_t row;
};
static struct contact_key *truth_keys;

static int by_key(const void *a, const void *b)
{
    const struct contact_key *x = a, *y = b;
    if (x->i != y->i)
        return x->i < y->i ? -1 : 1;
    return (x->j > y->j) - (x->j < y->j);
}

static int index_truth(const struct packing *truth)
{
    if (!(truth_keys = malloc((truth->contacts.count + 1) * sizeof *truth_keys)))
        return error_memory("truth");
    for (size_t c = 0; c < truth->contacts.count; c++)
        truth_keys[c] = (struct contact_key){truth->contacts.i[c], truth->contacts.j[c], c};
    qsort(truth_keys, truth->contacts.count, sizeof *truth_keys, by_key);
    return 0;
}

static int is_true(const struct packing *truth, int64_t i, int64_t j)
{
    struct contact_key key = {i, j, 0}, *found = bsearch(&key, truth_keys, truth->contacts.count, sizeof key, by_key);
    return found && truth->contacts.overlap[found->row] > 0;
}

static void score_add(const struct packing *truth, const struct packing *found, struct score *score)
{
    int64_t n = (int64_t)truth->grains.count;
    for (size_t c = 0; c < truth->contacts.count; c++) {
        int counts = truth->contacts.overlap[c] > 0;
        score->expected += counts;
        score->wall_expected += counts && truth->contacts.j[c] >= n;
    }
    for (size_t c = 0; c < found->contacts.count; c++) {
        int64_t i = found->contacts.i[c], j = found->contacts.j[c];
        if (j >= n) { /* the truth may number its walls in another order */
            long w = walls_find(&truth->walls, found->walls.name[j - n]);
            j = n + w;
        }
        int right = is_true(truth, i, j), contact = !(found->contacts.flags[c] & CONTACT_CANDIDATE);
        score->found += contact;
        score->right += contact && right;
        score->wall_found += contact && j >= n;
        score->wall_right += contact && right && j >= n;
        int bin = (int)fmin(9, 10 * found->contacts.probability[c]);
        score->bin_count[bin]++;
        score->bin_true[bin] += right;
        score->bin_probability[bin] += found->contacts.probability[c];
    }
}

static double f1(double found, double right, double expected)
{
    return 2 * right / (found + expected);
}

static int try_once(const struct packing *truth, const struct seen *seen, const struct contact_options *options,
                    struct score *score, struct contact_summary *summary)
{
    struct scene scene = scene_of(truth);
    struct photo_grains grains = {0};
    struct packing found = {0};
    struct contact_input input = {.scene = &scene, .grains = &grains, .is_reference = 1};
    int status = look(truth, &scene, seen, &grains);
    if (!status)
        status = find_contacts(&input, options, &found, summary);
    if (!status)
        score_add(truth, &found, score);
    packing_free(&found);
    table_free(&PHOTO_GRAINS, &grains);
    return status;
}

enum { DRAWS = 2 };

static int print_row(const struct packing *truth, struct seen seen, const struct contact_options *options)
{
    struct score score = {0};
    struct contact_summary summary;
    for (uint64_t draw = 0; draw < DRAWS; draw++) {
        seen.key = draw + 1;
        if (try_once(truth, &seen, options, &score, &summary))
            return -1;
    }
    printf("%6.3f %+7.3f %+9.1e %9.4f %9.4f %9.4f %9.4f %8.3f %8.3f\n", seen.s, seen.offset, seen.lambda - 1,
           score.right / score.found, score.right / score.expected, f1(score.found, score.right, score.expected),
           f1(score.wall_found, score.wall_right, score.wall_expected), summary.mean_overlap_px, summary.resting_share);
    return 0;
}

static int tables(const struct packing *truth)
{
    const double errors[] = {0.0025, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2};
    const double offsets[] = {-0.1, -0.05, -0.02, 0, 0.02, 0.05, 0.1};
    const double lambdas[] = {-1e-3, -5e-4, -2e-4, 2e-4, 5e-4, 1e-3, 2e-3};
    struct contact_options options = CONTACT_OPTIONS_DEFAULT;
    printf("     s  offset  lambda-1 precision    recall        F1  F1 walls  overlap resting\n");
    for (size_t e = 0; e < 7; e++)
        for (size_t b = 0; b < 7; b++)
            if (print_row(truth, (struct seen){errors[e], offsets[b], 1, 0}, &options))
                return -1;
    for (size_t l = 0; l < 7; l++)
        if (print_row(truth, (struct seen){0.01, 0, 1 + lambdas[l], 0}, &options))
            return -1;
    return 0;
}

/* F1 of the best plain threshold on the measured overlap, chosen with the truth. */
static double best_threshold(const struct packing *truth, struct seen seen, struct contact_options options)
{
    double best = 0;
    seen.offset = 0;
    for (int t = -6; t <= 6; t++) {
        struct score score = {0};
        options = (struct contact_options)CONTACT_OPTIONS_DEFAULT;
        options.tolerance_px = 0.4 * seen.s * t + 1e-3;
        if (try_once(truth, &seen, &options, &score, NULL))
            return NAN;
        best = fmax(best, f1(score.found, score.right, score.expected));
    }
    return best;
}

static int offsets_found(const struct packing *truth)
{
    const double errors[] = {0.005, 0.01, 0.02, 0.05, 0.1, 0.2};
    printf("automatic radius offset, injected -0.8 ... +0.3 px\n"
           "     s    error  scatter   stated undecided precision    recall        F1  best F1\n");
    for (size_t e = 0; e < 6; e++) {
        double sum = 0, square = 0, stated = 0, decided = 0, best = 0;
        struct score score = {0};
        const double injected[] = {-0.8, -0.3, -0.1, 0, 0.1, 0.3};
        for (size_t d = 0; d < 6; d++) {
            struct contact_options options = CONTACT_OPTIONS_DEFAULT;
            struct contact_summary summary;
            struct seen seen = {errors[e], injected[d], 1, 10 + d};
            options.radius_offset_auto = 1;
            if (try_once(truth, &seen, &options, &score, &summary))
                return -1;
            if (d < 2)
                best += 0.5 * best_threshold(truth, seen, options);
            if (summary.undecided)
                continue;
            double error = summary.radius_offset_px + injected[d];
            decided++;
            sum += error;
            square += error * error;
            stated += summary.s_radius_offset_px;
        }
        double mean = sum / decided;
        printf("%6.3f %+8.4f %8.4f %8.4f %9.0f %9.4f %9.4f %9.4f %8.4f\n", errors[e], mean,
               sqrt(fmax(0, square / decided - mean * mean)), stated / decided, 6 - decided, score.right / score.found,
               score.right / score.expected, f1(score.found, score.right, score.expected), best);
    }
    return 0;
}

static int reliability(const struct packing *truth)
{
    struct score score = {0};
    struct contact_options options = CONTACT_OPTIONS_DEFAULT;
    for (int e = 0; e < 3; e++)
        for (uint64_t draw = 0; draw < 6; draw++) {
            struct seen seen = {(const double[]){0.01, 0.025, 0.05}[e], 0, 1, 100 + draw};
            if (try_once(truth, &seen, &options, &score, NULL))
                return -1;
        }
    printf("probability   pairs  stated observed\n");
    for (int b = 0; b < 10; b++)
        printf("%.1f-%.1f %12.0f %8.3f %8.3f\n", b / 10.0, (b + 1) / 10.0, score.bin_count[b],
               score.bin_probability[b] / score.bin_count[b], score.bin_true[b] / score.bin_count[b]);
    return 0;
}

/* Pearson r of the normal forces that a method finds on this network with the true ones (the overlaps: linear law);
 * a lost contact counts as no force. */
static double downstream(const struct packing *truth, struct packing *found, enum force_method method)
{
    struct force_options options = FORCE_OPTIONS_DEFAULT;
    struct forces forces = {0};
    double *force = calloc(truth->contacts.count + 1, sizeof *force), n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;
    options.law = (struct contact_law){.kind = LAW_LINEAR, .kn = 1.09e7, .kt_over_kn = 1, .mu = 0.53};
    options.tolerance = 1e-4;
    for (size_t w = 0; w < found->walls.count; w++) {
        long same = walls_find(&truth->walls, found->walls.name[w]);
        found->walls.fx[w] = truth->walls.fx[same];
        found->walls.fy[w] = truth->walls.fy[same];
    }
    if (!force || infer_forces(found, &options, method, &forces)) {
        free(force);
        return NAN;
    }
    for (size_t c = 0; c < found->contacts.count; c++) {
        int64_t j = found->contacts.j[c], grains = (int64_t)truth->grains.count;
        if (j >= grains)
            j = grains + walls_find(&truth->walls, found->walls.name[j - grains]);
        struct contact_key key = {found->contacts.i[c], j, 0};
        struct contact_key *same = bsearch(&key, truth_keys, truth->contacts.count, sizeof key, by_key);
        if (same && isfinite(forces.contact.fn[c]))
            force[same->row] = forces.contact.fn[c];
    }
    for (size_t c = 0; c < truth->contacts.count; c++) {
        double x = force[c], y = truth->contacts.overlap[c];
        n++;
        a += x;
        b += y;
        aa += x * x;
        bb += y * y;
        ab += x * y;
    }
    free(force);
    forces_free(&forces);
    return (ab - a * b / n) / sqrt((aa - a * a / n) * (bb - b * b / n));
}

/* One network and what qsm and cdm make of it. */
static int forces_once(const struct packing *truth, const struct seen *seen, const struct contact_options *options)
{
    struct scene scene = scene_of(truth);
    struct photo_grains grains = {0};
    struct packing found = {0};
    struct score score = {0};
    struct contact_input input = {.scene = &scene, .grains = &grains, .is_reference = 1};
    int status = look(truth, &scene, seen, &grains) || find_contacts(&input, options, &found, NULL) ? -1 : 0;
    if (!status) {
        score_add(truth, &found, &score);
        double qsm = downstream(truth, &found, METHOD_QSM), cdm = downstream(truth, &found, METHOD_CDM);
        printf("%10.4f %9.4f %8.4f %8.4f", score.right / score.expected, score.right / score.found, qsm, cdm);
    }
    packing_free(&found);
    table_free(&PHOTO_GRAINS, &grains);
    return status;
}

/* Where does the network stop mattering? Forces on networks of wrong radii: with the plain threshold of the thesis, and
 * with the automatic offset and decision. */
static int forces_behind(const struct packing *truth)
{
    const double errors[] = {0.01, 0.05}, offsets[] = {-0.1, -0.05, -0.02, 0, 0.05, 0.1, 0.3};
    printf("                       overlap > 0: r(fn) from overlaps             automatic\n"
           "     s  offset     recall precision      qsm      cdm     recall precision      qsm      cdm\n");
    for (size_t e = 0; e < 2; e++)
        for (size_t o = 0; o < 7; o++) {
            struct seen seen = {errors[e], offsets[o], 1, 5};
            struct contact_options plain = CONTACT_OPTIONS_DEFAULT, automatic = CONTACT_OPTIONS_DEFAULT;
            plain.tolerance_px = 0;
            automatic.radius_offset_auto = 1;
            printf("%6.3f %+7.3f ", seen.s, seen.offset);
            if (forces_once(truth, &seen, &plain) || forces_once(truth, &seen, &automatic))
                return -1;
            printf("\n");
        }
    return 0;
}

/* CPU time against the number of grains: a hexagonal crystal with errors of 0.02 px. */
static int speed(void)
{
    static const char *const columns[] = {"x_px", "y_px", "radius_px", "s_x", "s_y", "s_radius", "flags", NULL};
    printf("   grains  contacts  CPU s\n");
    for (size_t side = 30; side <= 1000; side = side == 30 ? 100 : side == 100 ? 316 : side == 316 ? 1000 : 1001) {
        struct scene scene = {.path = "bench", .scale = 1e-4};
        struct photo_grains grains;
        struct packing found = {0};
        struct contact_summary summary;
        struct contact_options options = CONTACT_OPTIONS_DEFAULT;
        struct contact_input input = {.scene = &scene, .grains = &grains, .is_reference = 1};
        scene.grains.density = scene.grains.length = NAN;
        if (table_alloc(&PHOTO_GRAINS, &grains, side * side, columns))
            return -1;
        for (size_t k = 0; k < grains.count; k++) {
            size_t at = (k * 7919) % grains.count, row = at / side;
            grains.x_px[k] = 39.9 * ((double)(at % side) + 0.5 * (double)(row % 2)) + 0.02 * random_normal(1, 3 * k);
            grains.y_px[k] = 39.9 * sqrt(0.75) * (double)row + 0.02 * random_normal(1, 3 * k + 1);
            grains.radius_px[k] = 20 + 0.02 * random_normal(1, 3 * k + 2);
            grains.s_x[k] = grains.s_y[k] = grains.s_radius[k] = 0.02;
        }
        clock_t start = clock();
        int status = find_contacts(&input, &options, &found, &summary);
        printf("%9zu %9zu %6.2f\n", grains.count, summary.contacts, (double)(clock() - start) / CLOCKS_PER_SEC);
        packing_free(&found);
        table_free(&PHOTO_GRAINS, &grains);
        if (status)
            return -1;
    }
    return 0;
}

int main(int argc, char **argv)
{
    long grains = 400;
    double kappa = 1000;
    uint64_t seed = 7;
    const char *file = NULL, *save = NULL, *only = NULL;
    struct packing truth = {0};
    for (int a = 1; a + 1 < argc; a += 2) {
        if (!strcmp(argv[a], "--grains"))
            grains = atol(argv[a + 1]);
        else if (!strcmp(argv[a], "--kappa"))
            kappa = atof(argv[a + 1]);
        else if (!strcmp(argv[a], "--seed"))
            seed = strtoull(argv[a + 1], NULL, 10);
        else if (!strcmp(argv[a], "--truth"))
            file = argv[a + 1];
        else if (!strcmp(argv[a], "--only"))
            only = argv[a + 1];
        else if (!strcmp(argv[a], "--save"))
            save = argv[a + 1];
    }
    if (only && !strcmp(only, "speed"))
        return speed() != 0;
    int status = file ? packing_read(file, &truth) : make_truth(grains, kappa, seed, &truth);
    if (status >= 0 && save) {
        struct provenance provenance = PROVENANCE_DEFAULT;
        provenance.stage = "simulate";
        provenance.parameters = "{}";
        provenance.coordinates = "si";
        status = packing_write(save, &truth, &provenance);
    }
    if (status >= 0)
        status = index_truth(&truth);
    if (status >= 0)
        status = ((!only || !strcmp(only, "errors")) && tables(&truth)) ||
                         ((!only || !strcmp(only, "offset")) && offsets_found(&truth)) ||
                         ((!only || !strcmp(only, "forces")) && forces_behind(&truth)) ||
                         ((!only || !strcmp(only, "reliability")) && reliability(&truth))
                     ? -1
                     : 0;
    if (status < 0)
        fprintf(stderr, "bench_contacts: %s\n", error_message());
    free(truth_keys);
    packing_free(&truth);
    return status < 0;
}
