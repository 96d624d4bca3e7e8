#include "tests/discs.h"
#include "tests/check.h"

#include <math.h>
#include <stdlib.h>

enum { CHORDS = 64 };

static double rim_at(const struct disc *disc, double dx, double dy)
{
    double r2 = dx * dx + dy * dy;
    return r2 > 0 ? disc->radius + (disc->c2 * (dx * dx - dy * dy) + disc->s2 * 2 * dx * dy) / r2 : disc->radius;
}

/* Where the horizontal line at height dy above the centre leaves the rim, to the right (sign 1) or left (-1). */
static double chord_end(const struct disc *disc, double dy, int sign)
{
    double x = sqrt(fmax(0, disc->radius * disc->radius - dy * dy));
    int rounds = disc->c2 == 0 && disc->s2 == 0 ? 0 : 30;
    for (int k = 0; k < rounds; k++) {
        double r = rim_at(disc, sign * x, dy);
        x = sqrt(fmax(0, r * r - dy * dy));
    }
    return sign * x;
}

/* Add `grey` times the covered share of every pixel of one row, from x = a to b. */
static void cover_row(double *row, int width, double a, double b, double grey)
{
    for (int x = (int)fmax(0, floor(a + 0.5)); x < width && x - 0.5 < b; x++) {
        double share = fmin(b, x + 0.5) - fmax(a, x - 0.5);
        if (share > 0)
            row[x] += grey * share;
    }
}

/* Coverage of a disc by pixel into `mask` (width x height, added). */
static void cover_disc(double *mask, int width, int height, const struct disc *disc, double grey)
{
    double reach = disc->radius + fabs(disc->c2) + fabs(disc->s2);
    int first = (int)fmax(0, floor(disc->y - reach)), last = (int)fmin(height - 1, ceil(disc->y + reach));
    for (int y = first; y <= last; y++)
        for (int k = 0; k < CHORDS; k++) {
            double dy = y - 0.5 + (k + 0.5) / CHORDS - disc->y;
            double right = chord_end(disc, dy, 1), left = chord_end(disc, dy, -1);
            if (right > left)
                cover_row(mask + (size_t)y * (size_t)width, width, disc->x + left, disc->x + right, grey / CHORDS);
        }
}

static void paint_dot(double *face, int width, int height, const struct disc *dot, double grey)
{
    enum { PATCH = 8 };
    double patch[PATCH * PATCH] = {0};
    int x0 = (int)floor(dot->x) - PATCH / 2 + 1, y0 = (int)floor(dot->y) - PATCH / 2 + 1;
    struct disc local = *dot;
    local.x -= x0;
    local.y -= y0;
    cover_disc(patch, PATCH, PATCH, &local, 1);
    for (int j = 0; j < PATCH; j++)
        for (int i = 0; i < PATCH; i++)
            if (x0 + i >= 0 && x0 + i < width && y0 + j >= 0 && y0 + j < height)
                face[(y0 + j) * width + x0 + i] += patch[j * PATCH + i] * (grey - face[(y0 + j) * width + x0 + i]);
}

/* Face of a disc: its grey, growth rings about a point outside, dots of random size and place. */
static void paint_face(double *image, double *mask, int width, int height, const struct disc *disc,
                       const struct scenery *scenery, uint64_t *seed)
{
    int x0 = (int)fmax(0, disc->x - disc->radius * 1.1 - 2),
        x1 = (int)fmin(width - 1, disc->x + disc->radius * 1.1 + 2);
    int y0 = (int)fmax(0, disc->y - disc->radius * 1.1 - 2),
        y1 = (int)fmin(height - 1, disc->y + disc->radius * 1.1 + 2);
    int w = x1 - x0 + 1, h = y1 - y0 + 1;
    if (w <= 0 || h <= 0)
        return;
    double *face = malloc((size_t)w * (size_t)h * sizeof *face);
    double pith_x = disc->x + disc->radius * 3 * (check_uniform(seed) - 0.5), pith_y = disc->y + disc->radius * 2;
    for (int y = 0; y < h; y++)
        for (int x = 0; x < w; x++)
            face[y * w + x] = disc->grey + scenery->rings * sin(hypot(x + x0 - pith_x, y + y0 - pith_y) * 0.9);
    double area = M_PI * disc->radius * disc->radius, covered = 0;
    while (covered < scenery->dots * area) {
        struct disc dot = {.radius = 0.7 + 1.8 * check_uniform(seed)};
        double r = (disc->radius + 2) * sqrt(check_uniform(seed)), a = 2 * M_PI * check_uniform(seed);
        dot.x = disc->x + r * cos(a) - x0;
        dot.y = disc->y + r * sin(a) - y0;
        double grey = check_uniform(seed) < 0.7 ? 0.15 * disc->grey : 1.6 * disc->grey;
        paint_dot(face, w, h, &dot, grey);
        covered += M_PI * dot.radius * dot.radius;
    }
    for (int y = y0; y <= y1; y++)
        for (int x = x0; x <= x1; x++) {
            size_t at = (size_t)y * (size_t)width + (size_t)x;
            image[at] += mask[at] * (face[(y - y0) * w + x - x0] - image[at]);
            mask[at] = 0;
        }
    free(face);
}

