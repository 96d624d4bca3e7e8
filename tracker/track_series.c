/* The tracker on files: everything that can be refused is refused before the first photo is looked at. Photos are
 * followed one after the other; the tracks of each say where to look in the next, and are named in its file as an
 * input. A series that stops half-way leaves whole files only. */
#include "tracker/track_series.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "pipeline/command/cli.h"
#include "pipeline/speak/error.h"
#include "pipeline/files/json.h"
#include "pipeline/numbers/quantiles.h"
#include "pipeline/state/state.h"
#include "pipeline/files/read_record.h"
#include "tracker/original.h"
#include "tracker/tracker_options.h"

/* A run over several photos: what is read once, and the tracks of the photo before, from which the next one starts. */
struct series {
    const struct scene *scene;
    const struct series_paths *paths;
    struct tracker_options options;
    struct lens lens;
    char *parameters;
    struct photo reference;
    struct photo_grains grains, previous;
    int has_previous;
    struct tracker *tracker;
};

/* Grains of one photo on another as reference would be wrong by whole motions, and look well: findgrains says in its
 * file what it has read. A file that does not say so (of other programs) is taken. */
static int check_reference(const char *path, const struct state_info *info, const char *reference)
{
    char digest[65];
    int status = 1;
    if (!info->inputs || strcmp(info->stage, "findgrains"))
        return 0;
    struct json *json = json_parse(info->inputs, strlen(info->inputs), path);
    if (!json || read_record_digest(reference, digest)) {
        json_free(json);
        return -1;
    }
    const cJSON *input;
    cJSON_ArrayForEach(input, json_root(json))
    {
        const cJSON *sha256 = cJSON_GetObjectItemCaseSensitive(input, "sha256");
        if (cJSON_IsString(sha256) && !strcmp(sha256->valuestring, digest))
            status = 0;
    }
    json_free(json);
    return status ? error_input("%s: its grains were found in another photo than %s: give that photo as --reference",
                                path, reference)
                  : 0;
}

/* /grains of a file in the given coordinates; the rows that `required` names must be there. `reference`: the photo that
 * they must have been found in, or NULL. */
static int read_grains(const char *path, const char *coordinates, const char *const required[], const char *reference,
                       struct photo_grains *grains)
{
    struct state_info info = {0};
    struct state *state = state_open(path);
    if (!state)
        return -1;
    int status = state_read_info(state, &info);
    if (!status && strcmp(info.coordinates, coordinates))
        status = error_input("%s: coordinates are '%s', not '%s': give a file of %s", path, info.coordinates,
                             coordinates, strcmp(coordinates, "seen") ? "the tracker" : "findgrains");
    if (!status && reference)
        status = check_reference(path, &info, reference);
    if (!status)
        status = state_read(state, "grains", &PHOTO_GRAINS, required, grains);
    state_info_free(&info);
    state_close(state);
    return status;
}

/* Everything that can be wrong is found here, before the first photo is tracked. 0, or -1 with an error. */
static int series_open(struct series *series)
{
    static const char *const circle[] = {"x_px", "y_px", "radius_px", "flags", NULL};
    static const char *const motion[] = {"x_px", "y_px", "angle", "x_seen_px", "y_seen_px", "angle_seen", NULL};
    const struct series_paths *paths = series->paths;
    struct photo_request request = scene_photo_request(series->scene);
    if (tracker_options_read(series->scene, &series->options))
        return -1;
    if (series->scene->lens) {
        if (lens_read(series->scene->lens, &series->lens))
            return -1;
        series->options.lens = &series->lens;
    }
    series->options.keep = paths->photo_count > 1;
    series->parameters = tracker_options_print(&series->options);
    int text = original_is_text(paths->grains);
    if (!series->parameters || photo_read(paths->reference, &request, &series->reference) ||
        (text ? original_read_grains(paths->grains, &series->grains)
              : read_grains(paths->grains, "seen", circle, paths->reference, &series->grains)))
        return -1;
    if (paths->previous) {
        text = original_is_text(paths->previous);
        if (text ? original_read_motion(paths->previous, series->scene->lens || series->scene->drift_patch_count,
                                        &series->grains, &series->previous)
                 : read_grains(paths->previous, "corrected", motion, NULL, &series->previous))
            return -1;
        if (series->previous.count != series->grains.count)
            return error_input("%s: %zu grains, but %s has %zu: give tracks of the same reference", paths->previous,
                               series->previous.count, paths->grains, series->grains.count);
        series->has_previous = 1;
    }
    series->tracker = tracker_open(&series->reference, &series->grains, &series->options);
    return series->tracker ? 0 : -1;
}

/* Accepts what a failed series_open() leaves. */
static void series_close(struct series *series)
{
    tracker_close(series->tracker);
    table_free(&PHOTO_GRAINS, &series->grains);
    table_free(&PHOTO_GRAINS, &series->previous);
    photo_free(&series->reference);
    free(series->parameters);
}

/* The tracks of one photo as a state file, with its inputs: grains, reference, photo, and the tracks that it started
 * from. */
