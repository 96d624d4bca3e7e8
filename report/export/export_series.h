/* Several states in one text: what ParaView and OVITO read as a series. Every function appends to `stream` and returns
 * 0, or -1 with a line, like export.h. */
#ifndef REPORT_EXPORT_SERIES_H
#define REPORT_EXPORT_SERIES_H

#include <stdio.h>

#include "report/states/loaded.h"

/* One step of a LAMMPS dump: grains (id type x y z radius angle flags). */
int export_lammps(const struct loaded *loaded, FILE *stream);
/* One step of a LAMMPS "dump local": the contacts between grains as bonds, with fn and ft of a method (NULL: the
 * default one, report/states/method_choice.h; without forces: overlap only). */
int export_lammps_local(const struct loaded *loaded, const char *method, FILE *stream);
/* NAME.hdf.series for ParaView: the files with their times (the index where no time is known). They must lie in the
 * folder of `output`, because the text holds base names. */
int export_hdf_series(char *const paths[], size_t count, const char *output, FILE *stream);

#endif
