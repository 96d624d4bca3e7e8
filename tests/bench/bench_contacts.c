/* How right is the contact network? Packings of the virtual 1g2e with known contacts, seen with errors of centres and
 * radii, go through find_contacts; precision, recall and F1 against the error of the radii, the injected radius offset
 * and scale.
 *
 *     bench_contacts [--grains N] [--kappa K] [--seed S] [--packings N] [--truth FILE] [--s PX] [--draws N]
 *                    [--understated F] [--radius PX] [--loads F] [--only errors|offset|reliability|speed]
 *
 * --understated F: errors are drawn F times as large as they are stated (findgrains: 1.0 to 1.2). The stated errors of
 * the grains of one photo scatter by a quarter, as those of findgrains do. --radius PX: mean radius (100, as in the
 * full-size photos). --loads F: the scene gives the loads of the walls, and a
 * stiffness that is off by the share F (standard deviation).
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "contacts/find_contacts.h"
#include "forces/infer_forces.h"
#include "network_score.h"
#include "pipeline/speak/error.h"
#include "pipeline/numbers/random.h"
#include "pipeline/packing/packing_file.h"
#include "simulation/dem/simulate.h"

#define SCATTER 0.25 /* of the stated errors, in their logarithm */

/* The true contacts by their pair. */
struct contact_key {
    int64_t i, j;
    size_t row;
};

enum { MOST_TRUTHS = 64 };
struct truths {
    struct packing packing[MOST_TRUTHS];
    struct contact_key *keys[MOST_TRUTHS];
    char loads[MOST_TRUTHS][64]; /* paths of their loads; empty: the scene gives none */
    size_t count;
};
static struct truths truths;
static double only_s; /* px: the one error of the tables; 0: all */
static double understated = 1;
static double stiffness_error;      /* of the scene's kn, relative */
static double mean_radius_px = 100; /* of the full-size photos */
static long draws = 6;              /* photos of each packing */

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
    simulation.law = (struct contact_law){.row = &linear_law, .kn = 1.09e7, .kt_over_kn = 1, .mu = 0.53};
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
    struct scene scene = {.path = "bench", .scale = mean_radius(truth) / mean_radius_px};
    char *loads = truths.loads[truth - truths.packing];
    scene.loads = *loads ? loads : NULL;
    scene.grains.density = scene.grains.length = NAN;
    scene.contact_given = 1;
    scene.contact = (struct contact_law){.row = &linear_law, .kn = 1.09e7, .kt_over_kn = 1, .mu = 0.53};
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
        double stated = seen->s * exp(SCATTER * random_normal(seen->key, 4 * k + 3)), error = understated * stated;
        grains->x_px[k] = px.x + error * random_normal(seen->key, 4 * k);
        grains->y_px[k] = px.y + error * random_normal(seen->key, 4 * k + 1);
        grains->radius_px[k] = seen->lambda * truth->grains.radius[k] / scene->scale + seen->offset +
                               error * random_normal(seen->key, 4 * k + 2);
        grains->s_x[k] = grains->s_y[k] = grains->s_radius[k] = stated;
    }
    return 0;
}

/* ---- the score ---- */

static int by_key(const void *a, const void *b)
{
    const struct contact_key *x = a, *y = b;
    if (x->i != y->i)
        return x->i < y->i ? -1 : 1;
    return (x->j > y->j) - (x->j < y->j);
}

static int index_truth(const struct packing *truth, struct contact_key **keys)
{
    if (!(*keys = malloc((truth->contacts.count + 1) * sizeof **keys)))
        return error_memory("truth");
    for (size_t c = 0; c < truth->contacts.count; c++)
        (*keys)[c] = (struct contact_key){truth->contacts.i[c], truth->contacts.j[c], c};
    qsort(*keys, truth->contacts.count, sizeof **keys, by_key);
    return 0;
}

/* Row of a pair among the true contacts; -1: none. */
static long true_row(const struct packing *truth, int64_t i, int64_t j)
{
    size_t p = (size_t)(truth - truths.packing);
    struct contact_key key = {i, j, 0};
    struct contact_key *found = bsearch(&key, truths.keys[p], truth->contacts.count, sizeof key, by_key);
    return found ? (long)found->row : -1;
}

