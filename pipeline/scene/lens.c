/* With d = seen - centre, r2 = d.d, radial = 1 + K1 r2 + K2 r2^2 + K3 r2^3 (by Horner's rule), growth = 1 + P3 r2, t
 * = (P1 (r2 + 2 dx^2) + 2 P2 dx dy, 2 P1 dx dy + P2 (r2 + 2 dy^2)):
 *
 *     corrected = centre + d radial + t growth
 *     d corrected_a / d seen_b = radial delta_ab + d_a d_b slope + growth dt_a/dd_b + 2 P3 d_b t_a
 *
 * where slope = (1/r) d radial / dr. The inverse has no closed form: Newton's method from the corrected place
 * itself, which is near, as distortions are some px. It stops where the Jacobian is no longer positive (determinant
 * and trace): there the map has folded back, and no lens sees that place. */
#include "pipeline/scene/lens.h"

#include "pipeline/files/json.h"

/* Steps; some five reach 1e-10 px for real lenses. */
enum { NEWTON_MAX = 50 };

struct vec lens_corrected(const struct lens *lens, struct vec seen)
{
    struct vec d = vec_sub(seen, lens->centre);
    double r2 = vec_dot(d, d), radial = 1 + r2 * (lens->k[0] + r2 * (lens->k[1] + r2 * lens->k[2]));
    double p1 = lens->p[0], p2 = lens->p[1], growth = 1 + lens->p[2] * r2;
    double x = d.x * radial + (p1 * (r2 + 2 * d.x * d.x) + 2 * p2 * d.x * d.y) * growth;
    double y = d.y * radial + (2 * p1 * d.x * d.y + p2 * (r2 + 2 * d.y * d.y)) * growth;
    return vec(lens->centre.x + x, lens->centre.y + y);
}

void lens_jacobian(const struct lens *lens, struct vec seen, double jacobian[2][2])
{
    struct vec d = vec_sub(seen, lens->centre);
    double r2 = vec_dot(d, d), radial = 1 + r2 * (lens->k[0] + r2 * (lens->k[1] + r2 * lens->k[2]));
    double slope = 2 * (lens->k[0] + r2 * (2 * lens->k[1] + r2 * 3 * lens->k[2])); /* d radial / d d_b = slope d_b */
    double p1 = lens->p[0], p2 = lens->p[1], p3 = lens->p[2], growth = 1 + p3 * r2;
    double tx = p1 * (r2 + 2 * d.x * d.x) + 2 * p2 * d.x * d.y, ty = 2 * p1 * d.x * d.y + p2 * (r2 + 2 * d.y * d.y);
    jacobian[0][0] = radial + slope * d.x * d.x + (6 * p1 * d.x + 2 * p2 * d.y) * growth + 2 * p3 * d.x * tx;
    jacobian[0][1] = slope * d.x * d.y + (2 * p1 * d.y + 2 * p2 * d.x) * growth + 2 * p3 * d.y * tx;
    jacobian[1][0] = slope * d.x * d.y + (2 * p1 * d.y + 2 * p2 * d.x) * growth + 2 * p3 * d.x * ty;
    jacobian[1][1] = radial + slope * d.y * d.y + (2 * p1 * d.x + 6 * p2 * d.y) * growth + 2 * p3 * d.y * ty;
}

struct vec lens_seen(const struct lens *lens, struct vec corrected)
{
    struct vec seen = corrected;
    for (int iteration = 0; iteration < NEWTON_MAX; iteration++) {
        double j[2][2];
        struct vec error = vec_sub(lens_corrected(lens, seen), corrected);
        lens_jacobian(lens, seen, j);
        double determinant = j[0][0] * j[1][1] - j[0][1] * j[1][0];
        if (!(determinant > 0 && j[0][0] + j[1][1] > 0))
            break;
        struct vec step = vec((j[1][1] * error.x - j[0][1] * error.y) / determinant,
                              (j[0][0] * error.y - j[1][0] * error.x) / determinant);
        seen = vec_sub(seen, step);
        if (vec_norm(step) < 1e-10)
            return seen;
    }
    return vec(NAN, NAN);
}

/* The members of a lens file. 0, or -1 with the place of the mistake. */
static int read_parameters(const struct json *json, struct lens *lens)
{
    /* The first five are needed; the others say where the lens comes from (calibration lens). */
    static const char *const keys[] = {"schema",   "map",        "centre_px",  "K",        "P",
                                       "size_px",  "photos",     "points",     "left_out", "rms_px",
                                       "s_map_px", "largest_px", "covariance", NULL};
    static const char *const schemas[] = {"film.lens/1", NULL}, *const maps[] = {"corrected from seen", NULL};
    const cJSON *root = json_root(json);
    double centre[2];
    int choice;
    if (!cJSON_IsObject(root))
        return json_error(json, root, "a lens file is an object {...}");
    if (json_check_keys(json, root, keys))
        return -1;
    int there[] = {json_choice(json, root, "schema", schemas, &choice), json_choice(json, root, "map", maps, &choice),
                   json_numbers(json, root, "centre_px", 2, centre), json_numbers(json, root, "K", 3, lens->k),
                   json_numbers(json, root, "P", 3, lens->p)};
    for (int k = 0; k < 5; k++) {
        if (there[k] < 0)
            return -1;
        if (there[k] == 0)
            return json_error(json, root, "'%s' is missing: a lens file needs schema, map, centre_px, K and P",
                              keys[k]);
    }
    lens->centre = vec(centre[0], centre[1]);
    return 0;
}

int lens_read(const char *path, struct lens *lens)
{
    struct json *json = json_read(path);
    if (!json)
        return -1;
    int status = read_parameters(json, lens);
    json_free(json);
    return status;
}

double lens_bend(const struct lens *lens, struct vec a, struct vec b)
{
    enum { PARTS = 16 };
    struct vec from = lens_corrected(lens, a), to = lens_corrected(lens, b), along = vec_sub(b, a);
    double length = vec_norm(along), bend = 0;
    for (int k = 1; k < PARTS && length > 0; k++) {
        struct vec straight = vec_add(from, vec_scale((double)k / PARTS, vec_sub(to, from)));
        double distance = fabs(vec_cross(along, vec_sub(lens_seen(lens, straight), a))) / length;
        bend = fmax(bend, distance);
    }
    return bend;
}
