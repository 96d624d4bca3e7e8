/* The groups of a scene, each read into its part of the struct; used by scene_read.c only: 0, or -1 with an error that
 * says where. */
#ifndef PIPELINE_SCENE_GROUPS_H
#define PIPELINE_SCENE_GROUPS_H

#include "pipeline/scene/scene.h"

int scene_read_root(struct scene *scene); /* name, scale, origin, lens, gravity, loads */
int scene_read_photos(struct scene *scene);
int scene_read_frame(struct scene *scene);
int scene_read_grains(struct scene *scene);
int scene_read_drift_patches(struct scene *scene);

#endif
