/* Forces at the contacts, gathered on grains and walls. Each grain's forces are summed in the order of the pairs,
 * whether one thread scatters them or several gather them: the sums have the same bits. */
#include "simulation/dem/dem.h"

/* What an evaluation of the forces stands for. */
struct instant {
    double dt;       /* s: the friction springs move by the relative velocity times this */
    double dashpots; /* 1: they act; 0: the static forces */
};

static int is_wall(const struct dem *dem, const struct dem_pair *pair)
{
    return (size_t)pair->j >= dem->count;
}

/* The corner disc of a pair, or NULL. */
static const struct dem_corner *pair_corner(const struct dem *dem, const struct dem_pair *pair)
{
    size_t sides_end = dem->count + SIDES;
    return (size_t)pair->j < sides_end ? NULL : &dem->box.corner[(size_t)pair->j - sides_end];
}

/* Where a pair stands. */
struct geometry {
    double nx, ny, overlap;
};

/* A grain and a disc around (x, y). */
static inline struct geometry disc_geometry(const struct dem_grain *g, double x, double y, double radius)
{
    double dx = x - g->x, dy = y - g->y, reach = g->radius + radius, square = dx * dx + dy * dy;
    if (square >= reach * reach || square == 0)
        return (struct geometry){0};
    double distance = sqrt(square);
    return (struct geometry){dx / distance, dy / distance, reach - distance};
}

static struct geometry pair_geometry(const struct dem *dem, const struct dem_pair *pair)
{
    const struct dem_grain *g = &dem->grains[pair->i];
    if (!is_wall(dem, pair)) {
        const struct dem_grain *h = &dem->grains[pair->j];
        return disc_geometry(g, h->x, h->y, h->radius);
    }
    const struct dem_corner *corner = pair_corner(dem, pair);
    if (corner)
        return disc_geometry(g, corner->at.x, corner->at.y, dem->box.corner_radius);
    const struct dem_side *side = &dem->box.side[(size_t)pair->j - dem->count];
    return (struct geometry){-side->inward.x, -side->inward.y,
                             g->radius - vec_dot(vec_sub(vec(g->x, g->y), side->point), side->inward)};
}

/* Relative velocity of j at the contact (theory.md section 1), n and half the overlap in the middle of the step. */
static void pair_velocity(const struct dem *dem, const struct dem_pair *pair, struct vec n, double half, double *un,
                          double *ut)
{
    const struct dem_grain *g = &dem->grains[pair->i];
    double arm = g->radius - half, turning = arm * g->spin;
    struct vec velocity;
    if (!is_wall(dem, pair)) {
        const struct dem_grain *h = &dem->grains[pair->j];
        velocity = vec(h->vx, h->vy);
        turning += (h->radius - half) * h->spin;
    } else if (pair_corner(dem, pair)) {
        velocity = pair_corner(dem, pair)->velocity;
    } else {
        const struct dem_side *side = &dem->box.side[(size_t)pair->j - dem->count];
        double height = g->y + arm * n.y - side->point.y;
        velocity = vec(side->velocity.x + side->tilt_rate * height, side->velocity.y);
    }
    double vx = velocity.x - g->vx, vy = velocity.y - g->vy;
    *un = vx * n.x + vy * n.y;
    *ut = -vx * n.y + vy * n.x - turning;
}

/* Spring, dashpot, friction after the step to the geometry `to`; what friction and dashpot take goes to *lost.
 *
 * Normal: fn = max(0, F(x) - c un), c = 2 z (k m)^1/2 with the reduced mass m and the share z of critical damping; a
 * contact never pulls. Tangential: a spring of stiffness kt moves by ut dt and is cut at mu fn. Sliding gives back what
 * the trial force had too much: the spring's end moves by (trial - cut) / kt against the mean of the force before and
 * after, which is the work of friction (trapezoidal rule). */
