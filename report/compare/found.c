/* The attribute "found" of /grains holds, as JSON, what findgrains found by itself; radii come from the rows, so
 * that a range for the scene covers every grain that is trusted. Neither is a setting until a person has pasted it
 * into the scene. */
#include "report/compare/found.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/packing/grains.h"
#include "pipeline/files/json.h"
#include "pipeline/state/state.h"

/* [x, y] in px. */
static int read_corner(const struct json *json, const cJSON *item, struct vec *corner)
{
    const cJSON *x = cJSON_GetArrayItem(item, 0), *y = cJSON_GetArrayItem(item, 1);
    if (!cJSON_IsNumber(x) || !cJSON_IsNumber(y))
        return json_error(json, item, "not a corner: give a file of findgrains");
    *corner = vec(x->valuedouble, y->valuedouble);
    return 0;
}

/* The member "frame", if there: four corners in the order of the scene, and the radius of the corner discs, both px. */
static int read_frame(const struct json *json, struct found *found)
{
    const cJSON *frame, *list;
    int there = json_object(json, json_root(json), "frame", &frame);
    if (there <= 0)
        return there;
    if (json_array(json, frame, "corners_px", &list) != 1 || cJSON_GetArraySize(list) != 4)
        return json_error(json, frame, "not four corners: give a file of findgrains");
    for (int k = 0; k < 4; k++)
        if (read_corner(json, cJSON_GetArrayItem(list, k), &found->corners[k]))
            return -1;
    found->has_frame = 1;
    return json_number(json, frame, "corner_radius_px", 0, 1e9, &found->corner_radius) < 0 ? -1 : 0;
}

/* Smallest and largest radius of trusted grains; NaN stays where there is none (fmin and fmax pass over NaN). */
static int read_radii(const struct state *state, struct found *found)
{
    static const char *const needed[] = {"radius_px", "flags", NULL};
    struct photo_grains grains = {0};
    int status = state_read(state, "grains", &PHOTO_GRAINS, needed, &grains);
    for (size_t k = 0; status == 0 && k < grains.count; k++)
        if (!(grains.flags[k] & GRAIN_DISTRUST)) {
            found->least_radius = fmin(found->least_radius, grains.radius_px[k]);
            found->largest_radius = fmax(found->largest_radius, grains.radius_px[k]);
        }
    table_free(&PHOTO_GRAINS, &grains);
    return status;
}

/* Whether the scene gave the frame stands in the file's parameters. */
static int read_given(const struct state *state, const char *path, struct found *found)
{
    struct state_info info = {0};
    const cJSON *frame;
    struct json *json = NULL;
    int status = state_read_info(state, &info);
    if (status == 0 && info.parameters) {
        json = json_parse(info.parameters, strlen(info.parameters), path);
        status = json ? json_object(json, json_root(json), "frame", &frame) : -1;
        found->frame_given = status == 1;
    }
    json_free(json);
    state_info_free(&info);
    return status < 0 ? -1 : 0;
}

/* 0, or -1 with an error that names the file: also when some other program wrote it. */
static int read_state(const struct state *state, const char *path, struct found *found)
{
    char text[4096];
    int status = state_read_text(state, "grains", "found", text, sizeof text);
    if (status == 1)
        return error_input("%s: does not say what findgrains found: give a file of findgrains", path);
    struct json *json = status == 0 ? json_parse(text, strlen(text), path) : NULL;
    status = json && !read_frame(json, found) && !read_radii(state, found) ? read_given(state, path, found) : -1;
    json_free(json);
    return status;
}

int found_read(const char *path, struct found *found)
{
    *found = (struct found){.least_radius = NAN, .largest_radius = NAN};
    struct state *state = state_open(path);
    int status = state ? read_state(state, path, found) : -1;
    state_close(state);
    return status;
}

/* Hundredths of a px are finer than any corner is found, and make the text one that people can read. */
static void print_frame(const struct found *found, FILE *stream)
{
    fputs("\"frame\": {\"corners_px\": [", stream);
    for (int k = 0; k < 4; k++)
        fprintf(stream, "%s[%.2f, %.2f]", k ? ", " : "", found->corners[k].x, found->corners[k].y);
    fputc(']', stream);
    if (found->corner_radius > 0)
        fprintf(stream, ", \"corner_radius_px\": %.1f", found->corner_radius);
    fputc('}', stream);
}

char *found_print(const struct found *found)
{
    char *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    int has_radii = found->least_radius <= found->largest_radius;
    if (stream && found->has_frame)
        print_frame(found, stream);
    if (stream && found->has_frame && has_radii)
        fputs(",\n", stream);
    if (stream && has_radii)
        fprintf(stream, "\"grains\": {\"radius_px\": [%.0f, %.0f]}", fmax(1, floor(found->least_radius)),
                ceil(found->largest_radius));
    if (stream && fclose(stream) == 0)
        return text;
    error_set(EXIT_FAILED, "out of memory: what was found: use a machine with more memory");
    return NULL;
}
