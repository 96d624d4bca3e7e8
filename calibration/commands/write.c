#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "calibration/commands/calibration_commands.h"
#include "pipeline/speak/error.h"
#include "pipeline/files/json.h"
#include "pipeline/files/new_file.h"

/* The text and a line end. 0, or -1 with an error that names the file. */
static int write_text(const char *path, const char *text)
{
    FILE *file = fopen(path, "w");
    if (!file)
        return error_failed("%s: %s", path, strerror(errno));
    int failed = fputs(text, file) < 0 || fputc('\n', file) < 0;
    failed |= fclose(file) != 0;
    return failed ? error_failed("%s: %s: is the disk full?", path, strerror(errno)) : 0;
}

int calibration_write(const char *path, cJSON *object)
{
    struct new_file file = {0};
    char *text = json_print(object);
    int status = -1;
    cJSON_Delete(object);
    if (text && new_file_begin(&file, path) == 0) {
        status = write_text(file.temporary, text);
        if (status)
            new_file_discard(&file);
        else
            status = new_file_commit(&file);
    }
    free(text);
    return status;
}

void calibration_add(cJSON *object, const char *name, double value)
{
    if (isfinite(value))
        cJSON_AddNumberToObject(object, name, value);
}

void calibration_tell(const struct cli *cli, const char *name, double value, double error)
{
    if (isfinite(error))
        cli_summary(cli, "%s %.5g +- %.2g", name, value, error);
    else
        cli_summary(cli, "%s %.5g", name, value);
}
