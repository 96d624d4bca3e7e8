/* Photo, scene and corrections in; table, picture and provenance out. The picture is drawn before the file is written:
 * a picture that fails leaves no file. Files that are read for their grains (--refine) count as inputs of the result.
 */
#include "findgrains/grains_of_photo.h"

#include <math.h>
#include <stdlib.h>

#include "findgrains/picture/overlay.h"
#include "findgrains/settings.h"
#include "pipeline/command/cli.h"
#include "pipeline/speak/error.h"
#include "pipeline/state/state.h"

/* Parameters: what the user said; found: what the photo told (grey levels, blur, noise, frame), as JSON text beside the
 * table. */
static int write_file(const struct photo_paths *paths, const struct scene *scene, const struct find_options *options,
                      const struct photo_grains *grains, const struct find_notes *notes)
{
    const char *const inputs[] = {paths->photo, paths->refine};
    struct provenance provenance = PROVENANCE_DEFAULT;
    char *parameters = settings_print(options), *found = settings_print_notes(notes);
    int status = -1;
    provenance.stage = "findgrains";
    provenance.coordinates = "seen";
    provenance.parameters = parameters;
    provenance.scene = scene;
    provenance.input_paths = inputs;
    provenance.input_count = paths->refine ? 2 : 1;
    provenance.index = scene_photo_index(scene, paths->photo);
    provenance.time_s = scene_time(scene, (long)provenance.index);
    struct state_writer *writer = parameters && found ? state_create(paths->output, &provenance) : NULL;
    if (writer) {
        if (state_write(writer, "grains", &PHOTO_GRAINS, grains) || state_write_text(writer, "grains", "found", found))
            state_discard(writer);
        else
            status = state_commit(writer);
    }
    free(parameters);
    free(found);
    return status;
}

/* Of a file to refine only centres and radii are needed: it may come from findgrains or the tracker. */
static int read_known(const char *path, struct photo_grains *known)
{
    static const char *const needed[] = {"x_px", "y_px", "radius_px", NULL};
    struct state *state = state_open(path);
    int status = state ? state_read(state, "grains", &PHOTO_GRAINS, needed, known) : -1;
    state_close(state);
    return status;
}

/* Search, or measure the known grains again; both write the same table. */
static int find(const struct photo_paths *paths, const struct photo *photo, const struct find_options *options,
                struct photo_grains *grains, struct find_notes *notes)
{
    struct photo_grains known = {0};
    if (paths->refine && read_known(paths->refine, &known))
        return -1;
    int status = paths->refine ? find_known_grains(photo, options, &known, grains, notes)
                               : find_grains(photo, options, grains, notes);
    table_free(&PHOTO_GRAINS, &known);
    return status ? error_context("%s", paths->photo) : 0;
}

/* Photo, grains and corrections are the caller's to free. */
static int work(const struct scene *scene, const struct photo_paths *paths, struct find_options *options,
                struct photo *photo, struct photo_grains *grains)
{
    struct find_notes notes;
    const struct photo_request request = scene_photo_request(scene);
    if (settings_read(scene, options) || photo_read(paths->photo, &request, photo) ||
        corrections_check(options->corrections, photo->width, photo->height) ||
        find(paths, photo, options, grains, &notes) ||
        (paths->picture && overlay_write(paths->picture, photo, grains, &notes)) ||
        write_file(paths, scene, options, grains, &notes))
        return -1;
    log_event("findgrains", "grains", (double)grains->count, "flagged", (double)find_count_flagged(grains), "blur_px",
              notes.blur_px, "noise", notes.noise, "window_px", notes.window_px, NULL);
    return 0;
}

static void count(const struct photo_grains *grains, struct photo_found *found)
{
    *found = (struct photo_found){grains->count, find_count_flagged(grains), NAN, NAN};
    for (size_t k = 0; k < grains->count; k++) {
        if (grains->flags[k] & GRAIN_DISTRUST)
            continue;
        found->least_px = fmin(found->least_px, grains->radius_px[k]);
        found->most_px = fmax(found->most_px, grains->radius_px[k]);
    }
}

int grains_of_photo(const struct scene *scene, const struct photo_paths *paths, struct photo_found *found)
{
    struct photo photo = {0};
    struct photo_grains grains = {0};
    struct corrections corrections = {0};
    struct find_options options = {.corrections = &corrections};
    int status = paths->added ? corrections_read_added(paths->added, &corrections) : 0;
    if (!status && paths->removed)
        status = corrections_read_removed(paths->removed, &corrections);
    if (!status)
        status = work(scene, paths, &options, &photo, &grains);
    if (!status)
        count(&grains, found);
    corrections_free(&corrections);
    table_free(&PHOTO_GRAINS, &grains);
    photo_free(&photo);
    return status;
}
