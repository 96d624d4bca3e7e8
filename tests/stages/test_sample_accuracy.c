/* Photos to forces against the exact truth: reads what the Makefile made of sample_images (fixture `sample_series`) and
 * what forces makes of all its photos together (fixture `sample_together`), and compares it with what simulate and
 * render know, and r of the forces with README's table. Everything is recomputed here from the files' columns; grains
 * are matched by position, contacts through the matched grains. */
#include "tests/rank_by_hand.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/packing/packing_file.h"

enum { PHOTOS = 5, METHODS = 5, FIRST_FORCE_COLUMN = 7 };
static const char *const methods[METHODS] = {"cem", "qsm", "cdm", "map", "series"}; /* in README's order */
#define OUTPUT FILM_BINARY_DIR "/sample"
#define TOGETHER FILM_BINARY_DIR "/sample_together"
#define TRUTH FILM_SOURCE_DIR "/sample_images/truth"
#define DEGREE 0.017453292519943295

static const char *file_name(char path[512], const char *folder, int index, const char *kind)
{
    snprintf(path, 512, "%s/%04d.%s.hdf", folder, index, kind);
    return path;
}

static void read_photo_grains(const char *path, struct photo_grains *grains)
{
    static const char *const required[] = {"x_px", "y_px", "radius_px", "flags", NULL};
    struct state *state = state_open(path);
    if (!state)
        fail_msg("%s: not there or not readable: run the fixture sample_series first", path);
    check_done(state_read(state, "grains", &PHOTO_GRAINS, required, grains));
    state_close(state);
}

/* found[k]: the row of b whose centre lies within half a radius of row k of a, nearest first; -1: none. */
static long *match(size_t a_count, const double *ax, const double *ay, const double *radius, size_t b_count,
                   const double *bx, const double *by)
{
    long *found = malloc((a_count + 1) * sizeof *found);
    for (size_t k = 0; k < a_count; k++) {
        double nearest = 0.5 * radius[k];
        found[k] = -1;
        for (size_t m = 0; m < b_count; m++) {
            double d = hypot(ax[k] - bx[m], ay[k] - by[m]);
            if (d < nearest) {
                nearest = d;
                found[k] = (long)m;
            }
        }
    }
    return found;
}

static double rms(double sum_of_squares, size_t count)
{
    return sqrt(sum_of_squares / (double)count);
}

static void grains_are_found(void **state)
{
    (void)state;
    char path[512];
    struct photo_grains truth = {0}, seen = {0};
    read_photo_grains(file_name(path, TRUTH, 0, "photo-truth"), &truth);
    read_photo_grains(file_name(path, OUTPUT, 0, "grains"), &seen);
    long *row = match(truth.count, truth.x_px, truth.y_px, truth.radius_px, seen.count, seen.x_px, seen.y_px);
    double centre = 0, radius = 0, bias = 0;
    for (size_t k = 0; k < truth.count; k++) {
        assert_true(row[k] >= 0); /* every grain found */
        for (size_t m = 0; m < k; m++)
            assert_true(row[m] != row[k]);
        double dr = seen.radius_px[row[k]] - truth.radius_px[k];
        centre += pow(seen.x_px[row[k]] - truth.x_px[k], 2) + pow(seen.y_px[row[k]] - truth.y_px[k], 2);
        radius += dr * dr;
        bias += dr / (double)truth.count;
    }
    assert_int_equal(seen.count, truth.count); /* and nothing else */
    print_message("grains %zu, centre RMS %.4f px, radius RMS %.4f px, radius bias %+.4f px\n", truth.count,
                  rms(centre, 2 * truth.count), rms(radius, truth.count), bias);
    check_at_most(rms(centre, 2 * truth.count), 0.05);
    check_at_most(rms(radius, truth.count), 0.05);
    free(row);
    table_free(&PHOTO_GRAINS, &truth);
    table_free(&PHOTO_GRAINS, &seen);
}

static void check_motion(int index)
{
    char path[512];
    struct photo_grains reference = {0}, truth = {0}, tracks = {0};
    read_photo_grains(file_name(path, TRUTH, 0, "photo-truth"), &reference);
    read_photo_grains(file_name(path, TRUTH, index, "photo-truth"), &truth);
    read_photo_grains(file_name(path, OUTPUT, index, "tracks"), &tracks);
    assert_non_null(tracks.x_ref_px);
    long *row = match(reference.count, reference.x_px, reference.y_px, reference.radius_px, tracks.count,
                      tracks.x_ref_px, tracks.y_ref_px);
    double motion = 0, rotation = 0;
    for (size_t k = 0; k < reference.count; k++) {
        long m = row[k];
        assert_true(m >= 0);
        /* What was followed is the material at the centre that findgrains saw: move that point with the true grain. */
        double a = truth.angle[k] - reference.angle[k];
        double ox = tracks.x_ref_px[m] - reference.x_px[k], oy = tracks.y_ref_px[m] - reference.y_px[k];
        double x = truth.x_px[k] + cos(a) * ox + sin(a) * oy, y = truth.y_px[k] - sin(a) * ox + cos(a) * oy;
        motion += pow(tracks.x_px[m] - x, 2) + pow(tracks.y_px[m] - y, 2);
        rotation += pow(tracks.angle[m] - a, 2);
    }
    print_message("photo %d: displacement RMS %.5f px, rotation RMS %.5f deg\n", index,
                  rms(motion, 2 * reference.count), rms(rotation, reference.count) / DEGREE);
    check_at_most(rms(motion, 2 * reference.count), 0.01);
    check_at_most(rms(rotation, reference.count), 0.02 * DEGREE);
    free(row);
    table_free(&PHOTO_GRAINS, &reference);
    table_free(&PHOTO_GRAINS, &truth);
    table_free(&PHOTO_GRAINS, &tracks);
}

