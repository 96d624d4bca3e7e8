#include "pipeline/packing/verdict.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "pipeline/packing/limits.h"
#include "pipeline/packing/stress.h"

/* ---- loads of walls ---- */

/* Mean size of the loads of the walls whose normal lies along this axis, N. */
static double mean_load(const struct walls *walls, int axis)
{
    double sum = 0, count = 0;
    for (size_t w = 0; w < walls->count; w++) {
        if (wall_is_disc(walls, w))
            continue;
        struct vec n = wall_inward(walls, w);
        double load = wall_load(walls, w);
        if ((fabs(n.x) > fabs(n.y)) == (axis == 0) && isfinite(load))
            sum += fabs(load), count++;
    }
    return count > 0 ? sum / count : NAN;
}

/* What the contacts of a wall, and of the corner discs that move with it, bear along its inward normal, N: the
 * component outwards of the forces fn n + ft t that the grains put on it. *touched: does any of them carry? */
static double wall_bears(const struct packing *packing, const struct forces *forces, size_t w, int *touched)
{
    char name[NAME_LENGTH + 1] = "", other[NAME_LENGTH + 1] = "";
    struct vec inward = wall_inward(&packing->walls, w);
    double sum = 0;
    size_t wall;
    memcpy(name, packing->walls.name[w], NAME_LENGTH);
    *touched = 0;
    for (size_t c = 0; c < forces->contact.count; c++) {
        if (!packing_is_wall(packing, c, &wall) || !(forces->contact.fn[c] > 0))
            continue;
        memcpy(other, packing->walls.name[wall], NAME_LENGTH);
        if (wall != w && !(wall_is_disc(&packing->walls, wall) && strstr(other, name)))
            continue;
        struct vec n = vec(packing->contacts.nx[c], packing->contacts.ny[c]);
        sum -= vec_dot(inward,
                       vec_add(vec_scale(forces->contact.fn[c], n), vec_scale(forces->contact.ft[c], vec_turn(n))));
        *touched = 1;
    }
    return sum;
}

/* ---- the reasons ---- */

struct finding {
    struct forces *forces;
    char list[2][sizeof((struct forces *)0)->reasons]; /* doubtful, void */
};

