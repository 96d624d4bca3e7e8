/* From the simulation's lists to the tables of a packing. Everything that a stage later works out again (motions,
 * residuals, stress) is computed here from the tables or by the formulas of docs/theory.md section 1, so that the truth
 * of a simulated state obeys the same definitions. Rows of contacts are the touching pairs in the order of the list:
 * grains by (i, j), then walls by (i, side). */
#include "simulation/dem/snapshot.h"

#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/packing/stress.h"

static const char *const SIDE_NAMES[SIDES] = {"bottom", "right", "top", "left"};
static const char *const CORNER_NAMES[BOX_CORNERS] = {"bottom-left", "bottom-right", "top-right", "top-left"};
/* A contact carries when its force is more than what the relaxation leaves unbalanced. */
static const double CARRIES = 1e-5;

int snapshot_take(const struct dem *dem, struct snapshot *snapshot)
{
    memset(snapshot, 0, sizeof *snapshot);
    snapshot->grains = malloc((dem->count + 1) * sizeof *snapshot->grains);
    snapshot->pairs = malloc((dem->pair_count + 1) * sizeof *snapshot->pairs);
    if (!snapshot->grains || !snapshot->pairs) {
        snapshot_free(snapshot);
        return error_memory("a saved state");
    }
    snapshot->given = 1;
    snapshot->count = dem->count;
    memcpy(snapshot->grains, dem->grains, dem->count * sizeof *snapshot->grains);
    snapshot->box = dem->box;
    for (size_t p = 0; p < dem->pair_count; p++)
        if (dem->pairs[p].touching)
            snapshot->pairs[snapshot->pair_count++] = dem->pairs[p];
    return 0;
}

void snapshot_free(struct snapshot *snapshot)
{
    free(snapshot->grains);
    free(snapshot->pairs);
    memset(snapshot, 0, sizeof *snapshot);
}

/* Load columns only where something is loaded: gravity counts as a load. */
static int write_grains(const struct dem *dem, struct grains *grains)
{
    static const char *const columns[] = {"x", "y", "radius", "angle", "mass", "inertia", "flags", NULL};
    static const char *const loads[] = {"load_x", "load_y", "load_m"};
    if (table_alloc(&GRAINS, grains, dem->count, columns))
        return -1;
    int loaded = dem->gravity.x != 0 || dem->gravity.y != 0;
    for (size_t k = 0; k < dem->count; k++)
        loaded |= dem->grains[k].load_x != 0 || dem->grains[k].load_y != 0 || dem->grains[k].load_m != 0;
    for (int c = 0; loaded && c < 3; c++)
        if (table_add(&GRAINS, grains, loads[c]))
            return -1;
    for (size_t k = 0; k < dem->count; k++) {
        const struct dem_grain *g = &dem->grains[k];
        grains->x[k] = g->x;
        grains->y[k] = g->y;
        grains->radius[k] = g->radius;
        grains->angle[k] = g->angle;
        grains->mass[k] = g->mass;
        grains->inertia[k] = g->inertia;
        grains->flags[k] = g->fixed ? GRAIN_FIXED : 0;
        if (loaded) {
            grains->load_x[k] = g->load_x + g->mass * dem->gravity.x;
            grains->load_y[k] = g->load_y + g->mass * dem->gravity.y;
            grains->load_m[k] = g->load_m;
        }
    }
    return 0;
}

/* Ends of a side, the interior on the left. */
static void side_ends(const struct dem_box *box, int side, struct vec *from, struct vec *to)
{
    *from = dem_corner_at(box, side);
    *to = dem_corner_at(box, (side + 1) % BOX_CORNERS);
}

/* Load along the normal: what the servo applies; where the wall is held, and along the wall: the reaction. The forces
 * on its two corner discs enter in x for the side walls, in y for the bottom and the top. */
static struct vec side_load(const struct dem *dem, const struct servo *servo, int side)
{
    struct vec load = vec_sub(vec(0, 0), dem->box.side[side].force);
    for (int end = 0; end < 2 && dem->box.corner_radius > 0; end++) {
        struct vec force = dem->box.corner[(side + end) % BOX_CORNERS].force;
        int upright = side == SIDE_RIGHT || side == SIDE_LEFT;
        load = vec_sub(load, upright ? vec(force.x, 0) : vec(0, force.y));
    }
    if (side == SIDE_RIGHT && servo->hold[BOX_WIDTH] == HOLD_STRESS)
        load.x = servo_load(dem, servo, BOX_WIDTH);
    if (side == SIDE_TOP && servo->hold[BOX_HEIGHT] == HOLD_STRESS && dem->box.size[BOX_SHEAR] == 0)
        load.y = servo_load(dem, servo, BOX_HEIGHT);
    return load;
}

