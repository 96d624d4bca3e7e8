/* What a series says of itself: the text of what was done and found, and the table of its photos. */
#ifndef FORCES_SERIES_OPTIONS_H
#define FORCES_SERIES_OPTIONS_H

#include "forces/series/series.h"

/* JSON of everything that changes numbers, and of what was found; to be freed. */
char *series_options_text(const struct force_options *options, const struct series_options *series,
                          const struct series_summary *summary);
/* FOLDER/series.csv: one line per photo, whose packing has its forces. */
int series_write_table(const char *folder, const struct packing *const *packings, size_t count,
                       const struct series_summary *summary);

#endif
