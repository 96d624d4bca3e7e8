#include "tests/bench/series_case.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/numbers/random.h"
#include "pipeline/packing/packing_file.h"

#define OVERLAP_PX 0.11 /* of <fn> */

static uint64_t key_of(uint64_t seed, uint64_t what)
{
    return random_bits(seed * 1000003 + what, 17);
}

static double mean_force(const struct packing *truth)
{
    const struct contact_forces *forces = &packing_forces(truth, "dem")->contact;
    double sum = 0, count = 0;
    for (size_t c = 0; c < forces->count; c++)
        if (forces->fn[c] > 0)
            sum += forces->fn[c], count++;
    return count > 0 ? sum / count : 1;
}

int series_case_read(const char *folder, double kappa, int packing, const char *states, struct series_case *series)
{
    char path[1000];
    struct packing first = {0};
    memset(series, 0, sizeof *series);
    snprintf(path, sizeof path, "%s/k%g-s%d/0000.truth.hdf", folder, kappa, packing);
    if (packing_read(path, &first))
        return -1;
    series->mean = mean_force(&first);
    packing_free(&first);
    while (*states) {
        int unloaded = *states == 'u', foreign = *states == 'x';
        char *end;
        long index = strtol(states + unloaded + foreign, &end, 10);
        if (end == states + unloaded + foreign || series->count == SERIES_CASE_STATES)
            return error_input("states '%s': give numbers", states);
        snprintf(path, sizeof path, "%s/k%g-s%d%s/%04ld.truth.hdf", folder, kappa, packing, unloaded ? "-unloaded" : "",
                 index);
        series->foreign[series->count] = foreign;
        if (packing_read(path, &series->truth[series->count]))
            return -1;
        series->count++;
        for (states = end; isspace((unsigned char)*states) || *states == ',';)
            states++;
    }
    return 0;
}

void series_case_free(struct series_case *series)
{
    for (size_t s = 0; s < series->count; s++)
        packing_free(&series->truth[s]), packing_free(&series->measured[s]);
    memset(series, 0, sizeof *series);
}

/* ---- drawing ---- */

struct drawing {
    const struct series_errors *errors;
    double pixel, mean, offset, window; /* m, N, m, m */
    uint64_t seed;
    size_t state;
};

static double shape_at(const struct drawing *drawing, size_t grain, double direction)
{
    double sum = 0;
    for (int h = 0; h < 4 && drawing->errors->shape > 0; h++) {
        uint64_t key = key_of(drawing->seed, 40 + (uint64_t)h);
        sum += random_normal(key, 2 * grain) * cos((h + 2) * direction) +
               random_normal(key, 2 * grain + 1) * sin((h + 2) * direction);
    }
    return 0.5 * drawing->errors->shape * drawing->pixel * sum;
}

/* Geometry of the pair (i, j) as measured into row c; 0: too far apart to be listed. */
static int put(const struct drawing *drawing, struct packing *packing, size_t c, size_t i, size_t j)
{
    const struct grains *g = &packing->grains;
    struct contacts *contacts = &packing->contacts;
    struct vec a = vec(g->x[i], g->y[i]), n;
    double overlap, variance = pow(g->s_x_ref[i], 2) + pow(g->s_radius[i], 2) + pow(g->s_x[i], 2);
    if (j >= g->count) {
        struct vec in = wall_inward(&packing->walls, j - g->count);
        n = vec_scale(-1, in);
        overlap = g->radius[i] -
                  vec_dot(vec_sub(a, vec(packing->walls.x0[j - g->count], packing->walls.y0[j - g->count])), in);
    } else {
        struct vec l = vec_sub(vec(g->x[j], g->y[j]), a);
        n = vec_unit(l);
        overlap = g->radius[i] + g->radius[j] - vec_norm(l);
        variance *= 2;
        overlap += shape_at(drawing, j, atan2(-n.y, -n.x) - g->angle[j]);
    }
    overlap += shape_at(drawing, i, atan2(n.y, n.x) - g->angle[i]);
    struct vec at = vec_add(a, vec_scale(g->radius[i] - overlap / 2, n));
    contacts->i[c] = (int64_t)i, contacts->j[c] = (int64_t)j;
    contacts->nx[c] = n.x, contacts->ny[c] = n.y, contacts->x[c] = at.x, contacts->y[c] = at.y;
    contacts->overlap[c] = overlap, contacts->s_overlap[c] = sqrt(variance);
    contacts->flags[c] = overlap < 0 ? CONTACT_CANDIDATE : 0;
    double radii = j >= g->count ? 1 : 2;
    if (drawing->errors->margin > 0) /* the offset is known, and the list cut too short */
        return overlap - radii * drawing->offset > -drawing->errors->margin * sqrt(variance);
    return overlap > -4 * sqrt(variance) - drawing->window;
}

