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

/* Tracks are named after their photos: two photos of one name, which would be one file, are refused (-1 with a line).
 */
int track_series_names(char *const *photos, size_t count);

/* What was found, for people: rows of all photos together, those that are not to be trusted, and of the medians of the
 * photos over the others the largest motion since the reference and the smallest ZNCC; NaN: none. */
struct series_found {
    size_t grains, flagged;
    double motion_px, zncc;
};

/* Write a file of tracks for each photo, NAME.tracks.hdf in the folder paths->output (made where it is missing), or
 * that file for one photo. 0,
 * or -1 with a line: a file cannot be read, does not fit the others, or cannot be written. */
int track_series(const struct scene *scene, const struct series_paths *paths, struct series_found *found);

#endif
