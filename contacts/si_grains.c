/* From px to metres: x = scale (px - origin), y up. Radii are averaged over the photos that were given, corrected
 * (scale, offset), and magnified where the lens is not undone yet. Errors of a reference position and those of the
 * motion since stay apart: the first are the same in all states of a series and drop out of motions, not out of
 * overlaps. */
#include "contacts/si_grains.h"

#include <stdlib.h>

#include "contacts/radii/average.h"
#include "pipeline/speak/error.h"

/* One optional photo-side column times a factor into a column of the new table. */
static int copy_scaled(struct grains *grains, const char *name, double *const *to, const double *from, double factor)
{
    if (!from)
        return 0;
    if (table_add(&GRAINS, grains, name))
        return -1;
    for (size_t k = 0; k < grains->count; k++)
        (*to)[k] = factor * from[k];
    return 0;
}

static int copy_errors(const struct contact_input *input, struct grains *grains)
{
    const struct photo_grains *photo = input->grains;
    double scale = input->scene->scale;
    /* A file of findgrains holds one photo: its errors are those of the reference positions, nothing has moved. */
    int tracked = photo->x_ref_px != NULL;
    const double *s_x_ref = tracked ? photo->s_x_ref : photo->s_x, *s_y_ref = tracked ? photo->s_y_ref : photo->s_y;
    if (copy_scaled(grains, "s_x_ref", &grains->s_x_ref, s_x_ref, scale) ||
        copy_scaled(grains, "s_y_ref", &grains->s_y_ref, s_y_ref, scale) ||
        copy_scaled(grains, "s_radius", &grains->s_radius, photo->s_radius, scale) ||
        copy_scaled(grains, "shape_c", &grains->shape_c, photo->shape_c, scale) ||
        copy_scaled(grains, "shape_s", &grains->shape_s, photo->shape_s, scale) ||
        copy_scaled(grains, "s_shape", &grains->s_shape, photo->s_shape, scale))
        return -1;
    return copy_scaled(grains, "s_x", &grains->s_x, photo->s_x, tracked ? scale : 0) ||
           copy_scaled(grains, "s_y", &grains->s_y, photo->s_y, tracked ? scale : 0) ||
           copy_scaled(grains, "s_angle", &grains->s_angle, photo->s_angle, tracked ? 1 : 0);
}

static void set_mass(const struct scene *scene, struct grains *grains)
{
    double density = scene->grains.density, length = scene->grains.length;
    double per_area = isfinite(density) ? density * (isfinite(length) ? length : 1) * M_PI : 1;
    for (size_t k = 0; k < grains->count; k++) {
        double r2 = grains->radius[k] * grains->radius[k];
        grains->mass[k] = per_area * r2;
        grains->inertia[k] = 0.5 * grains->mass[k] * r2;
    }
}

static int set_weight(const struct scene *scene, struct grains *grains)
{
    if (scene->gravity.x == 0 && scene->gravity.y == 0)
        return 0;
    if (!isfinite(scene->grains.density))
        return scene_lacks(scene, "grains.density_kg_m3", "contacts needs it for the weight of the grains");
    if (table_add(&GRAINS, grains, "load_x") || table_add(&GRAINS, grains, "load_y") ||
        table_add(&GRAINS, grains, "load_m"))
        return -1;
    for (size_t k = 0; k < grains->count; k++) {
        grains->load_x[k] = grains->mass[k] * scene->gravity.x;
        grains->load_y[k] = grains->mass[k] * scene->gravity.y;
        grains->load_m[k] = 0;
    }
    return 0;
}

/* Position and radius with the lens undone, px; the radius by the local magnification. */
static struct vec corrected(const struct contact_input *input, struct vec px, double *radius_px)
{
    double j[2][2];
    if (!input->lens || !input->seen)
        return px;
    lens_jacobian(input->lens, px, j);
    *radius_px *= sqrt(fabs(j[0][0] * j[1][1] - j[0][1] * j[1][0]));
    return lens_corrected(input->lens, px);
}

/* An error that is no number would count as none, and the grain as exact; one below 0 as its opposite. */
static int errors_are_numbers(const struct grains *grains, size_t k)
{
    const double *const errors[] = {grains->s_x,     grains->s_y,      grains->s_x_ref,
                                    grains->s_y_ref, grains->s_radius, grains->s_shape};
    for (size_t c = 0; c < sizeof errors / sizeof *errors; c++)
        if (!(column_or_zero(errors[c], k) >= 0) || isinf(column_or_zero(errors[c], k)))
            return 0;
    return isfinite(column_or_zero(grains->shape_c, k)) && isfinite(column_or_zero(grains->shape_s, k));
}

static void place(const struct contact_input *input, const struct contact_options *options, struct grains *grains)
{
    const struct photo_grains *photo = input->grains;
    double scale = input->scene->scale;
    for (size_t k = 0; k < grains->count; k++) {
        double radius_px = options->radius_scale * grains->radius[k] / scale + options->radius_offset_px;
        struct vec at = corrected(input, vec(photo->x_px[k], photo->y_px[k]), &radius_px);
        at = scene_metres(input->scene, at);
        grains->x[k] = at.x;
        grains->y[k] = at.y;
        grains->radius[k] = scale * radius_px;
        grains->angle[k] = photo->angle && photo->x_ref_px ? photo->angle[k] : 0;
        grains->flags[k] = photo->flags ? photo->flags[k] : 0;
        if (!isfinite(at.x + at.y) || !isfinite(radius_px) || radius_px <= 0 || !errors_are_numbers(grains, k))
            grains->flags[k] |= GRAIN_NOT_FINITE;
    }
}

int si_grains(const struct contact_input *input, const struct contact_options *options, struct grains *grains)
{
    static const char *const columns[] = {"x", "y", "radius", "angle", "mass", "inertia", "flags", NULL};
    if (!isfinite(input->scene->scale))
        return scene_lacks(input->scene, "scale_m_per_px", "contacts needs it to turn pixels into metres");
    if (table_alloc(&GRAINS, grains, input->grains->count, columns))
        return -1;
    if (copy_errors(input, grains) || average_rims(input, grains)) {
        table_free(&GRAINS, grains);
        return -1;
    }
    place(input, options, grains);
    set_mass(input->scene, grains);
    if (set_weight(input->scene, grains)) {
        table_free(&GRAINS, grains);
        return -1;
    }
    return 0;
}

int si_reference(const struct contact_input *input, struct vec **reference)
{
    const struct photo_grains *photo = input->grains;
    *reference = NULL;
    if (!photo->x_ref_px || !photo->y_ref_px || input->is_reference)
        return 0;
    if (!(*reference = malloc((photo->count + 1) * sizeof **reference)))
        return error_memory("reference positions");
    for (size_t k = 0; k < photo->count; k++)
        (*reference)[k] = scene_metres(input->scene, vec(photo->x_ref_px[k], photo->y_ref_px[k]));
    return 0;
}
