/* Speed of the virtual camera against what it paints. bench_render [--full] [--json FILE]: 4 Mpixel, or the size of
 * the real photos (10320 x 7752, 1850 grains). */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "pipeline/error.h"
#include "simulation/render.h"

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
    return measure(json, "speckle, specks, rings, bevel, noise", &all, width, height, count, full);
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
