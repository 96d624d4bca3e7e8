/* An output never replaces an input: `findgrains a.tif -o a.tif` would cost a photo. */
#ifndef PIPELINE_CLI_OVERWRITE_H
#define PIPELINE_CLI_OVERWRITE_H

#include "pipeline/command/cli_inputs.h"

/* The first output that is the same existing regular file as another word of either list, whatever the paths look
 * like (links, ".."); NULL: none. */
const char *cli_overwritten(const struct cli_inputs *outputs, const struct cli_inputs *inputs);

#endif
