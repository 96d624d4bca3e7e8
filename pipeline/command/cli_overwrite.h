/* An output never replaces an input: `findgrains a.tif -o a.tif` would cost a photo. */
#ifndef PIPELINE_CLI_OVERWRITE_H
#define PIPELINE_CLI_OVERWRITE_H

/* The first word of the command line whose option writes (-o, --log, --picture, --json, --fclib) and that names the
 * same existing file as another word does, whatever the paths look like; NULL: none. */
const char *cli_overwritten(int argc, char *const argv[]);

#endif
