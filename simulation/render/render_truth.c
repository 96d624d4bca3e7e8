/* The truth is what is drawn, not what the packing says: faces with their shapes, turned by the grains' angles;
 * contacts of the faces as drawn; positions as the moved camera behind its lens sees them. */
#include "simulation/render/render_truth.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/numbers/random.h"
#include "pipeline/files/json.h"

/* ---- the picture ---- */

/* Faces of rods are not quite round: r(phi) = R + c cos 2 phi + s sin 2 phi with c, s normal, so that the mean of
 * (longest - shortest) / R = 2 hypot(c, s) / R is the ellipticity (Rayleigh: mean = sigma sqrt(pi / 2)). */
static void draw_shape(const struct optics *optics, size_t k, double radius, double *c, double *s)
{
    uint64_t key = random_bits(random_bits(optics->seed, 0x7368617065u), k);
    double sigma = 0.5 * radius * optics->ellipticity / 1.2533141373155003;
    *c = sigma * random_normal(key, 0);
    *s = sigma * random_normal(key, 1);
}

static int project_grains(const struct grains *from, const struct optics *optics, const struct scene *scene,
                          struct photo_grains *to)
{
    static const char *const columns[] = {"x_px",      "y_px",      "radius_px",  "angle", "shape_c", "shape_s",
                                          "x_seen_px", "y_seen_px", "angle_seen", "flags", NULL};
    if (table_alloc(&PHOTO_GRAINS, to, from->count, columns))
        return -1;
    for (size_t k = 0; k < from->count; k++) {
        struct vec px = scene_pixels(scene, vec(from->x[k], from->y[k]));
        to->x_px[k] = px.x;
        to->y_px[k] = px.y;
        to->radius_px[k] = from->radius[k] / scene->scale;
        to->angle[k] = column_or_zero(from->angle, k);
        to->shape_c[k] = column_or_zero(from->shape_c, k) / scene->scale;
        to->shape_s[k] = column_or_zero(from->shape_s, k) / scene->scale;
        if (!from->shape_c && optics->ellipticity > 0)
            draw_shape(optics, k, to->radius_px[k], &to->shape_c[k], &to->shape_s[k]);
    }
    return 0;
}

/* The frame as the walls of the packing have it; 0 when one of the four is missing. */
static int frame_of_walls(const struct walls *walls, const struct scene *scene, struct vec corners[4])
{
    static const char *const round[] = {"left", "top", "right", "bottom"};
    struct vec start[4], along[4];
    for (int k = 0; k < 4; k++) {
        long w = walls_find(walls, round[k]);
        if (w < 0)
            return 0;
        start[k] = scene_pixels(scene, vec(walls->x0[w], walls->y0[w]));
        along[k] = vec_sub(scene_pixels(scene, vec(walls->x1[w], walls->y1[w])), start[k]);
    }
    for (int k = 0; k < 4; k++)
        corners[k] = vec_meet(start[k], along[k], start[(k + 1) % 4], along[(k + 1) % 4]);
    return isfinite(corners[0].x + corners[1].x + corners[2].x + corners[3].x);
}

static void set_frame(const struct packing *packing, const struct scene *scene, struct picture *picture)
{
    const struct walls *walls = &packing->walls;
    picture->framed = frame_of_walls(walls, scene, picture->corners);
    if (!picture->framed && scene->frame.given) {
        memcpy(picture->corners, scene->frame.corners_px, sizeof picture->corners);
        picture->framed = 1;
    }
    for (size_t w = 0; w < walls->count && picture->hinge_count < 4; w++)
        if (wall_is_disc(walls, w)) {
            struct vec px = scene_pixels(scene, vec(walls->x0[w], walls->y0[w]));
            picture->hinges[picture->hinge_count++] = (struct drawn_disc){px.x, px.y, walls->radius[w] / scene->scale};
        }
}

