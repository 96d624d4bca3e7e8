/* Reading the photo side of a state and writing the network with everything that says how it came about. */
#include "contacts/files.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/state/freshness.h"
#include "pipeline/packing/packing_file.h"
#include "pipeline/files/json.h"

int photo_state_read(const char *path, struct photo_state *state)
{
    static const char *const grain_columns[] = {"x_px", "y_px", "radius_px", "flags", NULL};
    static const char *const patch_columns[] = {"kind", "name", "x_px", "y_px", "dx_px", "dy_px", "flags", NULL};
    struct state *file = state_open(path);
    *state = (struct photo_state){0};
    if (!file)
        return -1;
    int status = state_read_info(file, &state->info);
    if (status == 0)
        status = state_read(file, "grains", &PHOTO_GRAINS, grain_columns, &state->grains);
    if (status == 0 && state_has(file, "patches"))
        status = state_read(file, "patches", &PATCHES, patch_columns, &state->patches);
    state_close(file);
    if (status == 0 && strcmp(state->info.coordinates, "seen") && strcmp(state->info.coordinates, "corrected"))
        status = error_input("%s: coordinates are \"%s\", not those of a photo: give a file of findgrains or tracker",
                             path, state->info.coordinates);
    if (status)
        photo_state_free(state);
    return status;
}

void photo_state_free(struct photo_state *state)
{
    table_free(&PHOTO_GRAINS, &state->grains);
    table_free(&PATCHES, &state->patches);
    state_info_free(&state->info);
    *state = (struct photo_state){0};
}

int photos_read(char *const *paths, size_t count, struct photo_state **photos)
{
    if (!(*photos = calloc(count + 1, sizeof **photos)))
        return error_memory("further radii");
    for (size_t m = 0; m < count; m++)
        if (photo_state_read(paths[m], &(*photos)[m])) {
            photos_free(*photos, m);
            *photos = NULL;
            return -1;
        }
    return 0;
}

void photos_free(struct photo_state *photos, size_t count)
{
    for (size_t m = 0; photos && m < count; m++)
        photo_state_free(&photos[m]);
    free(photos);
}

int photo_state_is_reference(const struct photo_state *state, const struct scene *scene)
{
    if (scene->photos.given && state->info.index >= 0)
        return state->info.index == scene->photos.reference;
    return state->grains.x_ref_px == NULL;
}

static int add(cJSON *object, const char *name, double value)
{
    return cJSON_AddNumberToObject(object, name, value) != NULL;
}

char *contact_options_text(const struct contact_options *options, const struct contact_summary *summary,
                           const struct scene *scene)
{
    cJSON *object = cJSON_CreateObject();
    char *text = NULL;
    int good = object && add(object, "radius_scale", summary->radius_scale) &&
               add(object, "radius_offset_px", summary->radius_offset_px) &&
               add(object, "candidate_sigmas", options->candidate_sigmas) &&
               add(object, "frame_error_px", options->frame_error_px);
    if (good && options->radius_scale_auto)
        good = add(object, "s_radius_scale", summary->s_radius_scale);
    if (good && options->radius_offset_auto)
        good = add(object, "s_radius_offset_px", summary->s_radius_offset_px);
    if (good && isfinite(options->tolerance_px))
        good = add(object, "tolerance_px", options->tolerance_px);
    if (good && options->repair)
        good = cJSON_AddTrueToObject(object, "repair") && add(object, "promoted", (double)summary->promoted);
    if (good && summary->undecided)
        good = cJSON_AddStringToObject(object, "radii_undecided", summary->undecided) != NULL;
    if (good && summary->doubt)
        good = cJSON_AddStringToObject(object, "radii_doubtful", summary->doubt) != NULL;
    if (good && summary->loaded_overlap_px > 0)
        good = add(object, "overlap_of_loads_px", summary->loaded_overlap_px);
    if (good && !freshness_note(object, scene))
        text = json_print(object);
    cJSON_Delete(object);
    if (!text)
        error_set(EXIT_FAILED, "out of memory: options: use a machine with more memory");
    return text;
}