/* The second body of a found contact in the truth's numbering; the walls may have another order there. */
static int64_t true_partner(const struct packing *truth, const struct packing *found, size_t c)
{
    int64_t n = (int64_t)truth->grains.count, j = found->contacts.j[c];
    return j < n ? j : n + walls_find(&truth->walls, found->walls.name[j - n]);
}

/* Pairs of the file beside their truth, added to the figures. */
static int score_add(const struct packing *truth, const struct packing *found, struct network_figures *figures)
{
    int64_t n = (int64_t)truth->grains.count;
    struct scored_network network = {0};
    unsigned char *carries = malloc((size_t)n + 1);
    int status = carries ? 0 : error_memory("grains that carry");
    if (status == 0)
        network.mean = find_carrying(&truth->contacts, (size_t)n, carries);
    for (size_t c = 0; status == 0 && c < truth->contacts.count; c++) {
        network.missing += truth->contacts.overlap[c] > 0;
        network.missing_carrying += truth->contacts.overlap[c] > 0.01 * network.mean;
        network.missing_wall += truth->contacts.overlap[c] > 0 && truth->contacts.j[c] >= n;
    }
    for (size_t c = 0; status == 0 && c < found->contacts.count; c++) {
        int64_t i = found->contacts.i[c], j = true_partner(truth, found, c);
        long row = true_row(truth, i, j);
        uint32_t flags = found->grains.flags[i] | (j < n ? found->grains.flags[j] : 0);
        struct scored_pair pair = {.overlap = found->contacts.overlap[c],
                                   .probability = found->contacts.probability[c],
                                   .truth = row >= 0 ? truth->contacts.overlap[row] : -1,
                                   .contact = !(found->contacts.flags[c] & CONTACT_CANDIDATE),
                                   .idle = (flags & GRAIN_RATTLER) != 0,
                                   .wall = j >= n,
                                   .carries = carries[i] && (j >= n || carries[j])};
        network.missing -= pair.truth > 0;
        network.missing_carrying -= pair.truth > 0.01 * network.mean;
        network.missing_wall -= pair.truth > 0 && pair.wall;
        status = scored_network_add(&network, pair);
    }
    if (status == 0)
        network_figures_add(&network, figures);
    scored_network_free(&network);
    free(carries);
    return status;
}

static int try_once(const struct packing *truth, const struct seen *seen, const struct contact_options *options,
                    struct network_figures *figures, struct contact_summary *summary)
{
    struct scene scene = scene_of(truth);
    struct photo_grains grains = {0};
    struct packing found = {0};
    struct contact_input input = {.scene = &scene, .grains = &grains, .is_reference = 1};
    scene.contact.kn *= exp(stiffness_error * random_normal(seen->key, 4 * truth->grains.count));
    int status = look(truth, &scene, seen, &grains);
    if (!status)
        status = find_contacts(&input, options, &found, summary);
    if (!status)
        status = score_add(truth, &found, figures);
    packing_free(&found);
    table_free(&PHOTO_GRAINS, &grains);
    return status;
}

/* One error, all packings: what `auto` finds when the radii are off, by a different amount in each photo. */
static int offset_row(const struct truths *truths, double s)
{
    double sum = 0, square = 0, worst = 0, stated = 0, decided = 0, tried = 0, ratio = 0;
    struct network_figures figures = {0};
    for (size_t p = 0; p < truths->count; p++)
        for (long d = 0; d < draws; d++) {
            struct contact_options options = CONTACT_OPTIONS_DEFAULT;
            struct contact_summary summary;
            struct seen seen = {s, -0.8 + 1.1 * random_uniform(p, (uint64_t)d), 1, 1000 * p + 10 + (uint64_t)d};
            options.radius_offset_auto = 1;
            if (try_once(&truths->packing[p], &seen, &options, &figures, &summary))
                return -1;
            tried++;
            if (summary.undecided)
                continue;
            double error = summary.radius_offset_px + seen.offset;
            decided++;
            sum += error;
            square += error * error;
            worst = fmax(worst, fabs(error));
            stated += pow(summary.s_radius_offset_px, 2);
            ratio += pow(error / summary.s_radius_offset_px, 2);
        }
    printf("%6.3f %+8.4f %7.4f %7.4f %7.4f %6.2f %3.0f/%-4.0f|%7.4f %7.4f %7.4f %7.4f %7.4f |%7.4f |%7.4f %7.4f %7.4f "
           "%7.4f\n",
           s, sum / decided, sqrt(square / decided), worst, sqrt(stated / decided), sqrt(ratio / decided),
           tried - decided, tried, precision(figures.all), recall(figures.all), f1(figures.all), f1(figures.best),
           recall(figures.best), f1(figures.bearing), precision(figures.carrying), recall(figures.carrying),
           f1(figures.carrying), f1(figures.best_carrying));
    return 0;
}

