/* Names of numbered files: "photos/{index:04d}.tif" stands for photos/0000.tif, photos/0001.tif, ... Exactly one
 * {index} (no padding) or {index:0Nd} (N digits at least, N from 1 to 9), in the file's name and not in its folder; a
 * name without it stands for a single photo, of index 0.
 * Patterns are never given to printf. */
#ifndef PIPELINE_PATTERN_H
#define PIPELINE_PATTERN_H

/* NULL when the pattern has that form, else what to do about it (a constant); `only_one`: the series is photo 0. */
const char *pattern_check(const char *pattern, int only_one);
/* The name of file `index` >= 0 of a checked pattern; to be freed; NULL with an error when out of memory. */
char *pattern_format(const char *pattern, long index);
/* The index in a path whose base name fits the checked pattern; -1 when it does not. */
long pattern_index(const char *pattern, const char *path);

#endif
