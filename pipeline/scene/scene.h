/* scene.json (docs/scene.md): the one place where a user describes an experiment. What the scene leaves out is not
 * modelled: absent numbers are NaN, absent paths NULL, absent lists empty, absent groups have given == 0. The sections
 * "findgrains", "tracker", "contacts", "forces", "simulation" and "optics" belong to their programs, which read their
 * own keys through scene_section(). */
#ifndef PIPELINE_SCENE_H
#define PIPELINE_SCENE_H

#include <stdint.h>

#include "pipeline/laws/contact_law.h"
#include "pipeline/numbers/geometry.h"
#include "pipeline/scene/photo.h"

struct cJSON; /* of pipeline/files/json.h */
struct json;

struct rect {
    double x0, y0, x1, y1; /* px */
};

struct scene_photos {
    int given;
    char *pattern; /* "photos/{index:04d}.tif", relative to the scene's folder */
    long first, last, reference;
    long *skip; /* numbers of photos that are not there or are bad, ascending; never the reference */
    size_t skip_count;
    double interval_s; /* NaN: not given */
    int width, height; /* 0: not given */
    enum photo_channel channel;
    int block; /* photos per block of a series run; default 20 */
};

enum { CORNER_TOP_LEFT, CORNER_TOP_RIGHT, CORNER_BOTTOM_RIGHT, CORNER_BOTTOM_LEFT };

struct scene_marker {
    char wall[8]; /* "top" "bottom" "left" "right" */
    struct rect rect;
};

struct scene_frame {
    int given;
    struct vec corners_px[4]; /* where the inner wall lines meet, in the order of the enum above; as seen */
    double corner_radius_px;  /* 0: no corner discs */
    struct scene_marker *markers;
    size_t marker_count;
};

struct scene_grains {
    double radius_min_px, radius_max_px; /* NaN: estimated from the photo */
    double density, length;              /* kg/m3, m; NaN: not given */
};

struct scene {
    char *path, *folder, *name;
    struct json *json;
    struct scene_photos photos;
    double scale; /* m/px; NaN: not given */
    struct vec origin_px;
    char *lens; /* path of the lens file, joined to the folder; NULL: no lens */
    struct rect *drift_patches;
    size_t drift_patch_count;
    struct scene_frame frame;
    struct scene_grains grains;
    int contact_given;
    struct contact_law contact;
    struct vec gravity; /* m/s2; zero when not given */
    char *loads;        /* path, joined to the folder; NULL: no loads */
};

/* What a scene names lies in the scene's own folder: absolute paths, "..", and symbolic links that lead out of it are
 * refused (EXIT_INPUT), so that a scene from somebody else reads nothing of yours. After scene_allow_outside()
 * (--allow-outside) this process takes them. */
void scene_allow_outside(void);
int scene_outside_allowed(void); /* 1 after that, else 0 */
/* Read and check a whole scene: every key, its type and range. 0, or -1 with file, line and column (EXIT_INPUT), or out
 * of memory; then nothing is to be freed. */
int scene_read(const char *path, struct scene *scene);
void scene_free(struct scene *scene); /* accepts a zeroed struct */

/* The scene's section of that name, borrowed, or NULL when it is left out. */
const struct cJSON *scene_section(const struct scene *scene, const char *name);
/* Error (status EXIT_INPUT) that names the missing key and the stage that needs it. */
int scene_lacks(const struct scene *scene, const char *key, const char *why);
/* Path of photo `index`, joined to the scene's folder; to be freed by free(). NULL with a line: no pattern, or out of
 * memory. */
char *scene_photo_path(const struct scene *scene, long index);
/* Index of the photo whose base name matches the pattern; -1 when none does. */
long scene_photo_index(const struct scene *scene, const char *path);
/* The photos that count, those of photos.skip left out: the first one after `index`, which may be first - 1;
 * last + 1 when there is none. */
long scene_photo_next(const struct scene *scene, long index);
int scene_photo_skipped(const struct scene *scene, int64_t index);
/* Seconds since the first photo; NaN when the interval or the index is not known. */
double scene_time(const struct scene *scene, long index);
/* Size (px) and channel that the scene demands of its photos, for photo_read(). */
struct photo_request scene_photo_request(const struct scene *scene);

/* The one place where pixels become metres: x = scale (x_px - origin_x), y = -scale (y_px - origin_y). */
struct vec scene_metres(const struct scene *scene, struct vec px);
struct vec scene_pixels(const struct scene *scene, struct vec m);
/* A path of the scene, joined to the scene's folder; to be freed; NULL with an error when out of memory. */
char *scene_join(const struct scene *scene, const char *relative);

#endif