/* Was this pair lost? The same pairs in every photo. */
static int lost(const struct drawing *drawing, size_t i, size_t j)
{
    return random_uniform(key_of(drawing->seed, 60), i * 100003 + j) < drawing->errors->lost;
}

static int find_pairs(const struct drawing *drawing, struct packing *packing)
{
    static const char *const columns[] = {"i", "j", "nx", "ny", "x", "y", "overlap", "s_overlap", "flags", NULL};
    size_t grains = packing->grains.count, most = 20 * grains + 100, found = 0;
    const struct grains *g = &packing->grains;
    table_free(&CONTACTS, &packing->contacts);
    if (table_alloc(&CONTACTS, &packing->contacts, most, columns))
        return -1;
    for (size_t i = 0; i < grains; i++)
        for (size_t j = i + 1; j < grains + packing->walls.count && found < most; j++) {
            double reach = j < grains ? g->radius[i] + g->radius[j] + 2e-3 : 0;
            if (j < grains && (fabs(g->x[i] - g->x[j]) > reach || fabs(g->y[i] - g->y[j]) > reach))
                continue;
            if (put(drawing, packing, found, i, j) && !lost(drawing, i, j))
                found++;
        }
    packing->contacts.count = found;
    return 0;
}

static void shift_walls(const struct drawing *drawing, struct walls *walls)
{
    const struct series_errors *e = drawing->errors;
    for (size_t w = 0; w < walls->count; w++) {
        double by = e->wall * random_normal(key_of(drawing->seed, 5), w);
        if (drawing->state > 0)
            by += e->track * random_normal(key_of(drawing->seed, 100 + drawing->state), w);
        struct vec move = vec_scale(by * drawing->pixel, wall_inward(walls, w));
        walls->x0[w] += move.x, walls->x1[w] += move.x, walls->y0[w] += move.y, walls->y1[w] += move.y;
        walls->s_offset[w] = e->wall * drawing->pixel;
        double factor = 1 + e->wall_load * random_normal(key_of(drawing->seed, 6), w);
        walls->fx[w] *= factor, walls->fy[w] *= factor;
    }
}

static void move_grains(const struct drawing *drawing, double offset, struct grains *g)
{
    const struct series_errors *e = drawing->errors;
    uint64_t key = key_of(drawing->seed, 3), photo = key_of(drawing->seed, 1000 + drawing->state);
    double pixel = drawing->pixel, degree = acos(-1) / 180, tracked = drawing->state > 0; /* state 0: the reference */
    for (size_t k = 0; k < g->count; k++) {
        g->x[k] += pixel * (e->place * random_normal(key, 3 * k) + tracked * e->track * random_normal(photo, 3 * k));
        g->y[k] +=
            pixel * (e->place * random_normal(key, 3 * k + 1) + tracked * e->track * random_normal(photo, 3 * k + 1));
        g->angle[k] += tracked * degree * e->track_deg * random_normal(photo, 3 * k + 2);
        g->radius[k] += offset + pixel * e->radius * random_normal(key, 3 * k + 2);
        g->s_x_ref[k] = g->s_y_ref[k] = pixel * e->place, g->s_radius[k] = pixel * e->radius;
        g->s_x[k] = g->s_y[k] = tracked * pixel * e->track, g->s_angle[k] = tracked * degree * e->track_deg;
        if (e->shape > 0)
            g->s_shape[k] = pixel * e->shape;
    }
}

static int draw_state(const struct drawing *drawing, const struct packing *truth, double offset,
                      struct packing *measured)
{
    static const char *const errors[] = {"s_x",      "s_y",    "s_angle", "s_x_ref", "s_y_ref",
                                         "s_radius", "load_x", "load_y",  NULL};
    packing_free(measured);
    measured->length_m = truth->length_m;
    if (table_copy(&GRAINS, &measured->grains, &truth->grains) || table_copy(&WALLS, &measured->walls, &truth->walls) ||
        table_add(&WALLS, &measured->walls, "s_offset"))
        return -1;
    for (int k = 0; errors[k]; k++)
        if (table_add(&GRAINS, &measured->grains, errors[k]))
            return -1;
    if (drawing->errors->shape > 0 && table_add(&GRAINS, &measured->grains, "s_shape"))
        return -1;
    for (size_t k = 0; k < measured->grains.count; k++) {
        double body = drawing->errors->body * drawing->mean;
        measured->grains.load_x[k] = body * random_normal(key_of(drawing->seed, 8), 2 * k);
        measured->grains.load_y[k] = body * random_normal(key_of(drawing->seed, 8), 2 * k + 1);
        if (measured->grains.load_m)
            measured->grains.load_m[k] = 0;
    }
    move_grains(drawing, offset, &measured->grains);
    shift_walls(drawing, &measured->walls);
    return find_pairs(drawing, measured);
}