/* Rows after the sides. Their loads are part of those of the sides. */
static void write_corners(const struct dem *dem, const struct snapshot *previous, struct walls *walls)
{
    for (int k = 0; k < BOX_CORNERS; k++) {
        size_t w = (size_t)(SIDES + k);
        struct vec at = dem_corner_at(&dem->box, k);
        strcpy(walls->name[w], CORNER_NAMES[k]);
        walls->x0[w] = walls->x1[w] = at.x;
        walls->y0[w] = walls->y1[w] = at.y;
        walls->radius[w] = dem->box.corner_radius;
        walls->fx[w] = walls->fy[w] = 0;
        if (previous) {
            struct vec moved = vec_sub(at, dem_corner_at(&previous->box, k));
            walls->dx[w] = moved.x, walls->dy[w] = moved.y, walls->dangle[w] = 0;
        }
    }
}

static int write_walls(const struct dem *dem, const struct servo *servo, const struct snapshot *previous,
                       struct walls *walls)
{
    static const char *const columns[] = {"name", "x0", "y0", "x1", "y1", "radius", "fx", "fy", "flags", NULL};
    static const char *const motions[] = {"dx", "dy", "dangle"};
    if (!dem->box.given)
        return 0;
    int corners = dem->box.corner_radius > 0;
    if (table_alloc(&WALLS, walls, corners ? SIDES + BOX_CORNERS : SIDES, columns))
        return -1;
    for (int c = 0; previous && c < 3; c++)
        if (table_add(&WALLS, walls, motions[c]))
            return -1;
    for (int s = 0; s < SIDES; s++) {
        struct vec from, to, load = side_load(dem, servo, s);
        side_ends(&dem->box, s, &from, &to);
        strcpy(walls->name[s], SIDE_NAMES[s]);
        walls->x0[s] = from.x, walls->y0[s] = from.y;
        walls->x1[s] = to.x, walls->y1[s] = to.y;
        walls->radius[s] = 0;
        walls->fx[s] = load.x, walls->fy[s] = load.y;
        if (previous) {
            struct vec old_from, old_to, along = vec_sub(to, from);
            side_ends(&previous->box, s, &old_from, &old_to);
            struct vec old_along = vec_sub(old_to, old_from);
            walls->dx[s] = 0.5 * (from.x + to.x - old_from.x - old_to.x);
            walls->dy[s] = 0.5 * (from.y + to.y - old_from.y - old_to.y);
            walls->dangle[s] = atan2(vec_cross(old_along, along), vec_dot(old_along, along));
        }
    }
    if (corners)
        write_corners(dem, previous, walls);
    return 0;
}

/* Motion of a side, as material, at a height; a wall does not stretch: it slides past its corners. */
static struct vec side_motion(const struct dem_box *now, const struct dem_box *then, int side, double height)
{
    double wide = now->size[BOX_WIDTH] - then->size[BOX_WIDTH], lean = now->size[BOX_SHEAR] - then->size[BOX_SHEAR];
    switch (side) {
    case SIDE_RIGHT:
        return vec(wide + lean * height, 0);
    case SIDE_LEFT:
        return vec(lean * height, 0);
    case SIDE_TOP:
        return vec(now->size[BOX_SHEAR] * now->size[BOX_HEIGHT] - then->size[BOX_SHEAR] * then->size[BOX_HEIGHT],
                   now->size[BOX_HEIGHT] - then->size[BOX_HEIGHT]);
    default:
        return vec(0, 0);
    }
}

/* Relative motion of j since the old state, projected on the mean of old and new normal (theory.md section 1). */
static void pair_motion(const struct dem *dem, const struct dem_pair *pair, const struct snapshot *then,
                        const struct dem_pair *old, double *un, double *ut)
{
    const struct dem_grain *g = &dem->grains[pair->i], *g0 = &then->grains[pair->i];
    double half = 0.25 * (pair->overlap + old->overlap);
    double turning = (g->radius - half) * (g->angle - g0->angle);
    struct vec motion, normal = vec_unit(vec(pair->nx + old->nx, pair->ny + old->ny));
    if ((size_t)pair->j < dem->count) {
        const struct dem_grain *h = &dem->grains[pair->j], *h0 = &then->grains[pair->j];
        motion = vec(h->x - h0->x, h->y - h0->y);
        turning += (h->radius - half) * (h->angle - h0->angle);
    } else if ((size_t)pair->j >= dem->count + SIDES) {
        int corner = pair->j - (int)dem->count - SIDES;
        motion = vec_sub(dem_corner_at(&dem->box, corner), dem_corner_at(&then->box, corner));
    } else {
        double height = 0.5 * (g->y + g0->y) + (g->radius - half) * normal.y;
        motion = side_motion(&dem->box, &then->box, pair->j - (int)dem->count, height);
    }
    motion = vec_sub(motion, vec(g->x - g0->x, g->y - g0->y));
    *un = vec_dot(motion, normal);
    *ut = vec_dot(motion, vec_turn(normal)) - turning;
}