/* A marker moves with the middle and the direction of its wall's inner line, from the scene's corners to those now. */
static void move_marker(const struct scene *scene, const struct vec corners[4], struct plate *plate)
{
    static const char *const sides[] = {"top", "right", "bottom", "left"};
    for (int k = 0; k < 4; k++) {
        if (strcmp(plate->name, sides[k]))
            continue;
        struct vec a = scene->frame.corners_px[k], b = scene->frame.corners_px[(k + 1) % 4];
        struct vec c = corners[k], d = corners[(k + 1) % 4];
        struct vec along = vec_sub(b, a), now = vec_sub(d, c);
        double turn = atan2(vec_cross(along, now), vec_dot(along, now)); /* clockwise as seen: y is down */
        struct vec arm = vec_sub(vec(plate->x_ref, plate->y_ref), vec_scale(0.5, vec_add(a, b)));
        struct vec moved = vec_add(vec_scale(0.5, vec_add(c, d)), vec_rotate(arm, turn));
        plate->x = moved.x;
        plate->y = moved.y;
        plate->angle = -turn;
    }
}

/* A flat thing on the backdrop, at the rectangle's middle, px. */
static struct plate plate_of(enum plate_kind kind, const char *name, const struct rect *rect)
{
    double x = 0.5 * (rect->x0 + rect->x1), y = 0.5 * (rect->y0 + rect->y1);
    struct plate plate = {.kind = kind, .x = x, .y = y, .x_ref = x, .y_ref = y};
    plate.width = fabs(rect->x1 - rect->x0);
    plate.height = fabs(rect->y1 - rect->y0);
    snprintf(plate.name, sizeof plate.name, "%s", name);
    return plate;
}

static int make_plates(const struct scene *scene, const struct optics *optics, struct picture *picture,
                       struct plate **plates)
{
    size_t papers = scene->drift_patch_count, followed = papers + scene->frame.marker_count;
    *plates = calloc(followed + optics->label_count + 1, sizeof **plates);
    if (!*plates)
        return error_memory("paper, markers and labels");
    for (size_t k = 0; k < papers; k++)
        (*plates)[k] = plate_of(PLATE_PAPER, "paper", &scene->drift_patches[k]);
    for (size_t k = papers; k < followed; k++) {
        const struct scene_marker *marker = &scene->frame.markers[k - papers];
        (*plates)[k] = plate_of(PLATE_MARKER, marker->wall, &marker->rect);
        move_marker(scene, picture->corners, &(*plates)[k]);
    }
    for (size_t k = 0; k < optics->label_count; k++)
        (*plates)[followed + k] = plate_of(PLATE_LABEL, "label", &optics->labels[k]);
    picture->plates = *plates;
    picture->plate_count = followed + optics->label_count;
    return 0;
}

/* Where the plates are: paper as the camera sees it, markers without the camera's motion. */
static int describe_plates(const struct picture *picture, size_t followed, struct patches *patches)
{
    static const char *const columns[] = {"kind", "name", "x_px", "y_px", "dx_px", "dy_px", "angle", "flags", NULL};
    struct camera camera = picture_camera(picture);
    if (table_alloc(&PATCHES, patches, followed, columns))
        return -1;
    for (size_t k = 0; k < followed; k++) {
        const struct plate *plate = &picture->plates[k];
        struct vec at = vec(plate->x, plate->y);
        double zoom = 1, turn = 0;
        if (plate->kind == PLATE_PAPER) {
            camera_local(&camera, at, &zoom, &turn);
            at = camera_seen(&camera, at);
        }
        snprintf(patches->kind[k], NAME_LENGTH, "%s", plate->kind == PLATE_PAPER ? "drift" : "wall");
        memcpy(patches->name[k], plate->name, NAME_LENGTH);
        patches->x_px[k] = at.x;
        patches->y_px[k] = at.y;
        patches->dx_px[k] = at.x - plate->x_ref;
        patches->dy_px[k] = at.y - plate->y_ref;
        patches->angle[k] = plate->angle + turn;
    }
    return 0;
}

/* Where the camera sees each grain: px and rad as in the photo. */
static void describe_seen(const struct picture *picture, struct photo_grains *grains)
{
    struct camera camera = picture_camera(picture);
    for (size_t k = 0; k < grains->count; k++) {
        struct vec at = vec(grains->x_px[k], grains->y_px[k]), seen = camera_seen(&camera, at);
        double zoom, turn;
        camera_local(&camera, at, &zoom, &turn);
        grains->x_seen_px[k] = seen.x;
        grains->y_seen_px[k] = seen.y;
        grains->angle_seen[k] = grains->angle[k] + turn;
    }
}