int contacts_write(const struct arguments *arguments, const struct scene *scene, const struct photo_state *photo,
                   const struct contact_options *options, const struct contact_summary *summary,
                   const struct packing *packing)
{
    const struct state_number numbers[] = {{"h", &summary->indeterminacy, 1}, {"mechanisms", &summary->mechanisms, 1}};
    size_t count = 0;
    const char **inputs = malloc((arguments->radii.count + 2) * sizeof *inputs);
    struct provenance provenance = PROVENANCE_DEFAULT;
    char *parameters = contact_options_text(options, summary, scene);
    if (!inputs || !parameters) {
        free(inputs);
        free(parameters);
        return inputs ? -1 : error_memory("names of the inputs");
    }
    inputs[count++] = arguments->cli.inputs.paths[0];
    if (arguments->previous)
        inputs[count++] = arguments->previous;
    for (size_t m = 0; m < arguments->radii.count; m++)
        inputs[count++] = arguments->radii.paths[m];
    provenance.stage = "contacts";
    provenance.parameters = parameters;
    provenance.scene = scene;
    provenance.input_paths = inputs;
    provenance.input_count = count;
    provenance.index = photo->info.index;
    provenance.time_s = isfinite(photo->info.time_s) ? photo->info.time_s : scene_time(scene, photo->info.index);
    provenance.coordinates = "si";
    provenance.length_m = packing->length_m;
    provenance.numbers = numbers;
    provenance.number_count = sizeof numbers / sizeof *numbers;
    memcpy(provenance.strain, packing->info.strain, sizeof provenance.strain);
    int status = packing_write(arguments->cli.output, packing, &provenance);
    free(parameters);
    free(inputs);
    return status;
}

static void log_contacts(const struct contact_summary *summary)
{
    log_event("contacts", "grains", (double)summary->grains, "unusable", (double)summary->unusable, "contacts",
              (double)summary->contacts, "wall_contacts", (double)summary->wall_contacts, "candidates",
              (double)summary->candidates, "rattlers", (double)summary->rattlers, "floating", (double)summary->floating,
              "mean_overlap_px", summary->mean_overlap_px, "h", summary->indeterminacy, "s_overlap_px",
              summary->s_overlap_px, "resting_share", summary->resting_share, "radius_scale", summary->radius_scale,
              "radius_offset_px", summary->radius_offset_px, "s_radius_scale", summary->s_radius_scale,
              "s_radius_offset_px", summary->s_radius_offset_px, "undecided", summary->undecided ? 1.0 : 0.0,
              "doubtful", summary->doubt ? 1.0 : 0.0, NULL);
}

/* Contacts that are missing, or may be: where the grains stand, and what would make them touch. */
static int doubt_contacts(const struct cli *cli, const struct contact_options *options,
                          const struct contact_summary *summary)
{
    char why[200] = "", where[200] = "no grains are near each other", how[300];
    int automatic = options->radius_scale_auto || options->radius_offset_auto;
    if (summary->undecided)
        snprintf(why, sizeof why, ", the automatic radius correction is undecided (%s)", summary->undecided);
    if (summary->near)
        snprintf(where, sizeof where, "%zu pairs are nearer than %.2g px, their median gap is %.2g px", summary->near,
                 summary->near_px, summary->gap_px);
    if (contacts_are_few(summary) && summary->gap_px > 0)
        snprintf(how, sizeof how, "if they touch, give contacts.radius_offset_px (about %.2g%s), or radius_scale",
                 summary->radius_offset_px + 0.5 * summary->gap_px, automatic ? "" : ", or \"auto\"");
    else
        snprintf(how, sizeof how, "look at the circles, give contacts.radius_offset_px or radius_scale by hand");
    return cli_doubt("%.300s: %zu contacts of %zu grains%s: %s: %s", cli->output, summary->contacts, summary->grains,
                     why, where, how);
}

/* With the correction of the radii that was found. */
static void summarise(const struct cli *cli, const struct contact_options *options,
                      const struct contact_summary *summary)
{
    char radii[100] = "";
    if (options->radius_offset_auto)
        snprintf(radii, sizeof radii, ", offset %+.3f +- %.3f px", summary->radius_offset_px,
                 summary->s_radius_offset_px);
    else if (options->radius_scale_auto)
        snprintf(radii, sizeof radii, ", radius scale %.4f +- %.4f", summary->radius_scale, summary->s_radius_scale);
    cli_summary(cli, "%zu contacts, z %.2f, %zu rattlers%s", summary->contacts, summary->z, summary->rattlers, radii);
}

int contacts_tell(const struct cli *cli, const struct contact_options *options, const struct contact_summary *summary)
{
    log_contacts(summary);
    int status = cli_flagged(cli, summary->unusable, summary->grains, "grains are without position or radius");
    if (status == 0 && (contacts_are_few(summary) || (summary->undecided && summary->near)))
        status = doubt_contacts(cli, options, summary);
    if (status == 0)
        summarise(cli, options, summary);
    return status;
}
