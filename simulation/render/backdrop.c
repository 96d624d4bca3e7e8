/* What lies behind the grains: the hollow inside the frame, the frame, its surroundings, paper, markers, labels,
 * hinges; each a surface laid over the ones before it. An edge covers a cell by the share of coverage() (tile.h),
 * corners by the product of those of their two edges. */
#include "simulation/render/layers.h"

/* A convex outline as four half-planes: distance inside in cells = across x + along y + from, tile coordinates. */
struct outline {
    float across[4], along[4], from[4];
};

/* Corners clockwise as seen (y down). */
static struct outline outline_of(const struct tile *tile, const struct vec corners[4])
{
    struct outline outline;
    for (int k = 0; k < 4; k++) {
        struct vec inward = vec_turn(vec_unit(vec_sub(corners[(k + 1) % 4], corners[k])));
        struct vec start = vec_sub(vec(tile->origin_x, tile->origin_y), corners[k]);
        outline.across[k] = (float)(inward.x / tile->cell);
        outline.along[k] = (float)(inward.y / tile->cell);
        outline.from[k] = (float)(vec_dot(inward, start) / tile->cell);
    }
    return outline;
}

/* Is every cell of the tile well inside all four lines (1), well outside one of them (-1), or neither (0)? */
static int tile_against(const struct tile *tile, const struct outline *outline)
{
    double reach = 0.75 * (tile->width + 2 * tile->bend);
    int inside = 1;
    for (int k = 0; k < 4; k++) {
        if ((double)outline->from[k] < -reach)
            return -1;
        inside = inside && (double)outline->from[k] > reach;
    }
    return inside;
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

/* Lay the layer over what lies behind, inside (or outside) the outline, within the window. */
SIMD_CLONES static void lay(struct tile *tile, struct window w, const struct outline *outline, int outside)
{
    for (int j = w.y0; j < w.y1; j++) {
        size_t start = (size_t)j * (size_t)tile->width;
        const float *restrict px = tile->x + start, *restrict py = tile->y + start,
                              *restrict layer = tile->layer + start;
        float *restrict back = tile->back + start;
        for (int i = w.x0; i < w.x1; i++) {
            float share = 1;
            for (int k = 0; k < 4; k++)
                share *= coverage(outline->across[k] * px[i] + outline->along[k] * py[i] + outline->from[k]);
            share = outside ? 1 - share : share;
            back[i] += share * (layer[i] - back[i]);
        }
    }
}

/* A steel disc: its middle on the corner of the frame, convex towards the specimen. */
static void paint_hinge(const struct picture *picture, const struct optics *optics, struct tile *tile, int hinge)
{
    const struct drawn_disc *disc = &picture->hinges[hinge];
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

static const struct surface *plate_surface(const struct optics *optics, enum plate_kind kind)
{
    return kind == PLATE_PAPER ? &optics->paper : kind == PLATE_MARKER ? &optics->marker : &optics->label;
}

static void paint_plate(const struct picture *picture, const struct optics *optics, struct tile *tile, size_t k)
{
    const struct plate *plate = &picture->plates[k];
    const struct surface *surface = plate_surface(optics, plate->kind);
    struct pose pose = pose_of(plate->x, plate->y, plate->angle);
    struct window w = tile_window(tile, plate->x, plate->y, 0.5 * hypot(plate->width, plate->height));
    struct vec corners[4];
    for (int corner = 0; corner < 4; corner++) {
        double u = (corner == 1 || corner == 2 ? 0.5 : -0.5) * plate->width,
               v = (corner > 1 ? 0.5 : -0.5) * plate->height;
        corners[corner] = vec(pose.x + pose.cosine * u + pose.sine * v, pose.y - pose.sine * u + pose.cosine * v);
    }
    struct outline outline = outline_of(tile, corners);
    speckle_surface(tile, w, surface, surface->level, pose, body_key(optics, BODY_PLATE, k));
    lay(tile, w, &outline, 0);
}

static void paint_frame(const struct picture *picture, const struct optics *optics, struct tile *tile)
{
    struct window whole = tile_whole(tile);
    struct vec wide[4];
    widen(picture->corners, optics->frame_width, wide);
    struct outline inner = outline_of(tile, picture->corners), outer = outline_of(tile, wide);
    if (tile_against(tile, &outer) >= 0 && tile_against(tile, &inner) < 1) {
        speckle_surface(tile, whole, &optics->frame, optics->frame.level,
                        pose_of(picture->corners[0].x, picture->corners[0].y, 0), body_key(optics, BODY_FRAME, 0));
        lay(tile, whole, &inner, 1);
    }
    if (tile_against(tile, &outer) < 1) {
        speckle_surface(tile, whole, &optics->outside, optics->outside.level, pose_of(0, 0, 0),
                        body_key(optics, BODY_OUTSIDE, 0));
        lay(tile, whole, &outer, 1);
    }
}

void backdrop_paint(const struct picture *picture, const struct optics *optics, struct tile *tile)
{
    struct window whole = tile_whole(tile);
    size_t cells = (size_t)tile->width * (size_t)tile->height;
    speckle_surface(tile, whole, &optics->hollow, optics->hollow.level, pose_of(0, 0, 0),
                    body_key(optics, BODY_HOLLOW, 0));
    for (size_t at = 0; at < cells; at++)
        tile->back[at] = tile->layer[at];
    if (picture->framed)
        paint_frame(picture, optics, tile);
    for (size_t k = 0; k < picture->plate_count; k++)
        paint_plate(picture, optics, tile, k);
    for (int hinge = 0; hinge < picture->hinge_count; hinge++)
        paint_hinge(picture, optics, tile, hinge);
}
