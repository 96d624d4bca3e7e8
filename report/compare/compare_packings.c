/* Two packings against each other: grains by position, walls by name, contacts by the two bodies that they join,
 * forces by contact. With f = (fn, ft), sums over the contacts c that are compared, and N their number,
 *
 *     r    = sum (a_c - <a>) (b_c - <b>) / (sum (a_c - <a>)^2 sum (b_c - <b>)^2)^1/2     (thesis eq. 3.3)
 *     dist = 1/N sum |f_c of A - f_c of B|                                                (thesis eq. 3.4)
 *
 * r does not see a common factor, dist does: a method that has the pattern but not the level shows r near 1 and a
 * large dist. r is given over the contacts that
 * A and B share, dist and r "_all" over those of either file: a contact that one of them lacks has the force 0 there.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/packing/stress.h"
#include "report/compare/compare.h"
#include "report/compare/match.h"
#include "report/states/method_choice.h"
#include "report/compare/spread.h"

double pearson(const double *a, const double *b, size_t count)
{
    double mean_a = 0, mean_b = 0, aa = 0, bb = 0, ab = 0;
    for (size_t k = 0; k < count; k++) {
        mean_a += a[k] / (double)count;
        mean_b += b[k] / (double)count;
    }
    for (size_t k = 0; k < count; k++) {
        aa += (a[k] - mean_a) * (a[k] - mean_a);
        bb += (b[k] - mean_b) * (b[k] - mean_b);
        ab += (a[k] - mean_a) * (b[k] - mean_b);
    }
    return count > 1 && aa > 0 && bb > 0 ? ab / sqrt(aa * bb) : NAN;
}

/* ---- which contact is which ---- */

/* A contact by its two bodies in the numbering of B: i < j. */
struct bond {
    int64_t i, j;
    size_t contact;
};

/* Order for qsort() and bsearch(): by i, then j. */
static int by_bodies(const void *left, const void *right)
{
    const struct bond *p = left, *q = right;
    if (p->i != q->i)
        return p->i < q->i ? -1 : 1;
    return (p->j > q->j) - (p->j < q->j);
}

/* Candidates (near, but not known to touch) and rows with a flag of distrust do not count as contacts. */
static int is_contact(const struct packing *packing, size_t c)
{
    return !(packing->contacts.flags[c] & (CONTACT_CANDIDATE | GRAIN_DISTRUST));
}

/* Body of A in the numbering of B, -1: unknown there. Walls are the same when their names are. */
static int64_t body_in_b(const struct packing *a, const struct packing *b, const long *row, int64_t body)
{
    if (body < (int64_t)a->grains.count)
        return row[body];
    char name[NAME_LENGTH + 1] = "";
    memcpy(name, a->walls.name[body - (int64_t)a->grains.count], NAME_LENGTH);
    long wall = walls_find(&b->walls, name);
    return wall < 0 ? -1 : (int64_t)b->grains.count + wall;
}

/* The contacts of B by their bodies, for bsearch(); to be freed; NULL without memory (no error is set). */
static struct bond *sorted_bonds(const struct packing *b, size_t *count)
{
    struct bond *bonds = malloc((b->contacts.count + 1) * sizeof *bonds);
    *count = 0;
    if (!bonds)
        return NULL;
    for (size_t c = 0; c < b->contacts.count; c++)
        if (is_contact(b, c))
            bonds[(*count)++] = (struct bond){b->contacts.i[c], b->contacts.j[c], c};
    qsort(bonds, *count, sizeof *bonds, by_bodies);
    return bonds;
}

/* same[c]: the contact of B between the bodies of contact c of A; -1: none. */
static int match_contacts(const struct packing *a, const struct packing *b, const long *row, long *same)
{
    size_t count;
    struct bond *bonds = sorted_bonds(b, &count);
    if (!bonds)
        return error_memory("matching of contacts");
    for (size_t c = 0; c < a->contacts.count; c++) {
        int64_t i = body_in_b(a, b, row, a->contacts.i[c]), j = body_in_b(a, b, row, a->contacts.j[c]);
        struct bond key = {i < j ? i : j, i < j ? j : i, 0}, *found = NULL;
        if (i >= 0 && j >= 0 && count)
            found = bsearch(&key, bonds, count, sizeof key, by_bodies);
        same[c] = found ? (long)found->contact : -1;
    }
    free(bonds);
    return 0;
}

/* ---- what is compared ---- */

