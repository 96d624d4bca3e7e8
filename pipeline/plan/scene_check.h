/* What can be known of a scene before any photo is read: a long run shall not end at its last photo for a file that is
 * not there, or be worth nothing for a stiffness in other units. */
#ifndef PIPELINE_SCENE_CHECK_H
#define PIPELINE_SCENE_CHECK_H

#include "pipeline/scene/scene.h"

/* 0, or -1 with a line: a file that the scene names is not there, or the loads are not those of its photos
 * (EXIT_INPUT); the overlaps that the loads make are more than a tenth of a radius (EXIT_INPUT), or less than a
 * thousandth of a pixel (EXIT_FLAGGED). Where the scene has no frame, scale, stiffness or loads nothing is said of
 * overlaps. */
int scene_check(const struct scene *scene);

#endif
