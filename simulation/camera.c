#include "simulation/camera.h"

/* vec_rotate() turns counter-clockwise with y up; seen with y down that is clockwise. */
struct vec camera_seen(const struct camera *camera, struct vec corrected)
{
    const struct view *view = &camera->view;
    double zoom = view->zoom > 0 ? view->zoom : 1;
    struct vec turned = vec_rotate(vec_sub(corrected, camera->middle), -view->angle);
    return vec_add(vec_add(camera->middle, vec_scale(zoom, turned)), vec(view->dx, view->dy));
}

struct vec camera_corrected(const struct camera *camera, struct vec seen)
{
    const struct view *view = &camera->view;
    double zoom = view->zoom > 0 ? view->zoom : 1;
    struct vec turned = vec_sub(vec_sub(seen, camera->middle), vec(view->dx, view->dy));
    return vec_add(camera->middle, vec_scale(1 / zoom, vec_rotate(turned, view->angle)));
}

void camera_local(const struct camera *camera, struct vec corrected, double *zoom, double *angle)
{
    (void)corrected;
    *zoom = camera->view.zoom > 0 ? camera->view.zoom : 1;
    *angle = camera->view.angle;
}