int picture_of(const struct packing *packing, const struct optics *optics, const struct scene *scene, long index,
               const struct lens *lens, struct photo_truth *truth, struct plate **plates, struct picture *picture)
{
    if (!(scene->scale > 0))
        return scene_lacks(scene, "scale_m_per_px", "render needs the size of a pixel");
    if (scene->photos.width <= 0 || scene->photos.height <= 0)
        return scene_lacks(scene, "photos.size_px", "render needs the size of the photo");
    if (project_grains(&packing->grains, optics, scene, &truth->grains))
        return -1;
    *picture = (struct picture){.width = scene->photos.width,
                                .height = scene->photos.height,
                                .index = index,
                                .grains = &truth->grains,
                                .lens = lens,
                                .view = optics_view(optics, index, scene->photos.given ? scene->photos.reference : 0)};
    truth->view = picture->view;
    set_frame(packing, scene, picture);
    describe_seen(picture, &truth->grains);
    return make_plates(scene, optics, picture, plates) ||
                   describe_plates(picture, scene->drift_patch_count + scene->frame.marker_count, &truth->patches)
               ? -1
               : 0;
}

/* ---- contacts of the faces ---- */

/* Rim radius of grain k in direction n (y up), m. */
static double rim(const struct grains *si, const struct photo_grains *px, double scale, size_t k, struct vec n)
{
    double twice = 2 * (atan2(n.y, n.x) - px->angle[k]);
    return si->radius[k] + scale * (px->shape_c[k] * cos(twice) + px->shape_s[k] * sin(twice));
}

/* A contact in the plane of the rods' ends, as a photo shows it. */
struct face_contact {
    size_t i, j;
    struct vec n;
    double radius, overlap; /* of grain i along n */
};

static int touch_grains(const struct grains *si, const struct photo_grains *px, double scale, struct face_contact *c)
{
    struct vec branch = vec(si->x[c->j] - si->x[c->i], si->y[c->j] - si->y[c->i]);
    double reach = 1.2 * (si->radius[c->i] + si->radius[c->j]), d = vec_norm(branch);
    if (!(fabs(branch.y) < reach && d < reach && d > 0))
        return 0;
    c->n = vec_scale(1 / d, branch);
    c->radius = rim(si, px, scale, c->i, c->n);
    c->overlap = c->radius + rim(si, px, scale, c->j, vec_scale(-1, c->n)) - d;
    return c->overlap > 0;
}

static int touch_wall(const struct packing *packing, const struct photo_grains *px, double scale, size_t w,
                      struct face_contact *c)
{
    const struct grains *si = &packing->grains;
    struct vec to_wall = vec(packing->walls.x0[w] - si->x[c->i], packing->walls.y0[w] - si->y[c->i]);
    c->n = wall_is_disc(&packing->walls, w) ? vec_unit(to_wall) : vec_scale(-1, wall_inward(&packing->walls, w));
    c->radius = rim(si, px, scale, c->i, c->n);
    c->overlap = c->radius + packing->walls.radius[w] - vec_dot(to_wall, c->n);
    return c->overlap > 0;
}

static void put_contact(const struct grains *si, const struct face_contact *c, int wall, struct contacts *contacts)
{
    size_t row = contacts->count++;
    contacts->i[row] = (int64_t)c->i;
    contacts->j[row] = (int64_t)c->j;
    contacts->nx[row] = c->n.x;
    contacts->ny[row] = c->n.y;
    contacts->x[row] = si->x[c->i] + (c->radius - 0.5 * c->overlap) * c->n.x;
    contacts->y[row] = si->y[c->i] + (c->radius - 0.5 * c->overlap) * c->n.y;
    contacts->overlap[row] = c->overlap;
    contacts->flags[row] = wall ? CONTACT_WALL : 0;
}

