/* What the scene says to findgrains, and what goes into the file's provenance. */
#ifndef FINDGRAINS_SETTINGS_H
#define FINDGRAINS_SETTINGS_H

#include "pipeline/scene/scene.h"
#include "findgrains/find_grains.h"

/* From grains.radius_px, frame (through the lens) and findgrains.shape; leaves the corrections alone. */
int settings_read(const struct scene *scene, struct find_options *options);
/* The same as JSON text, to be freed; NULL with an error when out of memory. */
char *settings_print(const struct find_options *options);
/* What the photo told, as JSON text, to be freed. */
char *settings_print_notes(const struct find_notes *notes);

#endif
