/* The camera's motion is a similarity about the photo's middle, and the lens comes last, as it does in a camera: seen =
 * lens(similarity(corrected)). camera_corrected() is its exact inverse but for the iterations that lens_seen() needs.
 */
#include "simulation/render/camera.h"

#include <stddef.h>

static double zoom_of(const struct view *view)
{
    return view->zoom > 0 ? view->zoom : 1;
}

/* vec_rotate() turns counter-clockwise with y up; seen with y down that is clockwise. */
struct vec camera_seen(const struct camera *camera, struct vec corrected)
{
    const struct view *view = &camera->view;
    struct vec turned = vec_rotate(vec_sub(corrected, camera->middle), -view->angle);
    struct vec moved = vec_add(vec_add(camera->middle, vec_scale(zoom_of(view), turned)), vec(view->dx, view->dy));
    return camera->lens ? lens_seen(camera->lens, moved) : moved;
}

struct vec camera_corrected(const struct camera *camera, struct vec seen)
{
    const struct view *view = &camera->view;
    struct vec moved = camera->lens ? lens_corrected(camera->lens, seen) : seen;
    struct vec turned = vec_sub(vec_sub(moved, camera->middle), vec(view->dx, view->dy));
    return vec_add(camera->middle, vec_scale(1 / zoom_of(view), vec_rotate(turned, view->angle)));
}

/* The lens alone turns a body by its Jacobian's rotation; the similarity before it adds its own. */
void camera_local(const struct camera *camera, struct vec corrected, double *zoom, double *angle)
{
    double j[2][2] = {{1, 0}, {0, 1}}; /* moved per seen */
    if (camera->lens)
        lens_jacobian(camera->lens, camera_seen(camera, corrected), j);
    *zoom = zoom_of(&camera->view) / sqrt(j[0][0] * j[1][1] - j[0][1] * j[1][0]);
    *angle = camera->view.angle - atan2(j[0][1] - j[1][0], j[0][0] + j[1][1]);
}