int series_case_draw(struct series_case *series, const struct series_errors *errors, uint64_t seed)
{
    double kn = 1.09e7;
    series->pixel = series->mean / kn / OVERLAP_PX;
    series->offset = errors->offset * series->pixel * (random_uniform(key_of(seed, 1), 0) < 0.5 ? -1 : 1);
    for (size_t s = 0; s < series->count; s++) {
        struct drawing drawing = {
            errors, series->pixel, series->mean, series->offset, 2 * errors->offset * series->pixel, seed, s};
        if (series->foreign[s])
            drawing.seed = seed + 500;
        if (draw_state(&drawing, &series->truth[s], series->offset, &series->measured[s]))
            return -1;
    }
    return 0;
}

/* ---- scoring ---- */

struct sums {
    double n, se, a, b, aa, bb, ab;
};

static void count_in(struct sums *sums, double p, double q)
{
    sums->n++, sums->se += (p - q) * (p - q);
    sums->a += p, sums->b += q, sums->aa += p * p, sums->bb += q * q, sums->ab += p * q;
}

static double pearson(const struct sums *s)
{
    return (s->ab - s->a * s->b / s->n) / sqrt((s->aa - s->a * s->a / s->n) * (s->bb - s->b * s->b / s->n));
}

/* Row of (i, j), both lists sorted by i, j; `at` goes on from call to call. */
static int find_row(const struct contacts *contacts, int64_t i, int64_t j, size_t *at)
{
    while (*at < contacts->count && (contacts->i[*at] < i || (contacts->i[*at] == i && contacts->j[*at] < j)))
        ++*at;
    return *at < contacts->count && contacts->i[*at] == i && contacts->j[*at] == j;
}

struct pair_row {
    int64_t i, j;
    size_t row;
};

static int compare_rows(const void *a, const void *b)
{
    const struct pair_row *p = a, *q = b;
    return p->i != q->i ? (p->i > q->i) - (p->i < q->i) : (p->j > q->j) - (p->j < q->j);
}

static struct pair_row *sorted_rows(const struct contacts *contacts)
{
    struct pair_row *rows = malloc((contacts->count + 1) * sizeof *rows);
    for (size_t c = 0; rows && c < contacts->count; c++)
        rows[c] = (struct pair_row){contacts->i[c], contacts->j[c], c};
    if (rows)
        qsort(rows, contacts->count, sizeof *rows, compare_rows);
    return rows;
}

static void score_state(const struct packing *truth, const struct packing *measured, const struct forces *forces,
                        struct series_score *sum)
{
    const struct contact_forces *dem = &packing_forces(truth, "dem")->contact, *found = &forces->contact;
    struct pair_row *rows = sorted_rows(&truth->contacts);
    struct sums fn = {0}, ft = {0};
    double mean = mean_force(truth), zn = 0, zt = 0, stated = 0, held = 0;
    size_t at = 0;
    for (size_t k = 0; rows && k < truth->contacts.count; k++) {
        size_t c = rows[k].row;
        int there = find_row(&measured->contacts, rows[k].i, rows[k].j, &at);
        count_in(&fn, dem->fn[c], there ? found->fn[at] : 0);
        if (rows[k].j < (int64_t)truth->grains.count)
            count_in(&ft, dem->ft[c], there ? found->ft[at] : 0);
        if (!there || !found->s_fn || !isfinite(found->s_fn[at]))
            continue;
        double slack = 1e-3 * mean;
        zn += pow((found->fn[at] - dem->fn[c]) / (found->s_fn[at] + slack), 2);
        zt += pow((found->ft[at] - dem->ft[c]) / (found->s_ft[at] + slack), 2);
        held += dem->fn[c] >= found->fn_min[at] - slack && dem->fn[c] <= found->fn_max[at] + slack;
        stated++;
    }
    free(rows);
    sum->fn += sqrt(fn.se / fn.n) / mean, sum->ft += sqrt(ft.se / ft.n) / mean;
    sum->r_fn += pearson(&fn), sum->r_ft += pearson(&ft);
    sum->z_fn += stated > 0 ? sqrt(zn / stated) : NAN, sum->z_ft += stated > 0 ? sqrt(zt / stated) : NAN;
    sum->held += stated > 0 ? held / stated : NAN;
}

struct series_score series_case_score_one(const struct series_case *series, size_t state, const struct forces *forces)
{
    struct series_score score = {0};
    score_state(&series->truth[state], &series->measured[state], forces, &score);
    return score;
}

struct series_score series_case_score(const struct series_case *series, const struct forces *forces)
{
    struct series_score sum = {0};
    double n = (double)series->count;
    for (size_t s = 0; s < series->count; s++)
        score_state(&series->truth[s], &series->measured[s], &forces[s], &sum);
    return (struct series_score){sum.fn / n,   sum.ft / n,   sum.r_fn / n, sum.r_ft / n,
                                 sum.z_fn / n, sum.z_ft / n, sum.held / n};
}
