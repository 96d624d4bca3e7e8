#include "pipeline/packing/packing_check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"

#define LEAST_COSINE 0.9  /* between normal and branch */
#define PLACE_SHARE 0.25  /* of a radius: contact point and overlap */
#define RADIUS_SHARE 0.1  /* by which the radius of one grain may differ between two states */
#define OTHERS_SHARE 0.05 /* of the rows: that many may be measured anew, or wrong */

/* ---- pairs ---- */

/* A contact by its bodies, for sorting. */
struct pair {
    int64_t i, j;
    size_t row;
};

static int compare_pairs(const void *left, const void *right)
{
    const struct pair *a = left, *b = right;
    if (a->i != b->i)
        return a->i < b->i ? -1 : 1;
    if (a->j != b->j)
        return a->j < b->j ? -1 : 1;
    return a->row < b->row ? -1 : a->row > b->row;
}

/* No two contacts join the same bodies. */
static int check_pairs(const char *path, const struct contacts *contacts)
{
    struct pair *pairs = malloc((contacts->count + 1) * sizeof *pairs);
    int status = pairs ? 0 : error_memory("pairs of a packing");
    for (size_t c = 0; c < contacts->count && pairs; c++)
        pairs[c] = (struct pair){contacts->i[c], contacts->j[c], c};
    if (pairs)
        qsort(pairs, contacts->count, sizeof *pairs, compare_pairs);
    for (size_t c = 1; c < contacts->count && !status; c++)
        if (pairs[c].i == pairs[c - 1].i && pairs[c].j == pairs[c - 1].j)
            status = error_input("%s: contacts %zu and %zu both join %lld and %lld: leave one of them out", path,
                                 pairs[c - 1].row, pairs[c].row, (long long)pairs[c].i, (long long)pairs[c].j);
    free(pairs);
    return status;
}

/* ---- the geometry of one contact ---- */

/* R_i + R_j - d from the centres and radii of the table; for a wall R_i less the distance of its line. */
static double overlap_of_circles(const struct packing *packing, size_t c, double distance)
{
    const struct contacts *contacts = &packing->contacts;
    size_t wall;
    double radius = packing->grains.radius[contacts->i[c]];
    double partner =
        packing_is_wall(packing, c, &wall) ? packing->walls.radius[wall] : packing->grains.radius[contacts->j[c]];
    return radius + partner - distance;
}

/* The normal points from i to j, as the centres say. */
static int check_contact(const char *path, const struct packing *packing, size_t c)
{
    const struct contacts *contacts = &packing->contacts;
    const struct grains *grains = &packing->grains;
    size_t i = (size_t)contacts->i[c];
    struct vec branch = packing_branch(packing, c), normal = vec(contacts->nx[c], contacts->ny[c]);
    double distance = vec_norm(branch), radius = grains->radius[i];
    if (!(distance > 1e-6 * radius)) /* one centre on the other has no direction */
        return 0;
    double cosine = vec_dot(branch, normal) / distance;
    if (cosine < LEAST_COSINE)
        return error_input(
            "%s: the normal of contact %zu points %.0f degrees away from the line between its bodies: it "
            "must point from i to j: make the file again",
            path, c, acos(fmax(-1, cosine)) * 180 / M_PI);
    struct vec wanted = vec_add(vec(grains->x[i], grains->y[i]), vec_scale(radius - contacts->overlap[c] / 2, normal));
    double off = vec_norm(vec_sub(vec(contacts->x[c], contacts->y[c]), wanted));
    if (off > PLACE_SHARE * radius)
        return error_input("%s: the point of contact %zu lies %.3g m from the middle of its overlap: make the file "
                           "again",
                           path, c, off);
    double overlap = overlap_of_circles(packing, c, distance);
    if (fabs(overlap - contacts->overlap[c]) > PLACE_SHARE * radius)
        return error_input("%s: contact %zu has an overlap of %.3g m, but the rims of its bodies overlap by %.3g m: "
                           "make the file again",
                           path, c, contacts->overlap[c], overlap);
    return 0;
}