static int offsets_found(const struct truths *truths)
{
    const double errors[] = {0.005, 0.01, 0.02, 0.05, 0.1, 0.2};
    printf("automatic radius offset, injected -0.8 ... +0.3 px                 | all contacts          best    its     "
           "|without | carrying force                best\n"
           "     s     bias     RMS   worst  stated  err/s undecided|     P       R      F1       F1   recall "
           "|rattlers|     P       R      F1      F1\n");
    for (size_t e = 0; e < 6; e++)
        if (!(only_s > 0 && only_s != errors[e]) && offset_row(truths, errors[e]))
            return -1;
    return 0;
}

static int reliability(const struct truths *truths)
{
    const double errors[] = {0.01, 0.02, 0.03, 0.05};
    struct network_figures figures = {0};
    for (size_t p = 0; p < truths->count; p++)
        for (int e = 0; e < 4; e++)
            for (long draw = 0; draw < draws && !(only_s > 0 && only_s != errors[e]); draw++) {
                struct contact_options options = CONTACT_OPTIONS_DEFAULT;
                struct seen seen = {errors[e], 0, 1, 100000 * p + 100 + (uint64_t)draw};
                if (try_once(&truths->packing[p], &seen, &options, &figures, NULL))
                    return -1;
            }
    print_reliability(&figures);
    return 0;
}

/* Pearson r of the normal forces that a method finds on this network with the true ones (the overlaps: linear law);
 * a lost contact counts as no force. */
