/* The rods: their faces, cut to their rims, and what is seen of their flanks behind them. Wood is drawn from what a
 * photo of it shows: annual rings, a bevel that darkens the rim, sometimes a pencil line. All of it is fixed to the rod
 * and turns with it. */
#include "simulation/render/layers.h"

#include "pipeline/numbers/random.h"

/* A rod's end as the picture has it: px, px, px, shape amplitudes in px, rad. */
struct face {
    double x, y, radius, shape_c, shape_s, angle;
};

/* Annual rings around a pith that lies off the rod's middle: each ring darkens towards its end. */
SIMD_CLONES static void paint_rings(const struct optics *optics, struct tile *tile, struct window w,
                                    const struct face *face, size_t grain)
{
    uint64_t key = body_key(optics, BODY_RING, grain);
    double turn = 2 * M_PI * random_uniform(key, 0), away = face->radius * (0.3 + 1.4 * random_uniform(key, 1));
    double angle = face->angle + turn;
    float x = (float)(face->x + away * cos(angle) - tile->origin_x),
          y = (float)(face->y - away * sin(angle) - tile->origin_y);
    float per_ring = (float)(1 / (optics->ring_spacing * (0.7 + 0.6 * random_uniform(key, 2))));
    float contrast = (float)optics->ring_contrast, cells_per_ring = (float)(1 / ((double)per_ring * tile->cell));
    for (int j = w.y0; j < w.y1; j++) {
        size_t start = (size_t)j * (size_t)tile->width;
        const float *restrict px = tile->x + start, *restrict py = tile->y + start;
        float *restrict layer = tile->layer + start;
        for (int i = w.x0; i < w.x1; i++) {
            float dx = px[i] - x, dy = py[i] - y, rings = sqrtf(dx * dx + dy * dy) * per_ring;
            float part = rings - (float)(int)rings, p = part > 0.5f ? part - 1 : part;
            float ended = (1 + p) * (1 + p), begun = p * p; /* darkening of this ring's end, of the next one's start */
            layer[i] *= 1 + contrast * (0.33f - ended - coverage(p * cells_per_ring) * (begun - ended));
        }
    }
}

/* A pencil line across a face: dark, straight, fixed to the rod. */
SIMD_CLONES static void paint_line(const struct optics *optics, struct tile *tile, struct window w,
                                   const struct face *face, size_t grain)
{
    uint64_t key = body_key(optics, BODY_LINE, grain);
    if (random_uniform(key, 0) >= optics->line_share)
        return;
    double angle = face->angle + 2 * M_PI * random_uniform(key, 1);
    float across = (float)(sin(angle) / tile->cell), along = (float)(cos(angle) / tile->cell); /* normal, y down */
    float from = (float)((2 * random_uniform(key, 2) - 1) * 0.7 * face->radius / tile->cell);
    float x = (float)(face->x - tile->origin_x), y = (float)(face->y - tile->origin_y);
    float half = (float)(0.5 * optics->line_width / tile->cell), level = (float)optics->line_level;
    for (int j = w.y0; j < w.y1; j++) {
        size_t start = (size_t)j * (size_t)tile->width;
        const float *restrict px = tile->x + start, *restrict py = tile->y + start;
        float *restrict layer = tile->layer + start;
        for (int i = w.x0; i < w.x1; i++) {
            float d = across * (px[i] - x) + along * (py[i] - y) - from;
            layer[i] += (coverage(d + half) - coverage(d - half)) * (level - layer[i]);
        }
    }
}

static float least(float a, float b)
{
    return a < b ? a : b;
}

/* Cut the layer to the face's rim r(phi) = radius + c cos 2(phi - angle) + s sin 2(phi - angle), darken the bevel, and
 * add what no earlier grain hides. Touching faces share a cell exactly: shares add up to at most 1. */
SIMD_CLONES static void lay_face(const struct optics *optics, struct tile *tile, struct window w,
                                 const struct face *face)
{
    double c2 = cos(2 * face->angle), s2 = sin(2 * face->angle);
    float a = (float)(face->shape_c * c2 - face->shape_s * s2), b = (float)(face->shape_c * s2 + face->shape_s * c2);
    float x = (float)(face->x - tile->origin_x), y = (float)(face->y - tile->origin_y);
    float radius = (float)coverage_radius(face->radius, tile->cell), per_cell = (float)(1 / tile->cell);
    float depth = (float)optics->bevel_depth,
          per_width = optics->bevel_width > 0 ? (float)(1 / optics->bevel_width) : 0;
    for (int j = w.y0; j < w.y1; j++) {
        size_t start = (size_t)j * (size_t)tile->width;
        const float *restrict px = tile->x + start, *restrict py = tile->y + start,
                              *restrict layer = tile->layer + start;
        float *restrict value = tile->value + start, *restrict cover = tile->cover + start;
        for (int i = w.x0; i < w.x1; i++) {
            float dx = px[i] - x, dy = y - py[i];
            float square = dx * dx + dy * dy + 1e-12f, distance = sqrtf(square);
            float rim = radius + (a * (dx * dx - dy * dy) + b * 2 * dx * dy) / square;
            float share = least(coverage((rim - distance) * per_cell), 1 - cover[i]);
            float dark = least(1 - least((rim - distance) * per_width, 1), 1);
            value[i] += share * (layer[i] * (1 - depth * dark));
            cover[i] += share;
        }
    }
}