static void motions_are_followed(void **state)
{
    (void)state;
    for (int index = 1; index < PHOTOS; index++)
        check_motion(index);
}

/* The contact of `truth` between the same bodies as contact c of `found`; -1: there is none. Walls match by name. */
static long same_contact(const struct packing *found, size_t c, const struct packing *truth, const long *row)
{
    size_t wall;
    long i = row[found->contacts.i[c]], j;
    if (packing_is_wall(found, c, &wall)) {
        long w = walls_find(&truth->walls, found->walls.name[wall]);
        j = w < 0 ? -1 : (long)truth->grains.count + w;
    } else {
        j = row[found->contacts.j[c]];
    }
    for (size_t t = 0; t < truth->contacts.count; t++) {
        long a = (long)truth->contacts.i[t], b = (long)truth->contacts.j[t];
        if ((a == i && b == j) || (a == j && b == i))
            return (long)t;
    }
    return -1;
}

struct chain {
    struct packing truth, found;
    long *row;  /* found grain -> true grain */
    long *pair; /* found contact -> true contact */
};

static void chain_read(struct chain *chain, int index, const char *folder, const char *kind)
{
    char path[512];
    check_done(packing_read(file_name(path, TRUTH, index, "truth"), &chain->truth));
    check_done(packing_read(file_name(path, folder, index, kind), &chain->found));
    const struct grains *t = &chain->truth.grains, *f = &chain->found.grains;
    chain->row = match(f->count, f->x, f->y, f->radius, t->count, t->x, t->y);
    chain->pair = malloc((chain->found.contacts.count + 1) * sizeof *chain->pair);
    for (size_t c = 0; c < chain->found.contacts.count; c++)
        chain->pair[c] = same_contact(&chain->found, c, &chain->truth, chain->row);
}

static void chain_free(struct chain *chain)
{
    free(chain->row);
    free(chain->pair);
    packing_free(&chain->truth);
    packing_free(&chain->found);
}

static void check_network(int index)
{
    struct chain chain = {0};
    chain_read(&chain, index, OUTPUT, "contacts");
    double right = 0, called = 0, real = 0;
    for (size_t t = 0; t < chain.truth.contacts.count; t++)
        real += chain.truth.contacts.overlap[t] > 0;
    for (size_t c = 0; c < chain.found.contacts.count; c++) {
        if (chain.found.contacts.flags[c] & CONTACT_CANDIDATE)
            continue;
        called++;
        right += chain.pair[c] >= 0 && chain.truth.contacts.overlap[chain.pair[c]] > 0;
    }
    double precision = right / called, recall = right / real;
    double f1 = 2 * precision * recall / (precision + recall);
    print_message("photo %d: %.0f contacts of %.0f, precision %.4f, recall %.4f, F1 %.4f\n", index, called, real,
                  precision, recall, f1);
    check_at_most(1 - f1, 0.05);
    chain_free(&chain);
}

/* From the definition; photo 1 has 77 independent sets of self-balanced forces. */
static void indeterminacy_is_that_of_the_equations(void **state)
{
    (void)state;
    for (int index = 0; index < PHOTOS; index++) {
        struct chain chain = {0};
        double equations;
        chain_read(&chain, index, OUTPUT, "contacts");
        check_near(chain.found.indeterminacy.h, h_by_hand(&chain.found, 0.53, 0, &equations), 0);
        if (index == 1)
            check_near(chain.found.indeterminacy.h, 77, 0);
        chain_free(&chain);
    }
}

static void network_is_right(void **state)
{
    (void)state;
    for (int index = 0; index < PHOTOS; index++)
        check_network(index);
}

/* Pearson r (thesis eq. 3.3) over all contacts of either list, candidates too; what the other list does not have counts
 * as no force. NaN: no force differs from the others. */
