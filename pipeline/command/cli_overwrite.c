/* Two paths are one file when device and inode agree. Only files that exist can be overwritten, and only regular ones
 * lose something: /dev/null may be named as often as one likes. */
#include "pipeline/command/cli_overwrite.h"

#include <sys/stat.h>

static int is_same_file(const char *a, const char *b)
{
    struct stat of_a, of_b;
    return !stat(a, &of_a) && S_ISREG(of_a.st_mode) && !stat(b, &of_b) && of_a.st_dev == of_b.st_dev &&
           of_a.st_ino == of_b.st_ino;
}

const char *cli_overwritten(const struct cli_inputs *outputs, const struct cli_inputs *inputs)
{
    for (size_t k = 0; k < outputs->count; k++) {
        for (size_t other = 0; other < inputs->count; other++)
            if (is_same_file(outputs->paths[k], inputs->paths[other]))
                return outputs->paths[k];
        for (size_t other = 0; other < k; other++)
            if (is_same_file(outputs->paths[k], outputs->paths[other]))
                return outputs->paths[k];
    }
    return NULL;
}