/* Centres and radii of the grains that both have. The error of a centre is counted once per axis, so that its root
 * mean square compares with a standard error per axis. Flagged grains of A count as found only. */
static void compare_geometry(const struct packing *a, const struct packing *b, const long *row, struct figures *figures)
{
    struct spread x = {0}, radius = {0};
    size_t found = 0;
    for (size_t k = 0; k < a->grains.count; k++) {
        if (row[k] < 0)
            continue;
        found++;
        if (a->grains.flags[k] & GRAIN_DISTRUST)
            continue;
        spread_add(&x, a->grains.x[k] - b->grains.x[row[k]]);
        spread_add(&x, a->grains.y[k] - b->grains.y[row[k]]);
        spread_add(&radius, a->grains.radius[k] - b->grains.radius[row[k]]);
    }
    figures_add(figures, "grains_a", (double)a->grains.count, "1", "grains in A");
    figures_add(figures, "grains_b", (double)b->grains.count, "1", "grains in B");
    figures_add(figures, "found", (double)found, "1", "grains of B found in A");
    figures_add(figures, "centre_rms_m", spread_rms(&x), "m", "centre, RMS per axis");
    figures_add(figures, "radius_rms_m", spread_rms(&radius), "m", "radius, RMS");
    figures_add(figures, "radius_bias_m", spread_mean(&radius), "m", "radius, mean error");
}

/* Which contacts A lists, judged by B: precision (share of A's that B has), recall (share of B's that A has) and F1,
 * their harmonic mean 2 both / (A + B). A contact of B that is only a candidate in A is missed, and counted as such.
 * Pull is the overlap's error over its own standard error: 1 when the standard errors are honest. */
static void compare_lists(const struct packing *a, const struct packing *b, const long *same, struct figures *figures)
{
    size_t in_a = 0, in_b = 0, both = 0, candidates = 0;
    struct spread overlap = {0}, pull = {0};
    for (size_t c = 0; c < b->contacts.count; c++)
        in_b += (size_t)is_contact(b, c);
    for (size_t c = 0; c < a->contacts.count; c++) {
        candidates += same[c] >= 0 && !is_contact(a, c);
        if (!is_contact(a, c))
            continue;
        in_a++;
        both += same[c] >= 0;
        if (same[c] < 0)
            continue;
        double error = a->contacts.overlap[c] - b->contacts.overlap[same[c]];
        spread_add(&overlap, error);
        if (column_or_zero(a->contacts.s_overlap, c) > 0)
            spread_add(&pull, error / a->contacts.s_overlap[c]);
    }
    double precision = (double)both / (double)in_a, recall = (double)both / (double)in_b;
    figures_add(figures, "contacts_a", (double)in_a, "1", "contacts in A");
    figures_add(figures, "contacts_b", (double)in_b, "1", "contacts in B");
    figures_add(figures, "contacts_common", (double)both, "1", "contacts in both");
    figures_add(figures, "contacts_candidates", (double)candidates, "1",
                "contacts of B that A lists as candidates only");
    figures_add(figures, "contact_precision", precision, "1", "precision: share of A's contacts that B has");
    figures_add(figures, "contact_recall", recall, "1", "recall: share of B's contacts that A has");
    figures_add(figures, "contact_f1", 2 * (double)both / (double)(in_a + in_b), "1", "F1");
    figures_add(figures, "overlap_rms_m", spread_rms(&overlap), "m", "overlap of common contacts, RMS error");
    figures_add(figures, "overlap_bias_m", spread_mean(&overlap), "m", "overlap of common contacts, mean error");
    figures_add(figures, "overlap_pull", spread_rms(&pull), "1", "overlap, RMS of error over standard error");
}

/* Forces side by side: first the common contacts, then those of one file only, set against 0. */
struct samples {
    double *fn[2], *ft[2];
    size_t common, count;
};

/* Accepts a zeroed struct. */
static void samples_free(struct samples *s)
{
    for (int f = 0; f < 2; f++) {
        free(s->fn[f]);
        free(s->ft[f]);
    }
}

/* A contact whose force is not known on one side (NaN) is left out of both. */
static void add_sample(struct samples *s, double fn_a, double ft_a, double fn_b, double ft_b)
{
    if (isnan(fn_a) || isnan(ft_a) || isnan(fn_b) || isnan(ft_b))
        return;
    s->fn[0][s->count] = fn_a, s->ft[0][s->count] = ft_a;
    s->fn[1][s->count] = fn_b, s->ft[1][s->count] = ft_b;
    s->count++;
}