static double pearson(const struct chain *chain, const double *found, const double *truth)
{
    size_t real = chain->truth.contacts.count, n = real;
    double *pairs = calloc(2 * (real + chain->found.contacts.count) + 1, sizeof *pairs);
    double sx = 0, sy = 0, sxx = 0, syy = 0, sxy = 0;
    for (size_t t = 0; t < real; t++)
        pairs[2 * t + 1] = truth[t];
    for (size_t c = 0; c < chain->found.contacts.count; c++)
        pairs[2 * (chain->pair[c] >= 0 ? (size_t)chain->pair[c] : n++)] = found[c];
    for (size_t k = 0; k < n; k++) {
        double x = pairs[2 * k], y = pairs[2 * k + 1], m = (double)n;
        sx += x / m, sy += y / m;
        sxx += x * x / m, syy += y * y / m, sxy += x * y / m;
    }
    free(pairs);
    return (sxy - sx * sy) / sqrt((sxx - sx * sx) * (syy - sy * sy));
}

/* The stress that the walls of the truth apply, Pa, from the loads of its top and right walls. */
static void applied_stress(const struct packing *truth, double *sxx, double *syy)
{
    const struct walls *walls = &truth->walls;
    long top = walls_find(walls, "top"), bottom = walls_find(walls, "bottom");
    long left = walls_find(walls, "left"), right = walls_find(walls, "right");
    assert_true(top >= 0 && bottom >= 0 && left >= 0 && right >= 0);
    *sxx = -walls->fx[right] / ((walls->y0[top] - walls->y0[bottom]) * truth->length_m);
    *syy = -walls->fy[top] / ((walls->x0[right] - walls->x0[left]) * truth->length_m);
}

/* The words "r(fn), r(ft)" of one cell of README's table; "-" is NaN. */
static void read_cell(const char *row, int column, double r[2])
{
    for (int k = 0; k < column && row; k++)
        row = strchr(row + 1, '|');
    assert_non_null(row);
    char words[2][16];
    assert_int_equal(sscanf(row, "| %15[^,], %15[^ ] |", words[0], words[1]), 2);
    for (int k = 0; k < 2; k++)
        r[k] = strcmp(words[k], "-") == 0 ? NAN : strtod(words[k], NULL);
}

/* README's r of every photo and method, as printed there. */
static void read_readme(double r[PHOTOS][METHODS][2])
{
    char line[1024];
    int rows = -1;
    FILE *file = fopen(FILM_SOURCE_DIR "/README.md", "r");
    assert_non_null(file);
    while (rows < PHOTOS && fgets(line, sizeof line, file)) {
        if (strncmp(line, "| photo | grains found", 22) == 0) {
            assert_non_null(fgets(line, sizeof line, file)); /* the rule below the heading */
            rows = 0;
        } else if (rows >= 0) {
            assert_int_equal(atoi(line + 1), rows);
            for (int m = 0; m < METHODS; m++)
                read_cell(line, FIRST_FORCE_COLUMN + m, r[rows][m]);
            rows++;
        }
    }
    fclose(file);
    assert_int_equal(rows, PHOTOS);
}

static void check_r(double r, double readme)
{
    if (isnan(readme))
        assert_true(isnan(r));
    else
        check_near(r, readme, 0.003);
}

static void check_forces(int index, const char *method, const double readme[2])
{
    struct chain chain = {0};
    int together = strcmp(method, "series") == 0, balanced = strcmp(method, "cem") != 0;
    chain_read(&chain, index, together ? TOGETHER : OUTPUT, "forces");
    const struct forces *f = packing_forces(&chain.found, method), *dem = packing_forces(&chain.truth, "dem");
    assert_non_null(f);
    assert_non_null(dem);
    double rn = pearson(&chain, f->contact.fn, dem->contact.fn);
    double rt = pearson(&chain, f->contact.ft, dem->contact.ft);
    double sxx, syy;
    applied_stress(&chain.truth, &sxx, &syy);
    sxx = f->stress[0][0] / sxx - 1;
    syy = f->stress[1][1] / syy - 1;
    print_message("photo %d, %s: r(fn) %.4f, r(ft) %.4f, Weber stress %+.2f %% %+.2f %%, imbalance %.2g <fn>\n", index,
                  method, rn, rt, 100 * sxx, 100 * syy, f->imbalance);
    check_r(rn, readme[0]);
    check_r(rt, readme[1]);
    if (balanced) { /* forces that balance what the walls push with have its stress */
        check_at_most(fabs(sxx), together ? 0.01 : 0.002);
        check_at_most(fabs(syy), together ? 0.01 : 0.002);
    }
    if (strcmp(method, "qsm") == 0 || strcmp(method, "cdm") == 0)
        assert_string_equal(f->start, "overlap");
    chain_free(&chain);
}

static void forces_are_as_close_as_readme_says(void **state)
{
    (void)state;
    double readme[PHOTOS][METHODS][2];
    read_readme(readme);
    for (int index = 0; index < PHOTOS; index++)
        for (int m = 0; m < METHODS; m++)
            check_forces(index, methods[m], readme[index][m]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(grains_are_found),
        cmocka_unit_test(motions_are_followed),
        cmocka_unit_test(network_is_right),
        cmocka_unit_test(indeterminacy_is_that_of_the_equations),
        cmocka_unit_test(forces_are_as_close_as_readme_says),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
