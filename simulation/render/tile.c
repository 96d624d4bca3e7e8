/* Where the cells of a tile are in the scene. Without a lens the camera is one affine map; with one, positions are
 * exact at the pixels' corners and bilinear between. Positions are floats counted from the tile's middle: a photo of
 * 16000 px leaves floats with 1e-3 px, a tile with 1e-5. */
#include "simulation/render/tile.h"

#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"

int tile_alloc(struct tile *tile, int margin)
{
    *tile = (struct tile){.margin = margin};
    tile->width = tile->height = CELLS * (TILE_PIXELS + 2 * margin);
    size_t cells = (size_t)tile->width * (size_t)tile->height;
    float *block = malloc(6 * cells * sizeof *block);
    if (!block)
        return error_memory("a tile of the photo");
    tile->x = block;
    tile->y = block + cells;
    tile->value = block + 2 * cells;
    tile->cover = block + 3 * cells;
    tile->layer = block + 4 * cells;
    tile->back = block + 5 * cells;
    return 0;
}

void tile_free(struct tile *tile)
{
    free(tile->x);
    *tile = (struct tile){0};
}

/* Photo position of a cell's middle. */
static struct vec cell_seen(const struct tile *tile, double i, double j)
{
    return vec(tile->pixel_x - tile->margin - 0.5 + (i + 0.5) / CELLS,
               tile->pixel_y - tile->margin - 0.5 + (j + 0.5) / CELLS);
}

/* The affine map that tile_window() uses: from central differences about the middle. */
static void set_affine(struct tile *tile, const struct camera *camera)
{
    double i = 0.5 * (tile->width - 1), j = 0.5 * (tile->height - 1);
    struct vec east = camera_corrected(camera, cell_seen(tile, i + 1, j)),
               west = camera_corrected(camera, cell_seen(tile, i - 1, j));
    struct vec south = camera_corrected(camera, cell_seen(tile, i, j + 1)),
               north = camera_corrected(camera, cell_seen(tile, i, j - 1));
    struct vec a = vec_scale(0.5, vec_sub(east, west)), b = vec_scale(0.5, vec_sub(south, north));
    double determinant = vec_cross(a, b);
    tile->cell = sqrt(fabs(determinant));
    tile->to_cell[0][0] = b.y / determinant;
    tile->to_cell[0][1] = -b.x / determinant;
    tile->to_cell[1][0] = -a.y / determinant;
    tile->to_cell[1][1] = a.x / determinant;
    tile->bend = 0;
}

/* The cell, in the affine map's opinion, at a scene position from the origin. */
static struct vec cell_guess(const struct tile *tile, struct vec p)
{
    return vec(0.5 * (tile->width - 1) + tile->to_cell[0][0] * p.x + tile->to_cell[0][1] * p.y,
               0.5 * (tile->height - 1) + tile->to_cell[1][0] * p.x + tile->to_cell[1][1] * p.y);
}

/* Scene positions of a camera without a lens: one affine map for the whole tile. */
static void fill_affine(struct tile *tile, const struct camera *camera, struct vec middle)
{
    struct vec first = vec_sub(camera_corrected(camera, cell_seen(tile, 0, 0)), middle);
    struct vec east = vec_sub(vec_sub(camera_corrected(camera, cell_seen(tile, tile->width, 0)), middle), first);
    struct vec south = vec_sub(vec_sub(camera_corrected(camera, cell_seen(tile, 0, tile->height)), middle), first);
    for (int j = 0; j < tile->height; j++) {
        struct vec start = vec_add(first, vec_scale((double)j / tile->height, south));
        float *restrict x = tile->x + (size_t)j * (size_t)tile->width, *restrict y = tile->y + (x - tile->x);
        for (int i = 0; i < tile->width; i++) {
            double part = (double)i / tile->width;
            x[i] = (float)(start.x + part * east.x);
            y[i] = (float)(start.y + part * east.y);
        }
    }
}

/* Scene positions behind a lens: exact at the corners of every pixel, bilinear on the cells between (second
 * derivatives of a lens are below 1e-4 per px, so that this errs by less than 1e-5 px). */
static void fill_bent(struct tile *tile, const struct camera *camera, struct vec middle)
{
    for (int j0 = 0; j0 < tile->height; j0 += CELLS)
        for (int i0 = 0; i0 < tile->width; i0 += CELLS) {
            struct vec node[2][2];
            for (int b = 0; b < 2; b++)
                for (int a = 0; a < 2; a++)
                    node[b][a] =
                        vec_sub(camera_corrected(camera, cell_seen(tile, i0 + a * CELLS, j0 + b * CELLS)), middle);
            struct vec far = cell_guess(tile, node[0][0]);
            tile->bend = fmax(tile->bend, fmax(fabs(far.x - i0), fabs(far.y - j0)));
            for (int cell = 0; cell < CELLS * CELLS; cell++) {
                int i = cell % CELLS, j = cell / CELLS;
                double u = (double)i / CELLS, v = (double)j / CELLS;
                struct vec north = vec_add(node[0][0], vec_scale(u, vec_sub(node[0][1], node[0][0])));
                struct vec south = vec_add(node[1][0], vec_scale(u, vec_sub(node[1][1], node[1][0])));
                struct vec p = vec_add(north, vec_scale(v, vec_sub(south, north)));
                size_t at = (size_t)(j0 + j) * (size_t)tile->width + (size_t)(i0 + i);
                tile->x[at] = (float)p.x;
                tile->y[at] = (float)p.y;
            }
        }
    tile->bend = 2 * tile->bend + 1; /* in both directions, and what lies between the nodes */
}

void tile_begin(struct tile *tile, const struct camera *camera, int pixel_x, int pixel_y)
{
    tile->pixel_x = pixel_x;
    tile->pixel_y = pixel_y;
    struct vec middle = camera_corrected(camera, cell_seen(tile, 0.5 * (tile->width - 1), 0.5 * (tile->height - 1)));
    tile->origin_x = middle.x;
    tile->origin_y = middle.y;
    set_affine(tile, camera);
    if (camera->lens)
        fill_bent(tile, camera, middle);
    else
        fill_affine(tile, camera, middle);
    size_t bytes = (size_t)tile->width * (size_t)tile->height * sizeof *tile->value;
    memset(tile->value, 0, bytes);
    memset(tile->cover, 0, bytes);
}

/* floor and ceiling cut to a range, safe for any finite number. */
static int cut(double value, int most)
{
    return value <= 0 ? 0 : value >= most ? most : (int)value;
}

struct window tile_window(const struct tile *tile, double x, double y, double radius)
{
    struct vec at = cell_guess(tile, vec(x - tile->origin_x, y - tile->origin_y));
    double reach = radius / tile->cell * (1 + 0.01 * (tile->bend > 0)) + 2 + tile->bend;
    return (struct window){cut(ceil(at.x - reach), tile->width), cut(ceil(at.y - reach), tile->height),
                           cut(floor(at.x + reach) + 1, tile->width), cut(floor(at.y + reach) + 1, tile->height)};
}

struct window tile_whole(const struct tile *tile)
{
    return (struct window){0, 0, tile->width, tile->height};
}
