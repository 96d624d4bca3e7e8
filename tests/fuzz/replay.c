/* A fuzz target without libFuzzer: feeds every file of the folders and every file that are named to the target once,
 * and cut and damaged copies of it. Used as an ordinary test. */
#include <dirent.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "tests/fuzz/target.h"

static size_t runs;

static void feed(const uint8_t *data, size_t size)
{
    LLVMFuzzerTestOneInput(data, size);
    runs++;
}

/* The file itself, cut at 64 places, and with each of up to 256 bytes turned into something else. */
static void replay(const uint8_t *data, size_t size)
{
    static const uint8_t odd[] = {0, '"', '9', 0xFF};
    uint8_t *copy = malloc(size + 1);
    if (!copy)
        abort();
    feed(data, size);
    for (size_t k = 0; k < 64 && k < size; k++)
        feed(data, size * k / 64);
    for (size_t k = 0; k < 256 && k < size; k++) {
        size_t at = size <= 256 ? k : size * k / 256;
        memcpy(copy, data, size);
        copy[at] = odd[k % sizeof odd];
        feed(copy, size);
    }
    free(copy);
}

static int replay_file(const char *path)
{
    static uint8_t data[1 << 20];
    FILE *file = fopen(path, "rb");
    if (!file)
        return -1;
    size_t size = fread(data, 1, sizeof data, file);
    fclose(file);
    replay(data, size);
    return 0;
}

static int replay_path(const char *path)
{
    struct dirent **names;
    struct stat info;
    if (stat(path, &info))
        return -1;
    if (!S_ISDIR(info.st_mode))
        return replay_file(path);
    int status = 0, count = scandir(path, &names, NULL, alphasort);
    for (int k = 0; k < count; k++) {
        char joined[4096];
        snprintf(joined, sizeof joined, "%s/%s", path, names[k]->d_name);
        if (names[k]->d_name[0] != '.')
            status |= replay_path(joined);
        free(names[k]);
    }
    if (count >= 0)
        free(names);
    return count < 0 ? -1 : status;
}

int main(int argc, char **argv)
{
    for (int k = 1; k < argc; k++)
        if (replay_path(argv[k])) {
            fprintf(stderr, "%s: cannot be read\n", argv[k]);
            return 1;
        }
    printf("%zu inputs\n", runs);
    return runs > 0 ? 0 : 1;
}