static void pair_force(const struct dem *dem, struct dem_pair *pair, size_t p, struct geometry to, double mu,
                       struct instant now, double *lost)
{
    double un, ut, before = 0, ft = pair->spring.ft, half = 0.5 * to.overlap;
    struct vec n = vec(to.nx, to.ny);
    if (pair->touching) {
        before = pair->spring.stiffness;
        n = vec(0.5 * (to.nx + pair->nx), 0.5 * (to.ny + pair->ny)); /* its length is 1 to second order */
        half = 0.25 * (to.overlap + pair->overlap);
    }
    pair_velocity(dem, pair, n, half, &un, &ut);
    pair->touching = 1;
    pair->nx = to.nx;
    pair->ny = to.ny;
    pair->overlap = to.overlap;
    contact_spring_press(&dem->law, dem_pair_law(dem, p), pair->overlap, &pair->spring);
    double dashpot = now.dashpots > 0 ? pair->damping * sqrt(pair->spring.stiffness) * un : 0;
    pair->fn = pair->spring.fn > dashpot ? pair->spring.fn - dashpot : 0;
    contact_spring_slide(&dem->law, before, ut * now.dt, &pair->spring);
    double limit = mu * pair->fn, trial = pair->spring.ft;
    pair->slips = fabs(trial) >= limit;
    if (pair->slips) {
        double kt = dem->law.kt_over_kn * pair->spring.stiffness;
        pair->spring.ft = copysign(limit, trial);
        if (kt > 0)
            *lost += 0.5 * (ft + pair->spring.ft) * (trial - pair->spring.ft) / kt;
    }
    *lost += (pair->spring.fn - pair->fn) * un * now.dt;
}

/* Brings pair p up to date; returns 1 when it touches. */
static int pair_update(struct dem *dem, size_t p, struct instant now, double *lost)
{
    struct dem_pair *pair = &dem->pairs[p];
    struct geometry to = pair_geometry(dem, pair);
    if (to.overlap > 0) {
        pair_force(dem, pair, p, to, p < dem->first[dem->count] ? dem->mu : dem->mu_wall, now, lost);
        return 1;
    }
    if (pair->touching) {
        pair->touching = pair->slips = 0;
        pair->fn = pair->overlap = 0;
        pair->spring = (struct contact_spring){0};
    }
    return 0;
}

/* Force on j: fn n + ft t, t = n turned by +90 degrees. */
static struct vec pair_vector(const struct dem_pair *pair)
{
    return vec(pair->fn * pair->nx - pair->spring.ft * pair->ny, pair->fn * pair->ny + pair->spring.ft * pair->nx);
}

/* The force on one of the two (sign -1: i, +1: j). */
static void act(struct dem_grain *g, const struct dem_pair *pair, struct vec force, double sign)
{
    g->fx += sign * force.x;
    g->fy += sign * force.y;
    g->moment -= (g->radius - 0.5 * pair->overlap) * pair->spring.ft;
}

/* Work of the force per unit of each freedom: the corner is at (right W + top g H, top H). */
static void act_on_corner(struct dem_box *box, int k, struct vec force)
{
    box->corner[k].force = vec_add(box->corner[k].force, force);
    if (k == BOX_BOTTOM_RIGHT || k == BOX_TOP_RIGHT)
        box->push[BOX_WIDTH] += force.x;
    if (k == BOX_TOP_RIGHT || k == BOX_TOP_LEFT) {
        box->push[BOX_SHEAR] += force.x * box->size[BOX_HEIGHT];
        box->push[BOX_HEIGHT] += force.y + force.x * box->size[BOX_SHEAR];
    }
}

static void act_on_wall(struct dem *dem, const struct dem_pair *pair, struct vec force)
{
    const struct dem_grain *g = &dem->grains[pair->i];
    struct dem_box *box = &dem->box;
    int s = pair->j - (int)dem->count;
    if (s >= SIDES) {
        act_on_corner(box, s - SIDES, force);
        return;
    }
    double height = g->y + (g->radius - 0.5 * pair->overlap) * pair->ny;
    box->side[s].force = vec_add(box->side[s].force, force);
    if (s == SIDE_RIGHT || s == SIDE_LEFT)
        box->push[BOX_SHEAR] += force.x * height;
    if (s == SIDE_RIGHT)
        box->push[BOX_WIDTH] += force.x;
    if (s == SIDE_TOP) {
        box->push[BOX_SHEAR] += force.x * box->size[BOX_HEIGHT];
        box->push[BOX_HEIGHT] += force.y + force.x * box->size[BOX_SHEAR];
    }
}

static void grain_loads(const struct dem *dem, struct dem_grain *g)
{
    g->fx = g->load_x + g->mass * dem->gravity.x;
    g->fy = g->load_y + g->mass * dem->gravity.y;
    g->moment = g->load_m;
}