/* The row of the old list that is this pair, or NULL; *from moves on: both lists are sorted alike. */
static const struct dem_pair *old_pair(const struct dem *dem, const struct dem_pair *pair, const struct snapshot *then,
                                       size_t *from)
{
    int wall = (size_t)pair->j >= dem->count;
    for (; *from < then->pair_count; ++*from) {
        const struct dem_pair *old = &then->pairs[*from];
        int old_wall = (size_t)old->j >= dem->count;
        int order = old_wall != wall ? old_wall - wall : old->i != pair->i ? old->i - pair->i : old->j - pair->j;
        if (order == 0)
            return old;
        if (order > 0)
            return NULL;
    }
    return NULL;
}

/* One pass over the list: un, ut of each touching pair since the old state. A pair that did not touch then has no
 * motion: its row stays as it is (NaN where it was just made), and is flagged new where flags are given. */
static void write_motion(const struct dem *dem, const struct snapshot *then, double *un, double *ut, uint32_t *flags)
{
    size_t row = 0, from = 0;
    for (size_t p = 0; p < dem->pair_count; p++) {
        const struct dem_pair *pair = &dem->pairs[p];
        if (!pair->touching)
            continue;
        const struct dem_pair *old = old_pair(dem, pair, then, &from);
        if (old)
            pair_motion(dem, pair, then, old, &un[row], &ut[row]);
        else if (flags)
            flags[row] |= CONTACT_NEW;
        row++;
    }
}

static int write_contacts(const struct dem *dem, struct packing *packing)
{
    static const char *const columns[] = {"i", "j", "nx", "ny", "x", "y", "overlap", "un", "ut", "flags", NULL};
    struct contacts *contacts = &packing->contacts;
    size_t touching = 0, row = 0;
    for (size_t p = 0; p < dem->pair_count; p++)
        touching += dem->pairs[p].touching;
    if (table_alloc(&CONTACTS, contacts, touching, columns))
        return -1;
    for (size_t p = 0; p < dem->pair_count; p++) {
        const struct dem_pair *pair = &dem->pairs[p];
        if (!pair->touching)
            continue;
        const struct dem_grain *g = &dem->grains[pair->i];
        double arm = g->radius - 0.5 * pair->overlap;
        contacts->i[row] = pair->i, contacts->j[row] = pair->j;
        contacts->nx[row] = pair->nx, contacts->ny[row] = pair->ny;
        contacts->x[row] = g->x + arm * pair->nx, contacts->y[row] = g->y + arm * pair->ny;
        contacts->overlap[row] = pair->overlap;
        contacts->flags[row] = (size_t)pair->j >= dem->count ? CONTACT_WALL : 0;
        row++;
    }
    return 0;
}

/* Grains that fewer than two carrying contacts hold are rattlers, and so on without their contacts. */
static int flag_rattlers(struct packing *packing, const double *fn, double mean_fn)
{
    const struct contacts *contacts = &packing->contacts;
    struct grains *grains = &packing->grains;
    int *degree = calloc(grains->count + 1, sizeof *degree);
    if (!degree)
        return error_memory("rattlers");
    for (int peeled = 1; peeled;) {
        peeled = 0;
        memset(degree, 0, grains->count * sizeof *degree);
        for (size_t c = 0; c < contacts->count; c++) {
            size_t i = (size_t)contacts->i[c], j = (size_t)contacts->j[c];
            int gone = grains->flags[i] & GRAIN_RATTLER || (j < grains->count && grains->flags[j] & GRAIN_RATTLER);
            if (gone || fn[c] <= CARRIES * mean_fn)
                continue;
            degree[i]++;
            if (j < grains->count)
                degree[j]++;
        }
        for (size_t k = 0; k < grains->count; k++)
            if (degree[k] < 2 && !(grains->flags[k] & (GRAIN_RATTLER | GRAIN_FIXED))) {
                grains->flags[k] |= GRAIN_RATTLER;
                peeled = 1;
            }
    }
    free(degree);
    return 0;
}

