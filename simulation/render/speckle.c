/* Paint on a body: dots scattered over the body's own plane by a hashed lattice, so that the pattern is a function of
 * position, key and paint alone. A body that moves takes its dots along exactly: their middles are turned and shifted,
 * and each is drawn anew from the distance to it.
 *
 * Dots are a Boolean model (Stoyan, Kendall and Mecke, Stochastic Geometry and its Applications): with n dots per area
 * of mean area A a point stays bare with probability exp(-n A), so that a wanted coverage c needs n = -log(1 - c) / A.
 * A node of the lattice has a Poisson number of dots with mean DOTS_PER_NODE, spread over its cell. */
#include <math.h>

#include "pipeline/numbers/random.h"
#include "simulation/render/tile.h"

enum { DOTS_PER_NODE = 3, DOTS_MAX = 16 };

/* Number of dots on a lattice node: Poisson by inversion, cut at DOTS_MAX (probability 1e-8). */
static int node_count(uint64_t key)
{
    double u = random_uniform(key, 0), term = exp(-DOTS_PER_NODE), sum = term;
    int count = 0;
    while (u > sum && count < DOTS_MAX) {
        term *= (double)DOTS_PER_NODE / ++count;
        sum += term;
    }
    return count;
}

SIMD_CLONES static void stamp(const struct tile *tile, double x, double y, double radius, float level, struct window in)
{
    struct window dot = tile_window(tile, x, y, radius);
    int x0 = dot.x0 > in.x0 ? dot.x0 : in.x0, x1 = dot.x1 < in.x1 ? dot.x1 : in.x1;
    int y0 = dot.y0 > in.y0 ? dot.y0 : in.y0, y1 = dot.y1 < in.y1 ? dot.y1 : in.y1;
    float cx = (float)(x - tile->origin_x), cy = (float)(y - tile->origin_y), per_cell = (float)(1 / tile->cell);
    float edge = (float)coverage_radius(radius, tile->cell);
    for (int row = y0; row < y1; row++) {
        size_t start = (size_t)row * (size_t)tile->width;
        const float *restrict px = tile->x + start, *restrict py = tile->y + start;
        float *restrict layer = tile->layer + start;
        for (int i = x0; i < x1; i++) {
            float dx = px[i] - cx, dy = py[i] - cy;
            layer[i] += coverage((edge - sqrtf(dx * dx + dy * dy)) * per_cell) * (level - layer[i]);
        }
    }
}

/* Bounds of the window in the body's own frame: from its four corners. */
static void body_bounds(const struct tile *tile, struct window w, struct pose pose, double low[2], double high[2])
{
    for (int corner = 0; corner < 4; corner++) {
        int i = corner & 1 ? w.x1 - 1 : w.x0, j = corner & 2 ? w.y1 - 1 : w.y0;
        size_t at = (size_t)j * (size_t)tile->width + (size_t)i;
        double dx = tile->origin_x + (double)tile->x[at] - pose.x, dy = tile->origin_y + (double)tile->y[at] - pose.y;
        double body[2] = {pose.cosine * dx - pose.sine * dy, pose.sine * dx + pose.cosine * dy};
        for (int a = 0; a < 2; a++) {
            low[a] = corner && low[a] < body[a] ? low[a] : body[a];
            high[a] = corner && high[a] > body[a] ? high[a] : body[a];
        }
    }
}

static void throw_dots(const struct tile *tile, struct window window, const struct paint *paint, struct pose pose,
                       uint64_t key)
{
    double a = paint->radius_min, b = paint->radius_max, mean_square = (a * a + a * b + b * b) / 3;
    if (paint->coverage <= 0)
        return;
    double per_area = -log(1 - paint->coverage) / (M_PI * mean_square), pitch = sqrt(DOTS_PER_NODE / per_area);
    double low[2], high[2], reach = b + (tile->bend + 3) * tile->cell;
    body_bounds(tile, window, pose, low, high);
    long first_u = (long)floor((low[0] - reach) / pitch), last_u = (long)floor((high[0] + reach) / pitch);
    long first_v = (long)floor((low[1] - reach) / pitch), last_v = (long)floor((high[1] + reach) / pitch);
    for (long iv = first_v; iv <= last_v; iv++)
        for (long iu = first_u; iu <= last_u; iu++) {
            uint64_t node = random_bits(random_bits(key, (uint64_t)iu), (uint64_t)iv);
            int count = node_count(node);
            for (int d = 0; d < count; d++) {
                uint64_t dot = random_bits(node, (uint64_t)d + 1);
                double u = ((double)iu + random_uniform(dot, 0)) * pitch,
                       v = ((double)iv + random_uniform(dot, 1)) * pitch;
                double radius = a + (b - a) * random_uniform(dot, 2);
                double level = paint->level_min + (paint->level_max - paint->level_min) * random_uniform(dot, 3);
                stamp(tile, pose.x + pose.cosine * u + pose.sine * v, pose.y - pose.sine * u + pose.cosine * v, radius,
                      (float)level, window);
            }
        }
}

void speckle_paint(const struct tile *tile, struct window window, const struct surface *surface, struct pose pose,
                   uint64_t key)
{
    if (window.x0 >= window.x1 || window.y0 >= window.y1)
        return;
    for (int p = 0; p < surface->paint_count; p++)
        throw_dots(tile, window, &surface->paint[p], pose, random_bits(key, (uint64_t)p));
}

void speckle_surface(const struct tile *tile, struct window window, const struct surface *surface, double level,
                     struct pose pose, uint64_t key)
{
    for (int row = window.y0; row < window.y1; row++)
        for (int i = window.x0; i < window.x1; i++)
            tile->layer[(size_t)row * (size_t)tile->width + (size_t)i] = (float)level;
    speckle_paint(tile, window, surface, pose, key);
}
