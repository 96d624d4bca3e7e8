/* The tracker follows a lattice of discs over the whole plate; its standard errors are the weights of the fit. A disc
 * that is flagged in a photo is not seen there. */
#include "calibration/lens/lens_plate.h"

#include <stdlib.h>

#include "pipeline/speak/error.h"

/* Discs side by side, a fifth of a radius apart, up to the border. */
static int grid_make(const struct photo *photo, double radius, struct photo_grains *grid)
{
    static const char *const names[] = {"x_px", "y_px", "radius_px", "flags", NULL};
    double pitch = 2.2 * radius, border = radius + 4;
    size_t across = (size_t)fmax(0, floor((photo->width - 2 * border) / pitch) + 1);
    size_t down = (size_t)fmax(0, floor((photo->height - 2 * border) / pitch) + 1);
    if (table_alloc(&PHOTO_GRAINS, grid, across * down, names))
        return -1;
    for (size_t k = 0; k < across * down; k++) {
        grid->x_px[k] = border + pitch * (double)(k % across);
        grid->y_px[k] = border + pitch * (double)(k / across);
        grid->radius_px[k] = radius;
    }
    return 0;
}

static int plate_alloc(const struct photo *photo, const struct photo_grains *grid, size_t photos, struct plate *plate)
{
    size_t n = grid->count;
    plate->reference = malloc((n + 1) * sizeof *plate->reference);
    plate->seen = malloc((n * photos + 1) * sizeof *plate->seen);
    plate->sigma = malloc((n * photos + 1) * sizeof *plate->sigma);
    if (!plate->reference || !plate->seen || !plate->sigma)
        return error_memory("the points of the plate");
    for (size_t k = 0; k < n; k++)
        plate->reference[k] = vec(grid->x_px[k], grid->y_px[k]);
    plate->points = (struct lens_points){.count = n,
                                         .photos = photos,
                                         .reference = plate->reference,
                                         .seen = plate->seen,
                                         .sigma = plate->sigma,
                                         .width = photo->width,
                                         .height = photo->height};
    return 0;
}

/* Points that are flagged are not seen. */
static void take(const struct photo_grains *tracks, size_t photo, struct plate *plate)
{
    const double least = 1e-4; /* px */
    for (size_t k = 0; k < tracks->count; k++) {
        size_t m = photo * tracks->count + k;
        plate->seen[m] = vec(tracks->x_seen_px[k], tracks->y_seen_px[k]);
        plate->sigma[m] =
            tracks->flags[k] & GRAIN_DISTRUST ? NAN : fmax(least, hypot(tracks->s_x[k], tracks->s_y[k]) / sqrt(2));
    }
}

static int follow_all(struct tracker *tracker, const struct photo *reference, char *const *photos, struct plate *plate)
{
    struct photo_request request = {.width = reference->width, .height = reference->height};
    for (size_t p = 0; p < plate->points.photos; p++) {
        struct photo photo = {0};
        struct tracks tracks = {0};
        if (photo_read(photos[p], &request, &photo))
            return -1;
        int status = tracker_follow(tracker, &photo, NULL, &tracks);
        photo_free(&photo);
        if (status)
            return error_context("%s", photos[p]);
        take(&tracks.grains, p, plate);
        tracks_free(&tracks);
    }
    return 0;
}

int plate_follow(const char *reference_path, char *const *photos, size_t count, const struct plate_options *options,
                 struct plate *plate)
{
    struct tracker_options tracking = TRACKER_DEFAULT;
    struct photo_request any = {0};
    struct photo reference = {0};
    struct photo_grains grid = {0};
    struct tracker *tracker = NULL;
    *plate = (struct plate){0};
    tracking.subset = 1;
    tracking.search_px = options->search_px;
    tracking.search_deg = options->search_deg;
    tracking.keep = 1;
    int status = photo_read(reference_path, &any, &reference);
    int side = reference.width < reference.height ? reference.width : reference.height;
    double radius = options->radius_px > 0 ? options->radius_px : fmax(16, side / 60.0);
    if (!status)
        status = grid_make(&reference, radius, &grid);
    if (!status)
        status = plate_alloc(&reference, &grid, count, plate);
    if (!status)
        status = (tracker = tracker_open(&reference, &grid, &tracking)) ? 0 : -1;
    if (!status)
        status = follow_all(tracker, &reference, photos, plate);
    tracker_close(tracker);
    table_free(&PHOTO_GRAINS, &grid);
    photo_free(&reference);
    return status;
}

void plate_free(struct plate *plate)
{
    free(plate->reference);
    free(plate->seen);
    free(plate->sigma);
    *plate = (struct plate){0};
}