static double downstream(const struct packing *truth, struct packing *found, enum force_method method)
{
    struct force_options options = FORCE_OPTIONS_DEFAULT;
    struct forces forces = {0};
    double *force = calloc(truth->contacts.count + 1, sizeof *force), n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;
    options.law = (struct contact_law){.row = &linear_law, .kn = 1.09e7, .kt_over_kn = 1, .mu = 0.53};
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
        long row = true_row(truth, found->contacts.i[c], true_partner(truth, found, c));
        if (row >= 0 && isfinite(forces.contact.fn[c]))
            force[row] = forces.contact.fn[c];
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
static int network_and_forces(const struct packing *truth, const struct seen *seen,
                              const struct contact_options *options)
{
    struct scene scene = scene_of(truth);
    struct photo_grains grains = {0};
    struct packing found = {0};
    struct network_figures figures = {0};
    struct contact_input input = {.scene = &scene, .grains = &grains, .is_reference = 1};
    int status = look(truth, &scene, seen, &grains) || find_contacts(&input, options, &found, NULL) ||
                         score_add(truth, &found, &figures)
                     ? -1
                     : 0;
    if (!status) {
        double qsm = downstream(truth, &found, METHOD_QSM), cdm = downstream(truth, &found, METHOD_CDM);
        printf("%7.4f %6.4f %6.4f %7.4f %7.4f", precision(figures.all), recall(figures.all), f1(figures.all), qsm, cdm);
    }
    packing_free(&found);
    table_free(&PHOTO_GRAINS, &grains);
    return status;
}

/* Wrong radii: with the plain threshold of the thesis, and with the automatic offset and decision. */
static int wrong_radii(const struct packing *truth, double s, double offset, double lambda)
{
    struct seen seen = {s, offset, lambda, 5};
    struct contact_options plain = CONTACT_OPTIONS_DEFAULT, automatic = CONTACT_OPTIONS_DEFAULT;
    plain.tolerance_px = 0;
    automatic.radius_offset_auto = 1;
    printf("%6.3f %+7.3f %+9.1e |", s, offset, lambda - 1);
    if (network_and_forces(truth, &seen, &plain))
        return -1;
    printf(" |");
    if (network_and_forces(truth, &seen, &automatic))
        return -1;
    printf("\n");
    return 0;
}

/* Where does the network stop mattering? */
static int tables(const struct packing *truth)
{
    const double errors[] = {0.005, 0.01, 0.02, 0.05, 0.1}, offsets[] = {-0.1, -0.05, -0.02, 0, 0.02, 0.05, 0.1, 0.3};
    const double lambdas[] = {-1e-3, -5e-4, -2e-4, 2e-4, 5e-4, 1e-3, 2e-3};
    printf("                         | overlap > 0:                  r(fn) from overlaps| automatic:\n"
           "     s  offset  lambda-1 |     P      R      F1     qsm     cdm |     P      R      F1     qsm     cdm\n");
    for (size_t e = 0; e < 5; e++)
        for (size_t b = 0; b < 8 && !(only_s > 0 && only_s != errors[e]); b++)
            if (wrong_radii(truth, errors[e], offsets[b], 1))
                return -1;
    for (size_t l = 0; l < 7; l++)
        if (wrong_radii(truth, 0.01, 0, 1 + lambdas[l]))
            return -1;
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

/* What the machine of the virtual test pushes with, as a table. */
static int write_loads(const struct walls *walls, char path[64])
{
    snprintf(path, 64, "/tmp/bench_contacts_XXXXXX");
    int handle = mkstemp(path);
    FILE *file = handle >= 0 ? fdopen(handle, "w") : NULL;
    if (!file)
        return error_input("%s: cannot be written", path);
    fprintf(file, "index,wall,fx_N,fy_N\n");
    for (size_t w = 0; w < walls->count; w++)
        if (!wall_is_disc(walls, w))
            fprintf(file, "0,%s,%.9g,%.9g\n", walls->name[w], walls->fx[w], walls->fy[w]);
    return fclose(file) ? error_input("%s: cannot be written", path) : 0;
}

/* Packings from a file, or as many as asked for from seeds in a row. */
static int get_truths(const char *file, size_t count, long grains, double kappa, uint64_t seed, int loads)
{
    for (size_t p = 0; p < count; p++) {
        struct packing *truth = &truths.packing[p];
        if ((file ? packing_read(file, truth) : make_truth(grains, kappa, seed + p, truth)) < 0)
            return -1;
        truths.count++;
        if (index_truth(truth, &truths.keys[p]) || (loads && write_loads(&truth->walls, truths.loads[p])))
            return -1;
    }
    return 0;
}

static int run(const char *only)
{
    int all = !only;
    return ((all || !strcmp(only, "errors")) && tables(&truths.packing[0])) ||
                   ((all || !strcmp(only, "offset")) && offsets_found(&truths)) ||
                   ((all || !strcmp(only, "reliability")) && reliability(&truths))
               ? -1
               : 0;
}

int main(int argc, char **argv)
{
    setvbuf(stdout, NULL, _IOLBF, 0);
    long grains = 400;
    double kappa = 1000;
    uint64_t seed = 7;
    size_t packings = 1;
    int loads = 0; /* given */
    const char *file = NULL, *only = NULL;
    for (int a = 1; a + 1 < argc; a += 2) {
        if (!strcmp(argv[a], "--grains"))
            grains = atol(argv[a + 1]);
        else if (!strcmp(argv[a], "--kappa"))
            kappa = atof(argv[a + 1]);
        else if (!strcmp(argv[a], "--seed"))
            seed = strtoull(argv[a + 1], NULL, 10);
        else if (!strcmp(argv[a], "--packings"))
            packings = (size_t)fmin(fmax(1, atof(argv[a + 1])), MOST_TRUTHS);
        else if (!strcmp(argv[a], "--truth"))
            file = argv[a + 1];
        else if (!strcmp(argv[a], "--s"))
            only_s = atof(argv[a + 1]);
        else if (!strcmp(argv[a], "--draws"))
            draws = atol(argv[a + 1]);
        else if (!strcmp(argv[a], "--understated"))
            understated = atof(argv[a + 1]);
        else if (!strcmp(argv[a], "--radius"))
            mean_radius_px = atof(argv[a + 1]);
        else if (!strcmp(argv[a], "--loads"))
            stiffness_error = atof(argv[a + 1]), loads = 1;
        else if (!strcmp(argv[a], "--only"))
            only = argv[a + 1];
    }
    if (only && !strcmp(only, "speed"))
        return speed() != 0;
    int status = get_truths(file, packings, grains, kappa, seed, loads);
    if (status == 0)
        status = run(only);
    if (status < 0)
        fprintf(stderr, "bench_contacts: %s\n", error_message());
    for (size_t p = 0; p < truths.count; p++) {
        free(truths.keys[p]);
        packing_free(&truths.packing[p]);
        if (*truths.loads[p])
            remove(truths.loads[p]);
    }
    return status < 0;
}
