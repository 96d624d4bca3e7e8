/* The tracker's work on files: one reference, any number of photos, one file of tracks for each. */
#ifndef TRACKER_TRACK_SERIES_H
#define TRACKER_TRACK_SERIES_H

#include "tracker/follow/track_grains.h"

struct series_paths {
    const char *grains, *reference;
    const char *previous; /* tracks of the photo before the first one; NULL: none */
    char **photos;
    size_t photo_count;
    const char *output; /* a file for one photo, else a folder */
};

/* Write a file of tracks for each photo, NAME.tracks.hdf in the folder paths->output (made where it is missing), or
 * that file for one photo. *flagged, *total: rows that are not to be trusted, and all rows, summed over the photos. 0,
 * or -1 with a line: a file cannot be read, does not fit the others, or cannot be written. */
int track_series(const struct scene *scene, const struct series_paths *paths, size_t *flagged, size_t *total);

#endif
