/* Options of series: the scene's section "forces", key "series"; the text of what was done and found; the table. */
#ifndef FORCES_SERIES_OPTIONS_H
#define FORCES_SERIES_OPTIONS_H

#include "forces/series/series.h"
#include "pipeline/scene/scene.h"

/* What the scene gives; `options` keeps its values where it is silent. */
int series_options_read(const struct scene *scene, struct series_options *options);
/* JSON of everything that changes numbers, and of what was found; to be freed. */
char *series_options_text(const struct force_options *options, const struct series_options *series,
                          const struct series_summary *summary);
/* FOLDER/series.csv: one line per photo, whose packing has its forces. */
int series_write_table(const char *folder, const struct packing *const *packings, size_t count,
                       const struct series_summary *summary);

#endif
