/* What forces says when it ends: one line for each thing that a user must know, and the status. */
#ifndef FORCES_NOTES_H
#define FORCES_NOTES_H

#include "forces/add_forces.h"
#include "forces/add_series.h"
#include "pipeline/command/cli.h"

/* EXIT_FLAGGED for forces that are void, whatever --max-flagged says, and where more grains are out of balance than
 * that allows; else 0. */
int note_forces(const struct cli *cli, const struct force_request *request, const struct force_outcome *outcome);
int note_series(const struct cli *cli, const struct series_outcome *outcome);

#endif
