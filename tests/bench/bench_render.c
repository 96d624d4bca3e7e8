/* Speed of the virtual camera against what it paints. bench_render [--full] [--json FILE]: 4 Mpixel, or the size of
 * the real photos (10320 x 7752, 1850 grains). */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "pipeline/speak/error.h"
#include "pipeline/numbers/random.h"
#include "simulation/render/render.h"

/* Rods of the real grading's mean size on a hexagonal lattice, as many as fit the frame. */
static int fill_lattice(struct photo_grains *grains, int width, int height, size_t count)
{
    static const char *const columns[] = {"x_px", "y_px", "radius_px", "angle", NULL};
    if (table_alloc(&PHOTO_GRAINS, grains, count, columns))
        return -1;
    double pitch = sqrt(width * (double)height / (double)count / 0.8660254037844386);
    size_t columns_count = (size_t)(width / pitch);
    for (size_t k = 0; k < count; k++) {
        size_t row = k / columns_count, column = k % columns_count;
        grains->x_px[k] = pitch * ((double)column + 0.5 + 0.5 * (double)(row & 1));
        grains->y_px[k] = pitch * (0.5 + 0.8660254037844386 * (double)row);
        grains->radius_px[k] = 0.5 * pitch;
        grains->angle[k] = (double)k;
    }
    return 0;
}

static int measure(FILE *json, const char *name, const struct optics *optics, int width, int height, size_t count,
                   int first)
{
    struct photo_grains grains = {0};
    struct photo photo = {0};
    int status = fill_lattice(&grains, width, height, count);
    struct picture picture = {.width = width, .height = height, .grains = &grains};
    clock_t start = clock();
    status = status || render_picture(&picture, optics, &photo);
    double cpu = (double)(clock() - start) / CLOCKS_PER_SEC, pixels = width * (double)height;
    if (!status) {
        printf("%-34s %7.2f s CPU %8.1f ns/px\n", name, cpu, 1e9 * cpu / pixels);
        if (json)
            fprintf(json, "%s{\"name\": \"%s\", \"width\": %d, \"height\": %d, \"cpu_s\": %.3f}", first ? "" : ",\n",
                    name, width, height, cpu);
    }
    photo_free(&photo);
    table_free(&PHOTO_GRAINS, &grains);
    return status;
}

enum { LIGHT = 32768, DARK = 3277 }; /* counts of the plain disc and of the void: no rounding of the plateaus */

/* Centre and radius of one plain disc from the sums over its pixels (a blurred picture's sums are its integrals). */
static void read_disc(const struct photo *photo, double *x, double *y, double *radius)
{
    double dark = DARK, full = LIGHT - DARK;
    double mass = 0, mx = 0, my = 0;
    for (int j = 0; j < photo->height; j++)
        for (int i = 0; i < photo->width; i++) {
            double share = (photo_row(photo, j)[i] - dark) / full;
            mass += share;
            mx += share * i;
            my += share * j;
        }
    *x = mx / mass;
    *y = my / mass;
    *radius = sqrt(mass / 3.14159265358979323846);
}

/* 100 sub-pixel positions: worst centre and radius, and their means. */
static int measure_edges(FILE *json, double psf, double radius)
{
    static const char *const columns[] = {"x_px", "y_px", "radius_px", NULL};
    struct photo_grains grains = {0};
    struct optics optics = OPTICS_PLAIN;
    double worst_centre = 0, worst_radius = 0, mean_radius = 0;
    int size = 2 * (int)(radius + 6 * psf + 4) + 1, status = table_alloc(&PHOTO_GRAINS, &grains, 1, columns);
    struct picture picture = {.width = size, .height = size, .grains = &grains};
    optics.psf = psf;
    optics.grain.level = LIGHT / 65535.0;
    optics.hollow.level = DARK / 65535.0;
    for (uint64_t trial = 0; trial < 100 && !status; trial++) {
        struct photo photo = {0};
        double x, y, r;
        grains.x_px[0] = size / 2 - 0.5 + random_uniform(1, trial);
        grains.y_px[0] = size / 2 - 0.5 + random_uniform(2, trial);
        grains.radius_px[0] = radius + random_uniform(3, trial);
        status = render_picture(&picture, &optics, &photo);
        if (status)
            break;
        read_disc(&photo, &x, &y, &r);
        worst_centre = fmax(worst_centre, hypot(x - grains.x_px[0], y - grains.y_px[0]));
        worst_radius = fmax(worst_radius, fabs(r - grains.radius_px[0]));
        mean_radius += (r - grains.radius_px[0]) / 100;
        photo_free(&photo);
    }
    table_free(&PHOTO_GRAINS, &grains);
    if (status)
        return status;
    printf("%6.2f %8.0f %12.1e %12.1e %12.1e\n", psf, radius, worst_centre, worst_radius, mean_radius);
    if (json)
        fprintf(json, ",\n{\"psf_px\": %g, \"radius_px\": %g, \"worst_centre_px\": %.3g, \"worst_radius_px\": %.3g}",
                psf, radius, worst_centre, worst_radius);
    return 0;
}

static int measure_all_edges(FILE *json)
{
    static const double psf[] = {0.3, 0.5, 0.7, 1.0, 1.5}, radius[] = {3, 14, 60};
    printf("\n%6s %8s %12s %12s %12s   (px, 100 sub-pixel positions)\n", "psf", "radius", "worst centre",
           "worst radius", "radius bias");
    for (int p = 0; p < 5; p++)
        for (int r = 0; r < 3; r++)
            if (measure_edges(json, psf[p], radius[r]))
                return -1;
    return 0;
}

static int run(int full, FILE *json)
{
    int width = full ? 10320 : 2064, height = full ? 7752 : 1938;
    size_t count = full ? 1850 : 92;
    struct optics plain = OPTICS_PLAIN, speckle = OPTICS_DEFAULT, all;
    speckle.read_noise = speckle.shot_noise = 0;
    all = (struct optics)OPTICS_DEFAULT;
    all.ring_spacing = 8;
    all.ring_contrast = 0.2;
    all.bevel_width = 2;
    all.bevel_depth = 0.3;
    all.shading = 0.07;
    all.grain.paint[all.grain.paint_count++] = (struct paint){2, 8, 0.2, 0.03, 0.03};
    if (!full && (measure(json, "plain faces", &plain, width, height, count, 1) ||
                  measure(json, "speckle", &speckle, width, height, count, 0)))
        return -1;
    if (measure(json, "speckle, specks, rings, bevel, noise", &all, width, height, count, full))
        return -1;
    return full ? 0 : measure_all_edges(json);
}

int main(int argc, char **argv)
{
    int full = 0;
    FILE *json = NULL;
    for (int k = 1; k < argc; k++) {
        full |= !strcmp(argv[k], "--full");
        if (!strcmp(argv[k], "--json") && k + 1 < argc)
            json = fopen(argv[k + 1], "w");
    }
    if (json)
        fputs("[\n", json);
    int status = run(full, json);
    if (status)
        fprintf(stderr, "bench_render: %s\n", error_message());
    if (json) {
        fputs("\n]\n", json);
        fclose(json);
    }
    return status ? EXIT_FAILURE : EXIT_SUCCESS;
}