/* fn and ft do not change when i and j change places: normal and tangent turn together. */
static int gather_samples(const struct packing *a, const struct packing *b, const struct forces *fa,
                          const struct forces *fb, const long *same, struct samples *s)
{
    size_t most = a->contacts.count + b->contacts.count + 1;
    char *taken = calloc(b->contacts.count + 1, 1);
    memset(s, 0, sizeof *s);
    for (int f = 0; f < 2; f++) {
        s->fn[f] = malloc(most * sizeof(double));
        s->ft[f] = malloc(most * sizeof(double));
    }
    if (!taken || !s->fn[0] || !s->fn[1] || !s->ft[0] || !s->ft[1]) {
        free(taken);
        samples_free(s);
        return error_memory("comparison of forces");
    }
    const struct contact_forces *ca = &fa->contact, *cb = &fb->contact;
    for (size_t c = 0; c < a->contacts.count; c++)
        if (same[c] >= 0) {
            taken[same[c]] = 1;
            add_sample(s, ca->fn[c], ca->ft[c], cb->fn[same[c]], cb->ft[same[c]]);
        }
    s->common = s->count;
    for (size_t c = 0; c < a->contacts.count; c++)
        if (same[c] < 0)
            add_sample(s, ca->fn[c], ca->ft[c], 0, 0);
    for (size_t c = 0; c < b->contacts.count; c++)
        if (!taken[c])
            add_sample(s, 0, 0, cb->fn[c], cb->ft[c]);
    free(taken);
    return 0;
}

/* `mean`: <fn> of B, N, which makes the distance a share. */
static void add_distance(const struct samples *s, double mean, struct figures *figures)
{
    struct spread all = {0};
    for (size_t k = 0; k < s->count; k++)
        spread_add(&all, hypot(s->fn[0][k] - s->fn[1][k], s->ft[0][k] - s->ft[1][k]));
    figures_add(figures, "dist_N", spread_mean(&all), "N", "dist: mean size of the force difference (eq. 3.4)");
    figures_add(figures, "dist_over_fn", spread_mean(&all) / mean, "1", "dist / <fn> of B");
}

/* Weber's stress sigma = (1/A) sum l f of one packing, four figures. The area A is that of packing_area(), so both
 * files are asked for their own. Names end in the unit, Pa or N/m, as the length of the rods is known or not.
 * `which`: "a" or "b". */
static int add_stress(const struct packing *packing, const struct forces *forces, const char *which,
                      struct figures *figures)
{
    static const char *const text[2][4] = {
        {"Weber stress of A, xx", "Weber stress of A, yy", "Weber stress of A, xy", "Weber stress of A, yx"},
        {"Weber stress of B, xx", "Weber stress of B, yy", "Weber stress of B, xy", "Weber stress of B, yx"}};
    static const int at[4][2] = {{0, 0}, {1, 1}, {0, 1}, {1, 0}};
    static const char axis[] = "xy";
    double sigma[2][2], area;
    const char *units = isnan(packing->length_m) ? "N/m" : "Pa";
    if (packing_area(packing, &area))
        return -1;
    stress_weber(packing, forces->contact.fn, forces->contact.ft, area, sigma);
    for (int k = 0; k < 4; k++) {
        char name[40];
        snprintf(name, sizeof name, "stress_%s_%c%c_%s", which, axis[at[k][0]], axis[at[k][1]],
                 isnan(packing->length_m) ? "N_per_m" : "Pa");
        figures_add(figures, name, sigma[at[k][0]][at[k][1]], units, text[*which == 'b'][k]);
    }
    return 0;
}

/* Largest and typical unbalanced force on a grain of A, over <fn> of A. */
static void add_imbalance(const struct packing *a, const struct forces *forces, double mean, struct figures *figures)
{
    struct spread size = {0};
    const struct residuals *residual = &forces->residual;
    size_t count = residual->residual_x && residual->residual_y ? residual->count : 0;
    for (size_t k = 0; k < count; k++)
        if (!(a->grains.flags[k] & (GRAIN_FIXED | GRAIN_DISTRUST)))
            spread_add(&size, hypot(residual->residual_x[k], residual->residual_y[k]));
    figures_add(figures, "residual_rms_over_fn", spread_rms(&size) / mean, "1",
                "unbalanced force of A, RMS / <fn> of A");
    figures_add(figures, "residual_max_over_fn", spread_largest(&size) / mean, "1",
                "unbalanced force of A, largest / <fn> of A");
}

