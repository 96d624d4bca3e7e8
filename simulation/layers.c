#include "simulation/layers.h"

#include "pipeline/random.h"

/* Keys of what is painted; each body adds its own number. */
enum body { BODY_GRAIN, BODY_HOLLOW, BODY_FRAME, BODY_HINGE, BODY_OUTSIDE, BODY_RING, BODY_LEVEL, BODY_PLATE };

static uint64_t body_key(const struct optics *optics, enum body body, size_t number)
{
    return random_bits(random_bits(optics->seed, (uint64_t)body), number);
}

/* ---- behind the grains ---- */

/* Share of a cell on the left of the line from a to b, seen with y down: inside for corners given clockwise as seen. */
static float side_of(struct vec p, struct vec a, struct vec b, double cell)
{
    struct vec along = vec_unit(vec_sub(b, a));
    return coverage((float)(vec_cross(along, vec_sub(p, a)) / cell));
}

/* Share of a cell inside a convex outline, clockwise as seen. */
static float inside(struct vec p, const struct vec corners[4], double cell)
{
    float share = 1;
    for (int k = 0; k < 4; k++)
        share *= side_of(p, corners[k], corners[(k + 1) % 4], cell);
    return share;
}

/* The outline moved outwards by a width. */
static void widen(const struct vec corners[4], double width, struct vec wide[4])
{
    for (int k = 0; k < 4; k++) {
        struct vec before = vec_unit(vec_sub(corners[k], corners[(k + 3) % 4]));
        struct vec after = vec_unit(vec_sub(corners[(k + 1) % 4], corners[k]));
        /* Both offset lines pass here: corner - width (n1 + n2) / (1 + n1 . n2), n inward normals. */
        struct vec sum = vec_add(vec_turn(before), vec_turn(after));
        wide[k] = vec_sub(corners[k], vec_scale(width / (1 + vec_dot(vec_turn(before), vec_turn(after))), sum));
    }
}

/* Lay the layer over what lies behind, outside the outline. */
TILE_LOOP static void lay_outside(struct tile *tile, const struct vec corners[4])
{
    for (int j = 0; j < tile->height; j++)
        for (int i = 0; i < tile->width; i++) {
            size_t at = (size_t)j * (size_t)tile->width + (size_t)i;
            struct vec p = vec(tile->origin_x + (double)tile->x[at], tile->origin_y + (double)tile->y[at]);
            tile->back[at] += (1 - inside(p, corners, tile->cell)) * (tile->layer[at] - tile->back[at]);
        }
}

/* Is every cell of the tile well inside the outline? */
static int tile_inside(const struct tile *tile, const struct vec corners[4])
{
    double reach = 0.75 * (tile->width + 2 * tile->bend) * tile->cell;
    for (int k = 0; k < 4; k++) {
        struct vec along = vec_unit(vec_sub(corners[(k + 1) % 4], corners[k]));
        if (vec_cross(along, vec_sub(vec(tile->origin_x, tile->origin_y), corners[k])) < reach)
            return 0;
    }
    return 1;
}

static void paint_hinge(const struct picture *picture, const struct optics *optics, struct tile *tile, int hinge)
{
    const struct disc *disc = &picture->hinges[hinge];
    struct window w = tile_window(tile, disc->x, disc->y, disc->radius);
    speckle_surface(tile, w, &optics->hinge, optics->hinge.level, pose_of(disc->x, disc->y, 0),
                    body_key(optics, BODY_HINGE, (size_t)hinge));
    double radius = coverage_radius(disc->radius, tile->cell);
    for (int j = w.y0; j < w.y1; j++)
        for (int i = w.x0; i < w.x1; i++) {
            size_t at = (size_t)j * (size_t)tile->width + (size_t)i;
            double dx = tile->origin_x + (double)tile->x[at] - disc->x,
                   dy = tile->origin_y + (double)tile->y[at] - disc->y;
            float share = coverage((float)((radius - sqrt(dx * dx + dy * dy)) / tile->cell));
            tile->back[at] += share * (tile->layer[at] - tile->back[at]);
        }
}

static void paint_plate(const struct picture *picture, const struct optics *optics, struct tile *tile, size_t k)
{
    const struct plate *plate = &picture->plates[k];
    const struct surface *surface = plate->kind == PLATE_PAPER ? &optics->paper : &optics->marker;
    struct pose pose = pose_of(plate->x, plate->y, plate->angle);
    struct window w = tile_window(tile, plate->x, plate->y, 0.5 * hypot(plate->width, plate->height));
    speckle_surface(tile, w, surface, surface->level, pose, body_key(optics, BODY_PLATE, k));
    for (int j = w.y0; j < w.y1; j++)
        for (int i = w.x0; i < w.x1; i++) {
            size_t at = (size_t)j * (size_t)tile->width + (size_t)i;
            double dx = tile->origin_x + (double)tile->x[at] - plate->x,
                   dy = tile->origin_y + (double)tile->y[at] - plate->y;
            double u = fabs(pose.cosine * dx - pose.sine * dy), v = fabs(pose.sine * dx + pose.cosine * dy);
            float share = coverage((float)((0.5 * plate->width - u) / tile->cell)) *
                          coverage((float)((0.5 * plate->height - v) / tile->cell));
            tile->back[at] += share * (tile->layer[at] - tile->back[at]);
        }
}

