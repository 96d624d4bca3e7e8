/* The part of a scene that a stage's numbers depend on. A series is redone from the first stage whose part changed. */
#ifndef PIPELINE_SCENE_PART_H
#define PIPELINE_SCENE_PART_H

#include "pipeline/scene/scene.h"

/* JSON text without spaces, to be freed; NULL with an error. "findgrains" and "tracker" see the photos, the lens, the
 * drift patches, the frame, the grains' radii and their own section; every other stage sees all but the other
 * programs' sections. What only says how far the series goes (photos.last) is in no part, photos.skip not in
 * that of "findgrains", which sees one photo alone, the name only in that of "report". */
char *scene_part(const struct scene *scene, const char *stage);

/* The files that the stage reads because the scene names them: findgrains, tracker and contacts the lens, contacts the
 * loads. Borrowed from the scene; the number of them, at most 2. */
size_t scene_part_files(const struct scene *scene, const char *stage, const char *paths[2]);

#endif
