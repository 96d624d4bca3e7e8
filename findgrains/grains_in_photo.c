#include "findgrains/grains_in_photo.h"

#include "findgrains/find_grains.h"
#include "findgrains/settings.h"

int grains_in_photo(const struct scene *scene, const struct photo *photo, struct photo_grains *grains)
{
    struct find_options options = FIND_OPTIONS_DEFAULT;
    return settings_read(scene, &options) || find_grains(photo, &options, grains, NULL) ? -1 : 0;
}
