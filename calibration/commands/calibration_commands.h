/* The subcommands of `calibration`: each parses its own options and returns what cli_finish() gives. */
#ifndef CALIBRATION_COMMANDS_H
#define CALIBRATION_COMMANDS_H

#include <cjson/cJSON.h>

#include "pipeline/command/cli.h"

int command_friction(int argc, char **argv);
int command_hertz(int argc, char **argv);
int command_laws(int argc, char **argv);
int command_lens(int argc, char **argv);
int command_rescale(int argc, char **argv);
int command_scale(int argc, char **argv);
int command_settlement(int argc, char **argv);
int command_stiffness(int argc, char **argv);

enum { CALIBRATION_CHART_WIDTH = 480, CALIBRATION_CHART_HEIGHT = 380 }; /* px, of each chart of a --picture */

/* Write a calibration file (JSON, doubles with 17 digits) whole or not at all; takes the object. */
int calibration_write(const char *path, cJSON *object);

/* Add a number; one that is not finite is left out. */
void calibration_add(cJSON *object, const char *name, double value);

/* cli_summary() of one result: "name value +- error"; without the error where it is not finite. */
void calibration_tell(const struct cli *cli, const char *name, double value, double error);

#endif