/* Of contacts whose rows and bodies are trusted. */
static int check_geometry(const char *path, const struct packing *packing)
{
    const uint32_t *flags = packing->grains.flags;
    for (size_t c = 0; c < packing->contacts.count; c++) {
        int64_t i = packing->contacts.i[c], j = packing->contacts.j[c];
        int distrusted = (packing->contacts.flags[c] | flags[i]) & GRAIN_DISTRUST ||
                         ((size_t)j < packing->grains.count && flags[j] & GRAIN_DISTRUST);
        if (!distrusted && check_contact(path, packing, c))
            return -1;
    }
    return 0;
}

/* ---- numbers that cannot be ---- */

static int is_negative(double value)
{
    return value < 0;
}

static int is_infinite(double value)
{
    return isinf(value);
}

/* The first row of a column, which may be absent, of which `wrong` says so; SIZE_MAX: none. */
static size_t first_wrong(const double *column, size_t count, int (*wrong)(double value))
{
    for (size_t k = 0; column && k < count; k++)
        if (wrong(column[k]))
            return k;
    return SIZE_MAX;
}

/* Every column of a table whose name begins so ("s_": standard errors). */
static int check_columns(const char *path, const struct table_kind *kind, const void *table, const char *group,
                         const char *prefix, int (*wrong)(double value), const char *what)
{
    for (size_t c = 0; c < kind->column_count; c++) {
        const struct column *column = &kind->columns[c];
        if (column->type != COLUMN_DOUBLE || strncmp(column->name, prefix, strlen(prefix)))
            continue;
        size_t row = first_wrong(*table_array(column, table), table_rows(kind, table), wrong);
        if (row != SIZE_MAX)
            return error_input("%s: column /%s/%s has %s in row %zu: make the file again", path, group, column->name,
                               what, row);
    }
    return 0;
}

/* Standard errors are not negative, loads not infinite. */
static int check_numbers(const char *path, const struct packing *packing)
{
    static const char error[] = "a standard error below 0", load[] = "an infinite load";
    if (packing->length_m <= 0)
        return error_input("%s: rods of a length of %g m: give length_m above 0, or leave it out", path,
                           packing->length_m);
    return check_columns(path, &GRAINS, &packing->grains, "grains", "s_", is_negative, error) ||
                   check_columns(path, &WALLS, &packing->walls, "walls", "s_", is_negative, error) ||
                   check_columns(path, &CONTACTS, &packing->contacts, "contacts", "s_", is_negative, error) ||
                   check_columns(path, &GRAINS, &packing->grains, "grains", "load_", is_infinite, load) ||
                   check_columns(path, &WALLS, &packing->walls, "walls", "f", is_infinite, load)
               ? -1
               : 0;
}

int packing_check(const char *path, const struct packing *packing)
{
    return check_numbers(path, packing) || check_pairs(path, &packing->contacts) || check_geometry(path, packing) ? -1
                                                                                                                  : 0;
}

int packing_check_previous(const char *path, const struct packing *previous, const struct packing *now)
{
    const struct grains *a = &previous->grains, *b = &now->grains;
    size_t others = 0, seen = 0;
    if (a->count != b->count)
        return error_input("%s: has %zu grains, but this state has %zu: give a state of the same grains as --previous",
                           path, a->count, b->count);
    for (size_t k = 0; k < a->count; k++) {
        if ((a->flags[k] | b->flags[k]) & GRAIN_DISTRUST)
            continue;
        seen++;
        others += fabs(a->radius[k] - b->radius[k]) > RADIUS_SHARE * b->radius[k];
    }
    if ((double)others <= OTHERS_SHARE * (double)seen)
        return 0;
    return error_input("%s: %zu of %zu rows are grains of another radius than in this state: row k must be grain k in "
                       "every file: give a state of the same series as --previous",
                       path, others, seen);
}