static void say(struct finding *finding, enum verdict verdict, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

static void say(struct finding *finding, enum verdict verdict, const char *format, ...)
{
    char *list = finding->list[verdict == VERDICT_VOID];
    size_t used = strlen(list), room = sizeof finding->list[0];
    va_list arguments;
    if (verdict > finding->forces->verdict)
        finding->forces->verdict = verdict;
    if (used + 20 > room)
        return;
    if (used)
        used += (size_t)snprintf(list + used, room - used, "; ");
    va_start(arguments, format);
    vsnprintf(list + used, room - used, format, arguments);
    va_end(arguments);
}

static int carries(const struct forces *forces, size_t c)
{
    return forces->contact.fn[c] > 0;
}

/* Every wall whose load is known bears it, also those whose reaction the methods leave free: where all four are loaded,
 * left and bottom show what the loads leave over. */
static void look_at_walls(struct finding *finding, const struct packing *packing)
{
    const struct walls *walls = &packing->walls;
    int balances = finding->forces->iterations > 0;
    for (size_t w = 0; w < walls->count; w++) {
        int touched,
            axis = !wall_is_disc(walls, w) && fabs(wall_inward(walls, w).x) > fabs(wall_inward(walls, w).y) ? 0 : 1;
        double load = wall_load(walls, w), mean = mean_load(walls, axis);
        if (!isfinite(load) || !(fabs(load) > 1e-3 * mean))
            continue;
        double bears = wall_bears(packing, finding->forces, w, &touched), share = fabs(bears - load) / mean;
        if (!touched)
            say(finding, VERDICT_VOID, "the %.*s wall is loaded, but no contact there carries anything", NAME_LENGTH,
                walls->name[w]);
        else if (share > LIMIT_LOADS)
            say(finding, balances && share > VOID_LOADS ? VERDICT_VOID : VERDICT_DOUBTFUL,
                "the contacts of the %.*s wall bear %.3g N, but its load is %.3g N: look for a wrong or missing load",
                NAME_LENGTH, walls->name[w], bears, load);
        if (share > LIMIT_LOADS)
            finding->forces->converged = 0;
    }
}

/* What the grains have left, all together: loads that do not balance may be spread over many grains, a little on each.
 */
static void look_at_sum(struct finding *finding, const struct packing *packing)
{
    const struct residuals *residual = &finding->forces->residual;
    const double *const columns[2] = {residual->residual_x, residual->residual_y};
    for (int axis = 0; axis < 2; axis++) {
        double sum = 0, load = mean_load(&packing->walls, axis);
        for (size_t k = 0; columns[axis] && k < residual->count; k++)
            sum += isfinite(columns[axis][k]) ? columns[axis][k] : 0;
        if (!(fabs(sum) > LIMIT_LOADS * load))
            continue;
        int is_void = finding->forces->iterations > 0 && fabs(sum) > VOID_LOADS * load;
        say(finding, is_void ? VERDICT_VOID : VERDICT_DOUBTFUL,
            "the grains are left with %.3g N along %c in all, where the walls are loaded with %.3g N: look for a wrong "
            "or "
            "missing load",
            sum, axis ? 'y' : 'x', load);
        finding->forces->converged = 0;
    }
}

/* The parts of the mean stress that are known from the loads: applied, and Weber's of the same axes. */
static void mean_stresses(const double applied[2][2], const double weber[2][2], double mean[2])
{
    int known = 0;
    mean[0] = mean[1] = 0;
    for (int axis = 0; axis < 2; axis++)
        if (isfinite(applied[axis][axis]))
            mean[0] += applied[axis][axis], mean[1] += weber[axis][axis], known++;
    for (int k = 0; k < 2; k++)
        mean[k] = known ? mean[k] / known : NAN;
}

/* `mean`: applied, Weber's. Loads of the wrong sign are the cause of all else: they come before it. */
static void look_at_sign(struct finding *finding, const double mean[2], const char *units)
{
    if (mean[0] < 0)
        say(finding, VERDICT_VOID, "the loads pull outwards (mean stress %.3g %s): is their sign turned?", mean[0],
            units);
}

static void look_at_stress(struct finding *finding, const double mean[2], const char *units)
{
    double off = fabs(mean[1] / mean[0] - 1);
    if (!(mean[0] > 0) || !(off > LIMIT_STRESS))
        return;
    int is_void = off > VOID_STRESS && finding->forces->iterations > 0;
    say(finding, is_void ? VERDICT_VOID : VERDICT_DOUBTFUL,
        "the contact forces make a stress of %.3g %s where %.3g is applied: contacts were missed, or loads or scale "
        "are "
        "wrong",
        mean[1], units, mean[0]);
}

static void look_at_balance(struct finding *finding, const struct packing *packing)
{
    const struct forces *forces = finding->forces;
    size_t carrying = 0;
    for (size_t c = 0; c < forces->contact.count; c++)
        carrying += (size_t)carries(forces, c);
    if (!carrying && packing->grains.count)
        say(finding, VERDICT_VOID, "no contact carries anything (%zu contacts among %zu grains)", forces->contact.count,
            packing->grains.count);
    if (forces->infeasible)
        say(finding, VERDICT_VOID,
            "no forces at all on these contacts balance the loads: a contact was missed, or a load "
            "is wrong");
    if (forces->iterations > 0 && forces->imbalance_mean > VOID_UNBALANCED)
        say(finding, VERDICT_VOID, "grains are left with %.2g <fn> unbalanced in the mean", forces->imbalance_mean);
    if (carrying && !forces->converged && !(forces->imbalance <= forces->tolerance))
        say(finding, VERDICT_DOUBTFUL, "%s: up to %.2g <fn> is left unbalanced (tolerance %.2g)",
            forces->iterations > 0 ? "not converged" : "the method seeks no equilibrium", forces->imbalance,
            forces->tolerance);
}

static void look_at_overlaps(struct finding *finding, const struct packing *packing)
{
    double ratio = packing->contacts.overlap && isfinite(finding->forces->kn)
                       ? stress_overlaps_over_loads(packing, finding->forces->kn)
                       : NAN;
    if (ratio > LIMIT_OVERLAPS_OVER_LOADS || ratio < 1 / LIMIT_OVERLAPS_OVER_LOADS)
        say(finding, VERDICT_DOUBTFUL,
            "overlaps times k_n are %.2g times the loads: scale, k_n or loads are wrong, or "
            "overlaps are no more than their errors",
            ratio);
}

int verdict_find(const struct packing *packing, struct forces *forces)
{
    struct finding finding = {.forces = forces};
    const char *units = isnan(packing->length_m) ? "N/m" : "Pa";
    double area, applied[2][2], mean[2];
    if (packing_area(packing, &area))
        return -1;
    stress_applied(packing, area, applied);
    mean_stresses((const double(*)[2])applied, forces->stress, mean);
    forces->verdict = VERDICT_BALANCED;
    look_at_sign(&finding, mean, units);
    look_at_balance(&finding, packing);
    look_at_walls(&finding, packing);
    look_at_sum(&finding, packing);
    look_at_stress(&finding, mean, units);
    look_at_overlaps(&finding, packing);
    const char *gap = *finding.list[0] && *finding.list[1] ? "; " : "";
    snprintf(forces->reasons, sizeof forces->reasons, "%.480s%s%.480s", finding.list[1], gap, finding.list[0]);
    return 0;
}
