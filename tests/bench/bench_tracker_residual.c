/* What a match leaves, as a picture: photo - gain * reference - offset over every followed grain.
 *
 *     bench_tracker_residual REFERENCE.tif PHOTO.tif REFERENCE.grains.hdf OUT.tif
 *
 * Grey in the middle is zero; full scale is the reference's own contrast (three standard deviations to each side).
 * Prints per grain the residual over the contrast, its correlation from one pixel to the next, and its correlation with
 * the reference's slopes, which a wrong motion would leave. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/speak/progress.h"
#include "pipeline/state/state.h"
#include "tracker/subset/kernel.h"
#include "tracker/follow/track_grains.h"

struct figures {
    double residual, contrast, lag, slope_x, slope_y, slope_square;
    size_t count, pairs;
};

/* Residual of one run, into the picture and the figures. */
static void take_run(const struct subset *subset, const struct patch *patch, const struct motion *motion,
                     const struct run *run, double gain, double offset, struct photo *picture, struct figures *f)
{
    float *t = malloc((size_t)run->count * sizeof *t);
    struct line line = kernel_line(subset, patch, motion, run);
    const float *grey = subset->planes + SUBSET_GREY * subset->count + run->offset;
    if (!t)
        abort();
    interpolate_chosen(patch->order)(patch, &line, 0, run->count, t);
    double full = 3 * sqrt(subset->energy / (double)subset->count) * gain;
    for (int i = 0; i < run->count; i++) {
        double e = t[i] - gain * grey[i] - offset, zx = subset->planes[run->offset + (size_t)i];
        double zy = subset->planes[subset->count + run->offset + (size_t)i];
        double shown = 32768 * (1 + e / full);
        picture->pixels[(size_t)run->y * (size_t)picture->width + (size_t)(run->x + i)] =
            (uint16_t)fmin(65535, fmax(0, shown));
        f->residual += e * e;
        f->contrast += gain * gain * grey[i] * grey[i];
        f->slope_x += e * zx;
        f->slope_y += e * zy;
        f->slope_square += (zx * zx + zy * zy) / 2;
        if (i) {
            double before = t[i - 1] - gain * grey[i - 1] - offset;
            f->lag += e * before;
            f->pairs++;
        }
        f->count++;
    }
    free(t);
}

static void take_grain(const struct photo *reference, const struct photo *photo, const struct photo_grains *grains,
                       const struct photo_grains *tracks, size_t k, struct photo *picture)
{
    const struct shape shape = {
        .cx = grains->x_px[k], .cy = grains->y_px[k], .radius = TRACKER_SUBSET * grains->radius_px[k]};
    const struct motion motion = {tracks->x_seen_px[k] - shape.cx, tracks->y_seen_px[k] - shape.cy,
                                  tracks->angle_seen[k]};
    struct subset subset;
    struct patch patch = {0};
    struct kernel_sums sums;
    struct figures f = {0};
    double r = shape.radius + 2, x = shape.cx + motion.u, y = shape.cy + motion.v;
    if (subset_build(reference, &shape, NULL, &subset) || !subset_usable(&subset) ||
        patch_load(photo, x - r, y - r, x + r, y + r, (float)subset.mean, BSPLINE_QUINTIC, &patch))
        return;
    kernel_sums(&subset, &patch, &motion, &sums);
    double gain = sums.plane[SUBSET_GREY] / subset.energy, offset = sums.one / (double)subset.count;
    for (size_t i = 0; i < subset.run_count; i++)
        take_run(&subset, &patch, &motion, &subset.runs[i], gain, offset, picture, &f);
    double slopes = sqrt(f.residual * f.slope_square);
    printf(
        "grain %3zu at %6.0f %6.0f radius %5.1f | flags %08x ZNCC %.4f | residual %4.1f %% of the contrast, next pixel "
        "%.2f, slopes %+.3f %+.3f\n",
        k, shape.cx, shape.cy, grains->radius_px[k], (unsigned)tracks->flags[k], tracks->zncc[k],
        100 * sqrt(f.residual / f.contrast), f.lag / f.residual, f.slope_x / slopes, f.slope_y / slopes);
    subset_free(&subset);
    patch_free(&patch);
}

static int read_all(char **argv, struct photo *reference, struct photo *photo, struct photo_grains *grains)
{
    static const char *const circle[] = {"x_px", "y_px", "radius_px", "flags", NULL};
    struct photo_request any = {0};
    struct state *state = state_open(argv[3]);
    int status = state ? state_read(state, "grains", &PHOTO_GRAINS, circle, grains) : -1;
    state_close(state);
    return status || photo_read(argv[1], &any, reference) || photo_read(argv[2], &any, photo) ? -1 : 0;
}

int main(int argc, char **argv)
{
    struct photo reference = {0}, photo = {0}, picture = {0};
    struct photo_grains grains = {0};
    struct tracks tracks = {0};
    struct tracker_options options = TRACKER_DEFAULT;
    if (argc != 5)
        return fputs("bench_tracker_residual REFERENCE.tif PHOTO.tif REFERENCE.grains.hdf OUT.tif\n", stderr), 2;
    progress_silence();
    int status = read_all(argv, &reference, &photo, &grains) ||
                 track_grains(&reference, &grains, &photo, NULL, &options, &tracks);
    if (!status) {
        size_t n = (size_t)reference.width * (size_t)reference.height;
        if (photo_alloc(&picture, reference.width, reference.height))
            return 1;
        memset(picture.pixels, 0, n * sizeof *picture.pixels);
        for (size_t k = 0; k < grains.count; k++)
            if (isfinite(tracks.grains.x_seen_px[k]))
                take_grain(&reference, &photo, &grains, &tracks.grains, k, &picture);
        status = photo_write(argv[4], &picture);
    }
    if (status)
        fprintf(stderr, "bench_tracker_residual: %s\n", error_message());
    tracks_free(&tracks);
    table_free(&PHOTO_GRAINS, &grains);
    photo_free(&reference);
    photo_free(&photo);
    photo_free(&picture);
    return status ? 1 : 0;
}