static void blur_line(double *line, int count, int stride, const double *kernel, int half, double *copy)
{
    for (int k = 0; k < count; k++)
        copy[k] = line[(size_t)k * (size_t)stride];
    for (int k = 0; k < count; k++) {
        double sum = 0;
        for (int j = -half; j <= half; j++) {
            int at = k + j < 0 ? 0 : k + j >= count ? count - 1 : k + j;
            sum += kernel[j + half] * copy[at];
        }
        line[(size_t)k * (size_t)stride] = sum;
    }
}

static void blur_image(double *image, int width, int height, double sigma)
{
    int half = (int)ceil(6 * sigma);
    double kernel[64], sum = 0, *copy = malloc((size_t)(width + height) * sizeof *copy);
    for (int k = -half; k <= half; k++)
        sum += kernel[k + half] = exp(-0.5 * k * k / (sigma * sigma));
    for (int k = 0; k <= 2 * half; k++)
        kernel[k] /= sum;
    for (int y = 0; y < height; y++)
        blur_line(image + (size_t)y * (size_t)width, width, 1, kernel, half, copy);
    for (int x = 0; x < width; x++)
        blur_line(image + x, height, width, kernel, half, copy);
    free(copy);
}

int discs_draw(int width, int height, const struct disc *discs, size_t count, const struct scenery *scenery,
               struct photo *photo)
{
    uint64_t seed = scenery->seed;
    size_t pixels = (size_t)width * (size_t)height;
    *photo =
        (struct photo){.width = width, .height = height, .bits = 16, .pixels = malloc(pixels * sizeof *photo->pixels)};
    double *image = malloc(pixels * sizeof *image), *mask = calloc(pixels, sizeof *mask);
    if (!photo->pixels || !image || !mask)
        return -1;
    for (size_t k = 0; k < pixels; k++)
        image[k] = scenery->void_grey;
    for (size_t k = 0; k < count; k++) {
        cover_disc(mask, width, height, &discs[k], 1);
        paint_face(image, mask, width, height, &discs[k], scenery, &seed);
    }
    if (scenery->blur > 0)
        blur_image(image, width, height, scenery->blur);
    for (size_t k = 0; k < pixels; k++) {
        double grey = floor(image[k] + (scenery->noise > 0 ? scenery->noise * check_normal(&seed) : 0) + 0.5);
        photo->pixels[k] = (uint16_t)fmin(65535, fmax(0, grey));
    }
    free(image);
    free(mask);
    return 0;
}

/* Centre of a disc of radius r that touches a and b, on the left of a -> b; 0 when they are too far apart. */
static int seat(const struct disc *a, const struct disc *b, double r, struct disc *on)
{
    double dx = b->x - a->x, dy = b->y - a->y, d = hypot(dx, dy), p = a->radius + r, q = b->radius + r;
    double along = (d * d + p * p - q * q) / (2 * d), off2 = p * p - along * along;
    if (!(off2 >= 0))
        return 0;
    double off = sqrt(off2);
    on->x = a->x + (along * dx - off * dy) / d;
    on->y = a->y + (along * dy + off * dx) / d;
    on->radius = r;
    return 1;
}

static int is_free(const struct disc *discs, size_t count, const struct disc *on)
{
    for (size_t k = 0; k < count; k++)
        if (hypot(discs[k].x - on->x, discs[k].y - on->y) < discs[k].radius + on->radius - 1e-9)
            return 0;
    return 1;
}

/* The free seat nearest to the middle over all pairs of near discs. */
static int best_seat(const struct disc *discs, size_t count, double x, double y, double r, struct disc *best)
{
    double nearest = INFINITY;
    for (size_t i = 0; i < count; i++)
        for (size_t j = 0; j < count; j++) {
            struct disc on = {0};
            if (i == j ||
                hypot(discs[i].x - discs[j].x, discs[i].y - discs[j].y) > discs[i].radius + discs[j].radius + 2 * r)
                continue;
            if (!seat(&discs[i], &discs[j], r, &on))
                continue;
            double far = hypot(on.x - x, on.y - y);
            if (far < nearest && is_free(discs, count, &on)) {
                nearest = far;
                *best = on;
            }
        }
    return nearest < INFINITY;
}

size_t discs_pack(int width, int height, const double *radii, size_t radius_count, double margin, uint64_t seed,
                  struct disc *discs, size_t room)
{
    size_t count = 0, misses = 0;
    double x = 0.5 * width, y = 0.5 * height;
    while (count < room && misses < 20) {
        double r = radii[(size_t)(check_uniform(&seed) * (double)radius_count)];
        struct disc on = {.x = x + 0.37, .y = y - 0.21, .radius = r};
        if (count == 1)
            on.x = discs[0].x + discs[0].radius + r;
        int seated = count < 2 || best_seat(discs, count, x, y, r, &on);
        double depth = fmin(fmin(on.x, width - 1 - on.x), fmin(on.y, height - 1 - on.y));
        if (!seated || depth < r + margin) {
            misses++;
            continue;
        }
        discs[count++] = on;
    }
    return count;
}