/* The rod goes back from its face towards the point that the camera aims at: parallax px per px from the photo's
 * middle. What shows of it is the strip that the disc sweeps, darker the deeper. */
SIMD_CLONES static void lay_flank(const struct optics *optics, struct tile *tile, struct window w,
                                  const struct face *face, struct vec sweep)
{
    double length = vec_norm(sweep);
    struct vec along = vec_unit(sweep);
    float ax = (float)along.x, ay = (float)along.y, reach = (float)length;
    float x = (float)(face->x - tile->origin_x), y = (float)(face->y - tile->origin_y);
    float radius = (float)coverage_radius(face->radius, tile->cell), per_cell = (float)(1 / tile->cell);
    float per_depth = (float)(1 / length), level = (float)optics->flank_level;
    for (int j = w.y0; j < w.y1; j++) {
        size_t start = (size_t)j * (size_t)tile->width;
        const float *restrict px = tile->x + start, *restrict py = tile->y + start;
        float *restrict value = tile->value + start, *restrict cover = tile->cover + start;
        for (int i = w.x0; i < w.x1; i++) {
            float dx = px[i] - x, dy = py[i] - y, s = dx * ax + dy * ay;
            float front = sqrtf(dx * dx + dy * dy) - radius; /* beyond the face */
            s = s < 0 ? 0 : s > reach ? reach : s;
            float ex = dx - s * ax, ey = dy - s * ay;
            float swept = coverage((radius - sqrtf(ex * ex + ey * ey)) * per_cell) - coverage(-front * per_cell);
            float share = least(swept > 0 ? swept : 0, 1 - cover[i]), depth = least(front * per_depth, 1);
            depth = depth < 0 ? 0 : depth;
            value[i] += share * level * (1 - depth) * (1 - depth);
            cover[i] += share;
        }
    }
}

/* Row k; columns that the table lacks are 0. */
static struct face face_of(const struct photo_grains *grains, size_t k)
{
    return (struct face){grains->x_px[k],
                         grains->y_px[k],
                         grains->radius_px[k],
                         column_or_zero(grains->shape_c, k),
                         column_or_zero(grains->shape_s, k),
                         column_or_zero(grains->angle, k)};
}

/* A row that lacks a number is left out of the picture. */
static int face_is_drawn(const struct face *face)
{
    return isfinite(face->x + face->y + face->radius + face->shape_c + face->shape_s + face->angle) && face->radius > 0;
}

static void paint_face(const struct picture *picture, const struct optics *optics, struct tile *tile, size_t k)
{
    struct face face = face_of(picture->grains, k);
    if (!face_is_drawn(&face))
        return;
    struct window w = tile_window(tile, face.x, face.y, face.radius + hypot(face.shape_c, face.shape_s));
    if (w.x0 >= w.x1 || w.y0 >= w.y1)
        return;
    double level = optics->grain.level * (1 + optics->grain.spread * random_normal(body_key(optics, BODY_LEVEL, k), 0));
    speckle_surface(tile, w, &(struct surface){0}, level, pose_of(0, 0, 0), 0);
    if (optics->ring_contrast > 0)
        paint_rings(optics, tile, w, &face, k);
    if (optics->line_share > 0)
        paint_line(optics, tile, w, &face, k);
    speckle_paint(tile, w, &optics->grain, pose_of(face.x, face.y, face.angle), body_key(optics, BODY_GRAIN, k));
    lay_face(optics, tile, w, &face);
}

static void paint_flank(const struct picture *picture, const struct optics *optics, struct tile *tile, size_t k)
{
    struct face face = face_of(picture->grains, k);
    if (!face_is_drawn(&face))
        return;
    struct vec middle = vec(0.5 * (picture->width - 1), 0.5 * (picture->height - 1));
    struct vec sweep = vec_scale(optics->parallax, vec_sub(middle, vec(face.x, face.y)));
    struct window w = tile_window(tile, face.x, face.y, face.radius + vec_norm(sweep));
    if (w.x0 < w.x1 && w.y0 < w.y1 && vec_norm(sweep) > 0)
        lay_flank(optics, tile, w, &face, sweep);
}

void faces_paint(const struct picture *picture, const struct optics *optics, struct tile *tile)
{
    for (size_t k = 0; k < picture->grains->count; k++)
        paint_face(picture, optics, tile, k);
    for (size_t k = 0; optics->parallax > 0 && k < picture->grains->count; k++)
        paint_flank(picture, optics, tile, k);
}