static void scatter(struct dem *dem, struct instant now)
{
    size_t walls = dem->first[dem->count];
    for (size_t k = 0; k < dem->count; k++)
        grain_loads(dem, &dem->grains[k]);
    for (size_t p = 0; p < dem->pair_count; p++) {
        const struct dem_pair *pair = &dem->pairs[p];
        if (!pair_update(dem, p, now, &dem->grains[pair->i].lost))
            continue;
        struct vec force = pair_vector(pair);
        act(&dem->grains[pair->i], pair, force, -1);
        if (p < walls)
            act(&dem->grains[pair->j], pair, force, 1);
        else
            act_on_wall(dem, pair, force);
    }
}

/* Pairs in which k comes second are older in the list than those in which it comes first: the order of scatter(). */
static void gather_grain(struct dem *dem, size_t k)
{
    struct dem_grain *g = &dem->grains[k];
    grain_loads(dem, g);
    for (size_t b = dem->back_first[k]; b < dem->back_first[k + 1]; b++) {
        const struct dem_pair *pair = &dem->pairs[dem->back[b]];
        if (pair->touching)
            act(g, pair, pair_vector(pair), 1);
    }
    for (size_t p = dem->first[k]; p < dem->first[k + 1]; p++)
        if (dem->pairs[p].touching)
            act(g, &dem->pairs[p], pair_vector(&dem->pairs[p]), -1);
    for (size_t p = dem->wall_first[k]; p < dem->wall_first[k + 1]; p++)
        if (dem->pairs[p].touching)
            act(g, &dem->pairs[p], pair_vector(&dem->pairs[p]), -1);
}

/* Two sweeps: each pair is brought up to date by the thread of its first grain, then each grain adds up its own. What
 * walls feel is added by one thread, in the order of the list. */
static void gather(struct dem *dem, struct instant now)
{
#pragma omp parallel
    {
#pragma omp for schedule(static)
        for (size_t k = 0; k < dem->count; k++) {
            for (size_t p = dem->first[k]; p < dem->first[k + 1]; p++)
                pair_update(dem, p, now, &dem->grains[k].lost);
            for (size_t p = dem->wall_first[k]; p < dem->wall_first[k + 1]; p++)
                pair_update(dem, p, now, &dem->grains[k].lost);
        }
#pragma omp for schedule(static)
        for (size_t k = 0; k < dem->count; k++)
            gather_grain(dem, k);
    }
    for (size_t p = dem->first[dem->count]; p < dem->pair_count; p++)
        if (dem->pairs[p].touching)
            act_on_wall(dem, &dem->pairs[p], pair_vector(&dem->pairs[p]));
}

/* N/m: what the time step must resolve. */
static double stiffest_contact(const struct dem *dem)
{
    if (contact_law_row(&dem->law)->linear)
        return dem->law.kn;
    double stiffest = 0;
    for (size_t p = 0; p < dem->pair_count; p++)
        if (dem->pairs[p].touching)
            stiffest = fmax(stiffest, dem->pairs[p].spring.stiffness);
    return stiffest;
}

/* Half of the trapezoidal rule: before and after the new forces. */
static void walls_work(struct dem_box *box)
{
    for (int f = 0; f < BOX_FREEDOMS; f++)
        box->work -= 0.5 * box->push[f] * (box->size[f] - box->worked_size[f]);
}

static int all_forces(struct dem *dem, struct instant now)
{
    dem_place_walls(dem);
    if (dem_find_pairs(dem) < 0)
        return -1;
    walls_work(&dem->box);
    for (int s = 0; s < SIDES; s++)
        dem->box.side[s].force = vec(0, 0);
    for (int k = 0; k < BOX_CORNERS; k++)
        dem->box.corner[k].force = vec(0, 0);
    for (int f = 0; f < BOX_FREEDOMS; f++)
        dem->box.push[f] = 0;
    if (dem->count < dem->parallel_from)
        scatter(dem, now);
    else
        gather(dem, now);
    walls_work(&dem->box);
    for (int f = 0; f < BOX_FREEDOMS; f++)
        dem->box.worked_size[f] = dem->box.size[f];
    dem->stiffest = stiffest_contact(dem);
    return 0;
}

int dem_forces(struct dem *dem, double dt)
{
    return all_forces(dem, (struct instant){dt, 1});
}

int dem_forces_static(struct dem *dem, double dt)
{
    return all_forces(dem, (struct instant){dt, 0});
}
