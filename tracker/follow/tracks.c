#include "tracker/follow/tracks.h"

size_t tracks_flagged(const struct tracks *tracks)
{
    size_t flagged = 0;
    for (size_t k = 0; k < tracks->grains.count; k++)
        flagged += (tracks->grains.flags[k] & GRAIN_DISTRUST) != 0;
    return flagged;
}

void tracks_free(struct tracks *tracks)
{
    table_free(&PHOTO_GRAINS, &tracks->grains);
    table_free(&PATCHES, &tracks->patches);
}