static void paint_frame(const struct picture *picture, const struct optics *optics, struct tile *tile)
{
    struct window whole = tile_whole(tile);
    speckle_surface(tile, whole, &optics->frame, optics->frame.level,
                    pose_of(picture->corners[0].x, picture->corners[0].y, 0), body_key(optics, BODY_FRAME, 0));
    lay_outside(tile, picture->corners);
    struct vec wide[4];
    widen(picture->corners, optics->frame_width, wide);
    if (tile_inside(tile, wide))
        return;
    speckle_surface(tile, whole, &optics->outside, optics->outside.level, pose_of(0, 0, 0),
                    body_key(optics, BODY_OUTSIDE, 0));
    lay_outside(tile, wide);
}

static void paint_back(const struct picture *picture, const struct optics *optics, struct tile *tile)
{
    struct window whole = tile_whole(tile);
    size_t cells = (size_t)tile->width * (size_t)tile->height;
    speckle_surface(tile, whole, &optics->hollow, optics->hollow.level, pose_of(0, 0, 0),
                    body_key(optics, BODY_HOLLOW, 0));
    for (size_t at = 0; at < cells; at++)
        tile->back[at] = tile->layer[at];
    if (picture->framed && !tile_inside(tile, picture->corners))
        paint_frame(picture, optics, tile);
    for (size_t k = 0; k < picture->plate_count; k++)
        paint_plate(picture, optics, tile, k);
    for (int hinge = 0; hinge < picture->hinge_count; hinge++)
        paint_hinge(picture, optics, tile, hinge);
}

/* ---- grains ---- */

struct face {
    double x, y, radius, shape_c, shape_s, angle;
};

/* Annual rings around a pith that lies off the rod's middle: each ring darkens towards its end. */
TILE_LOOP static void paint_rings(const struct optics *optics, struct tile *tile, struct window w,
                                  const struct face *face, size_t grain)
{
    uint64_t key = body_key(optics, BODY_RING, grain);
    double turn = 6.283185307179586 * random_uniform(key, 0),
           away = face->radius * (0.3 + 1.4 * random_uniform(key, 1));
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

static float least(float a, float b)
{
    return a < b ? a : b;
}

/* Cut the layer to the face's rim r(phi) = radius + c cos 2(phi - angle) + s sin 2(phi - angle), darken the bevel, and
 * add what no earlier grain hides. Touching faces share a cell exactly: shares add up to at most 1. */
TILE_LOOP static void lay_face(const struct optics *optics, struct tile *tile, struct window w, const struct face *face)
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

static struct face face_of(const struct photo_grains *grains, size_t k)
{
    return (struct face){grains->x_px[k],
                         grains->y_px[k],
                         grains->radius_px[k],
                         column_or_zero(grains->shape_c, k),
                         column_or_zero(grains->shape_s, k),
                         column_or_zero(grains->angle, k)};
}

static void paint_grain(const struct picture *picture, const struct optics *optics, struct tile *tile, size_t k)
{
    struct face face = face_of(picture->grains, k);
    if (!isfinite(face.x + face.y + face.radius + face.shape_c + face.shape_s + face.angle) || face.radius <= 0)
        return;
    struct window w = tile_window(tile, face.x, face.y, face.radius + hypot(face.shape_c, face.shape_s));
    if (w.x0 >= w.x1 || w.y0 >= w.y1)
        return;
    double level = optics->grain.level * (1 + optics->grain.spread * random_normal(body_key(optics, BODY_LEVEL, k), 0));
    speckle_surface(tile, w, &(struct surface){0}, level, pose_of(0, 0, 0), 0);
    if (optics->ring_contrast > 0)
        paint_rings(optics, tile, w, &face, k);
    speckle_paint(tile, w, &optics->grain, pose_of(face.x, face.y, face.angle), body_key(optics, BODY_GRAIN, k));
    lay_face(optics, tile, w, &face);
}

void layers_paint(const struct picture *picture, const struct optics *optics, struct tile *tile)
{
    for (size_t k = 0; k < picture->grains->count; k++)
        paint_grain(picture, optics, tile, k);
    paint_back(picture, optics, tile);
    size_t cells = (size_t)tile->width * (size_t)tile->height;
    for (size_t at = 0; at < cells; at++)
        tile->value[at] += (1 - tile->cover[at]) * tile->back[at];
}
