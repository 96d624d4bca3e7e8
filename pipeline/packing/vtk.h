/* The /VTKHDF group of a state file, by which ParaView opens it as it is. */
#ifndef PIPELINE_VTK_H
#define PIPELINE_VTK_H

#include "pipeline/packing/packing.h"

/* VTKHDF UnstructuredGrid 1.0. Points: the grains' centres, row by row, then one point per wall contact (where its
 * branch ends). Cells: one line per contact, in the order of /contacts, so that every column of contacts and forces
 * is a hard link in CellData (fn of method qsm: "qsm_fn"). PointData: the columns of /grains and the residuals; links
 * too when there are no wall contacts, else copies with NaN (flags: 0) on the points that are not grains.
 * To be called after the tables are written. */
int vtk_write(struct state_writer *writer, const struct packing *packing);

#endif