static int write_tracks(const struct series *series, const char *photo, const char *taken, const char *previous,
                        const char *path, const struct tracks *tracks)
{
    const char *inputs[4] = {series->paths->grains, series->paths->reference, photo};
    size_t input_count = 3;
    if (previous)
        inputs[input_count++] = previous;
    struct provenance provenance = PROVENANCE_DEFAULT;
    provenance.stage = "tracker";
    provenance.parameters = series->parameters;
    provenance.scene = series->scene;
    provenance.input_paths = inputs;
    provenance.input_count = input_count;
    provenance.index = scene_photo_index(series->scene, photo);
    provenance.time_s = scene_time(series->scene, provenance.index);
    provenance.taken = taken;
    provenance.coordinates = "corrected";
    struct state_writer *writer = state_create(path, &provenance);
    if (!writer)
        return -1;
    if (state_write(writer, "grains", &PHOTO_GRAINS, &tracks->grains) ||
        (tracks->patches.count && state_write(writer, "patches", &PATCHES, &tracks->patches))) {
        state_discard(writer);
        return -1;
    }
    return state_commit(writer);
}

/* Medians over the rows that can be trusted, joined with those of the photos before. */
static int count(const struct tracks *tracks, const struct photo_grains *reference, struct series_found *found)
{
    const struct photo_grains *g = &tracks->grains;
    double *motion = malloc(2 * (g->count + 1) * sizeof *motion), *zncc = motion + g->count;
    size_t n = 0;
    if (!motion)
        return error_memory("motions");
    for (size_t k = 0; k < g->count; k++) {
        if (g->flags[k] & GRAIN_DISTRUST)
            continue;
        motion[n] = hypot(g->x_seen_px[k] - reference->x_px[k], g->y_seen_px[k] - reference->y_px[k]);
        zncc[n++] = g->zncc[k];
    }
    found->grains += g->count;
    found->flagged += tracks_flagged(tracks);
    if (n) {
        found->motion_px = fmax(found->motion_px, median_of(motion, n));
        found->zncc = fmin(found->zncc, median_of(zncc, n));
    }
    free(motion);
    return 0;
}

/* One photo; its tracks become the previous ones. `previous` names the file of tracks that predicted it, or NULL. */
static int track_one(struct series *series, const char *photo_path, const char *previous, const char *output,
                     struct series_found *found)
{
    struct photo_request request = scene_photo_request(series->scene);
    struct photo photo = {0};
    struct tracks tracks = {0};
    request.width = series->reference.width;
    request.height = series->reference.height;
    if (photo_read(photo_path, &request, &photo))
        return -1;
    int status = tracker_follow(series->tracker, &photo, series->has_previous ? &series->previous : NULL, &tracks);
    if (status)
        error_prepend("%s", photo_path);
    else
        status = write_tracks(series, photo_path, photo.taken, previous, output, &tracks);
    photo_free(&photo);
    if (!status) {
        status = count(&tracks, &series->grains, found);
        log_event("photo", "grains", (double)tracks.grains.count, "flagged", (double)tracks_flagged(&tracks), NULL);
        table_free(&PHOTO_GRAINS, &series->previous);
        series->previous = tracks.grains;
        series->has_previous = 1;
        tracks.grains = (struct photo_grains){0};
    }
    tracks_free(&tracks);
    return status;
}

/* Of a name without folders, its ending left out. */
static size_t stem_length(const char *name)
{
    const char *dot = strrchr(name, '.');
    return dot && dot > name ? (size_t)(dot - name) : strlen(name);
}

static int same_stem(const char *a, const char *b)
{
    const char *x = basename(a), *y = basename(b);
    return stem_length(x) == stem_length(y) && !strncmp(x, y, stem_length(x));
}

int track_series_names(char *const *photos, size_t count)
{
    for (size_t k = 1; k < count; k++)
        for (size_t m = 0; m < k; m++)
            if (same_stem(photos[k], photos[m]))
                return error_input("%s and %s have one name and so one file of tracks: rename one, or track it alone",
                                   photos[k], photos[m]);
    return 0;
}

/* DIR/0003.tracks.hdf for photos/0003.tif; to be freed. */
static char *path_in_folder(const char *folder, const char *photo)
{
    const char *base = basename(photo);
    char *path;
    if (asprintf(&path, "%s/%.*s.tracks.hdf", folder, (int)stem_length(base), base) < 0) {
        error_set(EXIT_FAILED, "out of memory: paths: use a machine with more memory");
        return NULL;
    }
    return path;
}

static int is_folder(const char *path)
{
    struct stat status;
    return !stat(path, &status) && S_ISDIR(status.st_mode);
}

int track_series(const struct scene *scene, const struct series_paths *paths, struct series_found *found)
{
    struct series series = {.scene = scene, .paths = paths};
    *found = (struct series_found){0, 0, NAN, NAN};
    int folder = is_folder(paths->output) || paths->photo_count > 1;
    int status = series_open(&series);
    if (!status && folder && !is_folder(paths->output) && mkdir(paths->output, 0777))
        status = error_failed("%s: %s: name a folder for the tracks", paths->output, strerror(errno));
    char *before = NULL;
    for (size_t k = 0; k < paths->photo_count && !status; k++) {
        char *output = folder ? path_in_folder(paths->output, paths->photos[k]) : strdup(paths->output);
        status = output ? track_one(&series, paths->photos[k], k ? before : paths->previous, output, found) : -1;
        free(before);
        before = output;
    }
    free(before);
    series_close(&series);
    return status;
}
