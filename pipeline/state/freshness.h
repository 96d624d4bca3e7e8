/* Was a file made with the scene as it says now? Contacts hold the loads, the scale and the walls that the scene had
 * when they were made, and forces take them from there: another scene would be believed and not obeyed. */
#ifndef PIPELINE_FRESHNESS_H
#define PIPELINE_FRESHNESS_H

#include "pipeline/files/json.h"
#include "pipeline/scene/scene.h"
#include "pipeline/state/state.h"

/* Add the parts of the scene that contacts put into their file (scale, origin, frame, gravity) to its `parameters`, as
 * "scene". 0, or -1 when memory is gone. scene NULL: nothing. */
int freshness_note(cJSON *parameters, const struct scene *scene);

/* Refuse (-1, EXIT_INPUT, naming the key) a file of contacts whose loads, scale, origin, frame or gravity are not those
 * of the scene. Files of other stages, and what a file does not say, are taken. */
int freshness_check(const char *path, const struct state_info *info, const struct scene *scene);

#endif
