/* Point spread and pixel as one separable filter over cells: a Gaussian of standard deviation psf convolved with the
 * box of a pixel, by differences of its integral. The cells' own blur by a B-spline (tile.h: variance cell^2 / 3) is
 * part of the Gaussian already and is taken off.
 *
 * Noise of a pixel: normal, of variance read^2 + shot^2 value, as photon counts have it (European Machine Vision
 * Association, standard 1288). Values are cut to the scale, rounded to 2^bits - 1 steps and stored in the upper bits of
 * 16-bit words, as cameras do. */
#include "simulation/render/sensor.h"

#include <math.h>

#include "pipeline/speak/error.h"
#include "pipeline/numbers/random.h"

/* Integral of the Gaussian of variance s^2 from minus infinity to x. */
static double normal_share(double x, double s)
{
    return 0.5 * erfc(-x / (s * sqrt(2.0)));
}

/* The weights of a pixel over the cells around it: pixel (a box of 1 px) convolved with what the cells have not yet
 * of the point spread: variance psf^2 - cell^2 / 3, see tile.h. */
int sensor_begin(struct sensor *sensor, const struct optics *optics, long index, double blur, double brightness)
{
    double psf = fmax(optics->psf + blur, OPTICS_PSF_MIN);
    *sensor = (struct sensor){.optics = optics, .index = index, .psf = psf, .exposure = optics->exposure * brightness};
    sensor->margin = (int)ceil(5 * psf + 0.5);
    sensor->taps = CELLS * (2 * sensor->margin + 1);
    if (sensor->taps > SENSOR_TAPS_MAX)
        return error_input("optics: a point spread of %g px is too wide: give psf_px of 50 or less", psf);
    double rest = sqrt(psf * psf - 1.0 / (3 * CELLS * CELLS)), sum = 0;
    for (int t = 0; t < sensor->taps; t++) {
        double from_middle = (t + 0.5) / CELLS - 0.5 - sensor->margin;
        double weight = normal_share(from_middle + 0.5, rest) - normal_share(from_middle - 0.5, rest);
        sensor->weight[t] = (float)(weight / CELLS);
        sum += weight / CELLS;
    }
    for (int t = 0; t < sensor->taps; t++)
        sensor->weight[t] = (float)((double)sensor->weight[t] / sum);
    return 0;
}

/* Point spread in y for the pixel row that starts at cell row `first`. */
SIMD_CLONES static void spread_rows(const struct sensor *sensor, const struct tile *tile, int first,
                                    float *restrict column)
{
    for (int i = 0; i < tile->width; i++)
        column[i] = 0;
    for (int t = 0; t < sensor->taps; t++) {
        const float *restrict row = tile->value + (size_t)(first + t) * (size_t)tile->width;
        float weight = sensor->weight[t];
        for (int i = 0; i < tile->width; i++)
            column[i] += weight * row[i];
    }
}

/* Point spread in x for one pixel: four sums, so that the order is fixed and the additions overlap. */
static double spread_columns(const struct sensor *sensor, const float *column)
{
    float sum[4] = {0};
    for (int t = 0; t < sensor->taps; t += 4)
        for (int lane = 0; lane < 4; lane++)
            sum[lane] += sensor->weight[t + lane] * column[t + lane];
    return (double)((sum[0] + sum[1]) + (sum[2] + sum[3]));
}

/* Light to a 16-bit word: shading, exposure, noise, the ends of the scale, the steps. */
static uint16_t word(const struct sensor *sensor, const struct photo *photo, int x, int y, double light)
{
    const struct optics *optics = sensor->optics;
    double half_x = 0.5 * (photo->width - 1), half_y = 0.5 * (photo->height - 1);
    double away =
        ((x - half_x) * (x - half_x) + (y - half_y) * (y - half_y)) / (half_x * half_x + half_y * half_y + 1e-300);
    double value = light * sensor->exposure * (1 - optics->shading * away);
    double variance =
        optics->read_noise * optics->read_noise + optics->shot_noise * optics->shot_noise * fmax(value, 0);
    if (variance > 0) {
        uint64_t key = random_bits(random_bits(optics->seed, 0x6E6F697365u), (uint64_t)sensor->index);
        value += sqrt(variance) * random_normal(key, (uint64_t)y * (uint64_t)photo->width + (uint64_t)x);
    }
    double steps = ldexp(1, optics->bits) - 1;
    return (uint16_t)(lrint(steps * fmin(fmax(value, 0), 1)) << (16 - optics->bits));
}

void sensor_expose(const struct sensor *sensor, const struct tile *tile, float *scratch, struct photo *photo)
{
    int width = photo->width - tile->pixel_x, height = photo->height - tile->pixel_y;
    width = width < TILE_PIXELS ? width : TILE_PIXELS;
    height = height < TILE_PIXELS ? height : TILE_PIXELS;
    for (int y = 0; y < height; y++) {
        spread_rows(sensor, tile, y * CELLS, scratch);
        uint16_t *pixels = photo->pixels + (size_t)(tile->pixel_y + y) * (size_t)photo->width + (size_t)tile->pixel_x;
        for (int x = 0; x < width; x++)
            pixels[x] =
                word(sensor, photo, tile->pixel_x + x, tile->pixel_y + y, spread_columns(sensor, scratch + x * CELLS));
    }
}
