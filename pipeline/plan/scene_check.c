/* Overlaps that the loads will make. A wall of length L that is pushed with F touches L / d grains of diameter d, so a
 * contact bears f = F d / L and overlaps by f / k_n: by 2 F / (L k_n) of a radius, whatever the grains are. In pixels
 * it takes their diameter; where the scene does not give the radii, grains as large as a fifth of the frame overlap
 * more than any true ones, and only what is too small even for them is told. */
#include "pipeline/plan/scene_check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "pipeline/packing/loads.h"
#include "pipeline/speak/error.h"

#define LARGEST_OF_RADIUS 0.1
#define SMALLEST_PX 1e-3
#define GRAIN_OF_FRAME 0.2 /* diameter, where it is not known */

/* ---- files ---- */

static int check_file(const struct scene *scene, const char *path)
{
    if (path && access(path, R_OK))
        return error_input("%s: names %s, which cannot be read: put it there", scene->path, path);
    return 0;
}

/* The loads of all photos, looked at together; *press is what they press with. */
static int check_loads(const struct scene *scene, struct loads_press *press)
{
    const struct scene_photos *photos = &scene->photos;
    size_t count = 0;
    int64_t *numbers = malloc((size_t)(photos->last - photos->first + 1) * sizeof *numbers);
    if (!numbers)
        return error_memory("the numbers of the photos");
    for (long k = scene_photo_next(scene, photos->first - 1); k <= photos->last; k = scene_photo_next(scene, k))
        numbers[count++] = k;
    int status = loads_check(scene->loads, numbers, count, press);
    free(numbers);
    return status;
}

/* All photos that count and are not there, in one line. */
static int check_photos(const struct scene *scene)
{
    enum { NAMED = 3 };
    const struct scene_photos *photos = &scene->photos;
    char names[1000] = "";
    long count = 0, missing = 0;
    for (long k = scene_photo_next(scene, photos->first - 1); k <= photos->last; k = scene_photo_next(scene, k)) {
        char *path = scene_photo_path(scene, k);
        if (!path)
            return -1;
        size_t length = strlen(names);
        count++;
        if (access(path, R_OK) && ++missing <= NAMED + 1)
            snprintf(names + length, sizeof names - length, "%s%.300s", missing > 1 ? ", " : "",
                     missing <= NAMED ? path : "...");
        free(path);
    }
    if (!missing)
        return 0;
    return missing == 1 ? error_input("%s: photo %s is not there or cannot be read: put it there, or name its number "
                                      "in photos.skip",
                                      scene->path, names)
                        : error_input("%s: %ld of %ld photos are not there or cannot be read (%s): put them there, or "
                                      "name their numbers in photos.skip",
                                      scene->path, missing, count, names);
}

/* ---- overlaps ---- */

static double mean_side_px(const struct scene *scene)
{
    const struct vec *corners = scene->frame.corners_px;
    double sum = 0;
    for (int k = 0; k < 4; k++)
        sum += vec_norm(vec_sub(corners[(k + 1) % 4], corners[k]));
    return sum / 4;
}

/* The key that is farthest from what rods in a frame are: decades outside of frames of 1 cm to 10 m and of 1e5 to 1e10
 * N/m; the loads where both are usual. */
static const char *suspect(double side, double kn)
{
    double scale = fmax(log10(0.01 / side), log10(side / 10)), stiffness = fmax(log10(1e5 / kn), log10(kn / 1e10));
    return fmax(scale, stiffness) <= 0 ? "loads" : scale > stiffness ? "scale_m_per_px" : "contact.kn_N_per_m";
}

static int check_overlaps(const struct scene *scene, const struct loads_press *press)
{
    const struct scene_grains *grains = &scene->grains;
    double kn = scene->contact.kn, side_px = mean_side_px(scene), side = scene->scale * side_px;
    double force = press->most * (press->per_area ? side * grains->length : 1);
    double of_radius = 2 * force / (side * kn);
    double radius_px = (grains->radius_min_px + grains->radius_max_px) / 2;
    double overlap_px = of_radius * (isnan(radius_px) ? GRAIN_OF_FRAME * side_px / 2 : radius_px);
    if (!(of_radius > 0)) /* or not known */
        return 0;
    if (of_radius > LARGEST_OF_RADIUS)
        return error_input(
            "%s: walls of %.3g m pushed with %.3g N and a stiffness of %.3g N/m make overlaps of %.2g of a "
            "radius, where 0.1 is too much: put %s right first",
            scene->path, side, force, kn, of_radius, suspect(side, kn));
    if (overlap_px >= SMALLEST_PX)
        return 0;
    error_set(EXIT_FLAGGED,
              "%s: walls of %.3g m pushed with %.3g N and a stiffness of %.3g N/m make overlaps of %.2g px%s, which no "
              "photo shows: look at %s first",
              scene->path, side, force, kn, overlap_px, isnan(radius_px) ? " at most" : "", suspect(side, kn));
    return -1;
}

int scene_check(const struct scene *scene)
{
    int series = scene->photos.pattern != NULL;
    struct loads_press press = {0};
    if (check_file(scene, scene->lens) || check_file(scene, scene->loads) ||
        (scene->loads && series && check_loads(scene, &press)) || (series && check_photos(scene)))
        return -1;
    return scene->frame.given ? check_overlaps(scene, &press) : 0;
}
