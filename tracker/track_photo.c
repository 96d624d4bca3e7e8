#include "tracker/track_photo.h"

#include "tracker/follow/track_grains.h"
#include "tracker/tracker_options.h"

int track_photo(const struct scene *scene, const struct photo *reference, const struct photo_grains *grains,
                const struct photo *photo, const struct photo_grains *previous, struct photo_grains *tracked,
                struct patches *patches)
{
    struct tracker_options options;
    struct lens lens;
    struct tracks tracks = {0};
    if (tracker_options_read(scene, &options) || (scene->lens && lens_read(scene->lens, &lens)))
        return -1;
    options.lens = scene->lens ? &lens : NULL;
    if (track_grains(reference, grains, photo, previous, &options, &tracks))
        return -1;
    *tracked = tracks.grains;
    *patches = tracks.patches;
    return 0;
}