/* All figures of one pair of methods. 0, or -1 with an error: memory. */
static int compare_forces(const struct packing *a, const struct packing *b, const struct forces *fa,
                          const struct forces *fb, const long *same, struct figures *figures)
{
    struct samples s;
    if (gather_samples(a, b, fa, fb, same, &s))
        return -1;
    double mean_a = forces_mean(fa->contact.fn, a->contacts.count, 1, NULL);
    double mean_b = forces_mean(fb->contact.fn, b->contacts.count, 1, NULL);
    figures_add(figures, "r_fn", pearson(s.fn[0], s.fn[1], s.common), "1",
                "Pearson r of fn, common contacts (eq. 3.3)");
    figures_add(figures, "r_ft", pearson(s.ft[0], s.ft[1], s.common), "1", "Pearson r of ft, common contacts");
    figures_add(figures, "r_fn_all", pearson(s.fn[0], s.fn[1], s.count), "1",
                "Pearson r of fn, contacts of one file count as 0");
    figures_add(figures, "r_ft_all", pearson(s.ft[0], s.ft[1], s.count), "1",
                "Pearson r of ft, contacts of one file count as 0");
    add_distance(&s, mean_b, figures);
    figures_add(figures, "mean_fn_a_N", mean_a, "N", "<fn> of A, over loaded contacts");
    figures_add(figures, "mean_fn_b_N", mean_b, "N", "<fn> of B, over loaded contacts");
    int status = add_stress(a, fa, "a", figures) || add_stress(b, fb, "b", figures) ? -1 : 0;
    add_imbalance(a, fa, mean_a, figures);
    samples_free(&s);
    return status;
}

/* By name, or the default one; NULL: the packing has none such. Borrowed. */
static const struct forces *pick_forces(const struct packing *packing, const char *method)
{
    return method ? packing_forces(packing, method) : method_default(packing);
}

/* same[c]: the row of contact c of A in B, or -1; to be freed. row: the same for grains, kept when `rows` is given. */
static long *pair_contacts(const struct packing *a, const struct packing *b, long **rows)
{
    struct match_points pa = {a->grains.count, a->grains.x, a->grains.y},
                        pb = {b->grains.count, b->grains.x, b->grains.y};
    long *row = malloc((a->grains.count + 1) * sizeof *row), *same = malloc((a->contacts.count + 1) * sizeof *same);
    int result = row && same ? match_grains(&pa, &pb, b->grains.radius, row) : error_memory("matching of grains");
    if (result == 0)
        result = match_contacts(a, b, row, same);
    if (rows && result == 0)
        *rows = row;
    else
        free(row);
    if (result == 0)
        return same;
    free(same);
    return NULL;
}

int compare_force_errors(const struct packing *a, const struct packing *b, const char *method_a, const char *method_b,
                         double **errors, size_t *count)
{
    const struct forces *fa = pick_forces(a, method_a), *fb = pick_forces(b, method_b);
    struct samples s;
    *errors = NULL;
    *count = 0;
    if (!fa || !fb)
        return 0;
    long *same = pair_contacts(a, b, NULL);
    int result = same ? gather_samples(a, b, fa, fb, same, &s) : -1;
    free(same);
    if (result)
        return -1;
    double mean = forces_mean(fb->contact.fn, b->contacts.count, 1, NULL);
    *errors = malloc((s.count + 1) * sizeof **errors);
    for (size_t k = 0; k < s.count && *errors; k++)
        (*errors)[k] = fabs(s.fn[0][k] - s.fn[1][k]) / mean;
    *count = s.count;
    samples_free(&s);
    return *errors ? 0 : error_memory("comparison of forces");
}

int compare_packings(const struct packing *a, const struct packing *b, const char *method_a, const char *method_b,
                     struct figures *figures)
{
    const struct forces *fa = pick_forces(a, method_a), *fb = pick_forces(b, method_b);
    if (method_a && a->force_count && !fa)
        return error_input("A has no forces of method '%s': choose one that it has with --method", method_a);
    if (method_b && b->force_count && !fb)
        return error_input("B has no forces of method '%s': choose one that it has with --truth-method", method_b);
    long *row = NULL, *same = pair_contacts(a, b, &row);
    int result = same ? 0 : -1;
    if (result == 0) {
        compare_geometry(a, b, row, figures);
        compare_lists(a, b, same, figures);
        if (fa && fb)
            result = compare_forces(a, b, fa, fb, same, figures);
    }
    free(row);
    free(same);
    return result;
}
