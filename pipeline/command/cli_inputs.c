/* Paths are borrowed, but for those of a list file, whose text the struct owns: its lines are cut in place. */
#include "pipeline/command/cli_inputs.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/files/input_file.h"

int cli_inputs_add(struct cli_inputs *inputs, const char *path)
{
    char **paths = realloc(inputs->paths, (inputs->count + 1) * sizeof *paths);
    if (!paths)
        return error_memory("list of files");
    inputs->paths = paths;
    paths[inputs->count++] = (char *)path;
    return 0;
}

int cli_inputs_read(struct cli_inputs *inputs, const char *path)
{
    size_t room = 0;
    char *rest = NULL;
    if (!path)
        return 0;
    FILE *file = input_file_open(path, INPUT_FILE_TEXT);
    if (!file)
        return -1;
    errno = 0;
    ssize_t length = getdelim(&inputs->text, &room, '\0', file);
    int failed = length < 0 && !feof(file) ? error_failed("%s: %s: check the disk", path, strerror(errno)) : 0;
    if (length > 0 && strlen(inputs->text) < (size_t)length)
        failed = error_input("%s: a zero byte: give a list of paths, one per line", path);
    for (char *line = failed || length < 0 ? NULL : strtok_r(inputs->text, "\n", &rest); line && !failed;
         line = strtok_r(NULL, "\n", &rest))
        failed = cli_inputs_add(inputs, line);
    fclose(file);
    return failed;
}

void cli_inputs_free(struct cli_inputs *inputs)
{
    free(inputs->paths);
    free(inputs->text);
    *inputs = (struct cli_inputs){0};
}
