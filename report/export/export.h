/* State files as the text that other programs read. Every function appends to `stream` and returns 0, or -1 with a
 * line: this kind of file has no such table (EXIT_INPUT), memory is gone. Whether the stream could be written is the
 * caller's to ask. */
#ifndef REPORT_EXPORT_H
#define REPORT_EXPORT_H

#include <stdio.h>

#include "report/states/loaded.h"

/* A table with a heading "name [unit]", one row per line, 17 digits, empty cells for NaN, flags once as a number and
 * once as names. table: "grains"; SI side also "walls" and "contacts" (with the columns of every method). */
int export_csv(const struct loaded *loaded, const char *table, FILE *stream);
/* Extended XYZ of the grains, as OVITO reads it: position and radius in m (px with y upwards), angle, flags. */
int export_xyz(const struct loaded *loaded, FILE *stream);
/* CONFnnnn of the original programs, SI side: "x y R rot NCC1 NCC2" with corners, strains and scale, as seeCONF reads
 * it. */
int export_conf(const struct loaded *loaded, FILE *stream);
/* dic_out_n.txt of the original programs, from a tracks file: 13 columns, px and rad. The reference point is whole
 * numbers there, so the motion is that of the material at the rounded centre. */
int export_dic(const struct loaded *loaded, FILE *stream);

#endif