/* Count (contacts == NULL) or store. */
static size_t walk_contacts(const struct packing *packing, const struct photo_grains *px, double scale,
                            struct contacts *contacts)
{
    const struct grains *si = &packing->grains;
    size_t found = 0;
    for (size_t i = 0; i < si->count; i++) {
        struct face_contact c = {.i = i};
        for (c.j = i + 1; c.j < si->count; c.j++)
            if (touch_grains(si, px, scale, &c)) {
                found++;
                if (contacts)
                    put_contact(si, &c, 0, contacts);
            }
        for (size_t w = 0; w < packing->walls.count; w++) {
            c.j = si->count + w;
            if (touch_wall(packing, px, scale, w, &c)) {
                found++;
                if (contacts)
                    put_contact(si, &c, 1, contacts);
            }
        }
    }
    return found;
}

int face_contacts(const struct packing *packing, const struct photo_grains *grains, double scale,
                  struct contacts *contacts)
{
    static const char *const columns[] = {"i", "j", "nx", "ny", "x", "y", "overlap", "flags", NULL};
    if (table_alloc(&CONTACTS, contacts, walk_contacts(packing, grains, scale, NULL), columns))
        return -1;
    contacts->count = 0;
    walk_contacts(packing, grains, scale, contacts);
    return 0;
}

/* ---- the file ---- */

void photo_truth_free(struct photo_truth *truth)
{
    table_free(&PHOTO_GRAINS, &truth->grains);
    table_free(&CONTACTS, &truth->contacts);
    table_free(&PATCHES, &truth->patches);
}

char *photo_truth_path(const char *photo_path)
{
    size_t length = strlen(photo_path);
    const char *dot = strrchr(photo_path, '.'), *slash = strrchr(photo_path, '/');
    if (dot && (!slash || dot > slash + 1))
        length = (size_t)(dot - photo_path);
    char *path = NULL;
    if (asprintf(&path, "%.*s.photo-truth.hdf", (int)length, photo_path) < 0) {
        (void)error_memory("a file name");
        return NULL;
    }
    return path;
}

/* The item becomes the object's, or goes when either is not there. */
static int add_item(cJSON *object, const char *name, cJSON *item)
{
    if (object && item && cJSON_AddItemToObject(object, name, item))
        return 1;
    cJSON_Delete(item);
    return 0;
}

/* What changed the numbers: the optics, the scale, the size. A text that lacks one of them for want of memory would be
 * believed: NULL then. */
static char *parameters_text(const struct scene *scene)
{
    const cJSON *section = scene_section(scene, "optics");
    double origin[2] = {scene->origin_px.x, scene->origin_px.y};
    cJSON *object = cJSON_CreateObject();
    int whole = add_item(object, "optics", section ? cJSON_Duplicate(section, 1) : cJSON_CreateObject()) &&
                cJSON_AddNumberToObject(object, "scale_m_per_px", scene->scale) &&
                add_item(object, "origin_px", cJSON_CreateDoubleArray(origin, 2));
    char *text = whole ? json_print(object) : NULL;
    cJSON_Delete(object);
    if (!text)
        (void)error_memory("the parameters of a photo");
    return text;
}

int photo_truth_write(const char *path, const struct photo_truth *truth, const struct scene *scene, long index,
                      const char *input_path)
{
    struct provenance provenance = PROVENANCE_DEFAULT;
    char *parameters = parameters_text(scene);
    if (!parameters)
        return -1;
    provenance.stage = "render";
    provenance.parameters = parameters;
    provenance.input_paths = &input_path;
    provenance.input_count = 1;
    provenance.index = index;
    provenance.time_s = scene_time(scene, index);
    provenance.coordinates = "corrected";
    const double camera[6] = {truth->view.dx,   truth->view.dy,   truth->view.angle,
                              truth->view.zoom, truth->view.blur, truth->view.brightness};
    struct state_writer *writer = state_create(path, &provenance);
    free(parameters);
    if (!writer)
        return -1;
    if (state_write(writer, "grains", &PHOTO_GRAINS, &truth->grains) ||
        state_write(writer, "patches", &PATCHES, &truth->patches) ||
        state_write_numbers(writer, "patches", "camera", camera, 6) ||
        state_write(writer, "contacts", &CONTACTS, &truth->contacts)) {
        state_discard(writer);
        return -1;
    }
    return state_commit(writer);
}