/* Unbalanced force and moment of each grain, from the geometry of the tables alone. */
static int write_residuals(const struct packing *packing, struct forces *forces)
{
    const struct contacts *contacts = &packing->contacts;
    const struct grains *grains = &packing->grains;
    struct residuals *residual = &forces->residual;
    if (table_alloc(&RESIDUALS, residual, grains->count, NULL))
        return -1;
    for (size_t k = 0; k < grains->count; k++) {
        residual->residual_x[k] = grains->load_x ? grains->load_x[k] : 0;
        residual->residual_y[k] = grains->load_y ? grains->load_y[k] : 0;
        residual->residual_m[k] = grains->load_m ? grains->load_m[k] : 0;
    }
    for (size_t c = 0; c < contacts->count; c++) {
        struct vec n = vec(contacts->nx[c], contacts->ny[c]), at = vec(contacts->x[c], contacts->y[c]);
        struct vec f = vec_add(vec_scale(forces->contact.fn[c], n), vec_scale(forces->contact.ft[c], vec_turn(n)));
        size_t body[2] = {(size_t)contacts->i[c], (size_t)contacts->j[c]};
        for (int end = 0; end < 2; end++) {
            size_t k = body[end];
            if (k >= grains->count)
                continue;
            struct vec on = vec_scale(end ? 1 : -1, f);
            residual->residual_x[k] += on.x;
            residual->residual_y[k] += on.y;
            residual->residual_m[k] += vec_cross(vec_sub(at, vec(grains->x[k], grains->y[k])), on);
        }
    }
    return 0;
}

static int write_forces(const struct dem *dem, struct packing *packing)
{
    static const char *const columns[] = {"fn", "ft", "status", NULL};
    struct forces *forces = packing->forces = calloc(1, sizeof *forces);
    if (!forces)
        return error_memory("forces");
    packing->force_count = 1;
    strcpy(forces->method, "dem");
    strcpy(forces->start, "history");
    if (table_alloc(&CONTACT_FORCES, &forces->contact, packing->contacts.count, columns))
        return -1;
    size_t row = 0;
    double mean = 0;
    for (size_t p = 0; p < dem->pair_count; p++) {
        const struct dem_pair *pair = &dem->pairs[p];
        if (!pair->touching)
            continue;
        forces->contact.fn[row] = pair->fn;
        forces->contact.ft[row] = pair->spring.ft;
        forces->contact.status[row] = pair->fn <= 0 ? STATUS_OPEN : pair->slips ? STATUS_SLIP : STATUS_STICK;
        mean += pair->fn;
        row++;
    }
    mean = fmax(row ? mean / (double)row : 0, dem->dust);
    forces->kn = dem->law.kn;
    forces->kt = dem->law.kn * dem->law.kt_over_kn; /* NaN where the stiffness depends on the force */
    forces->mu = dem->mu;
    forces->misfit[0] = forces->misfit[1] = NAN;
    if (flag_rattlers(packing, forces->contact.fn, mean) || write_residuals(packing, forces))
        return -1;
    for (size_t k = 0; k < packing->grains.count; k++) {
        if (packing->grains.flags[k] & GRAIN_FIXED)
            continue;
        double x = fabs(forces->residual.residual_x[k]), y = fabs(forces->residual.residual_y[k]);
        double m = fabs(forces->residual.residual_m[k]) / packing->grains.radius[k];
        forces->imbalance = fmax(forces->imbalance, fmax(fmax(x, y), m));
    }
    forces->imbalance = mean > 0 ? forces->imbalance / mean : 0;
    double area;
    if (packing_area(packing, &area))
        return -1;
    stress_weber(packing, forces->contact.fn, forces->contact.ft, area, forces->stress);
    return 0;
}

int snapshot_packing(const struct dem *dem, const struct servo *servo, const struct snapshot *reference,
                     const struct snapshot *previous, double length_m, struct packing *packing)
{
    memset(packing, 0, sizeof *packing);
    packing->length_m = length_m;
    if (write_grains(dem, &packing->grains) || write_walls(dem, servo, previous, &packing->walls) ||
        write_contacts(dem, packing))
        return -1;
    struct contacts *contacts = &packing->contacts;
    if (reference) {
        write_motion(dem, reference, contacts->un, contacts->ut, NULL);
    } else {
        memset(contacts->un, 0, contacts->count * sizeof *contacts->un);
        memset(contacts->ut, 0, contacts->count * sizeof *contacts->ut);
    }
    if (previous) {
        if (table_add(&CONTACTS, contacts, "dun") || table_add(&CONTACTS, contacts, "dut"))
            return -1;
        write_motion(dem, previous, contacts->dun, contacts->dut, contacts->flags);
    }
    return write_forces(dem, packing);
}
