#include "pipeline/command/cli_overwrite.h"

#include <stddef.h>
#include <string.h>
#include <sys/stat.h>

static const char *const writing[] = {"--output", "--log", "--picture", "--json", "--fclib", NULL};

/* Does the word begin an option that writes? Long ones may be cut short, as argp allows. */
static int is_writing(const char *word, size_t length)
{
    for (int k = 0; length > 3 && writing[k]; k++)
        if (!strncmp(word, writing[k], length))
            return 1;
    return length == 2 && (!strncmp(word, "-o", 2) || !strncmp(word, "-p", 2));
}

/* What argv[k] names as a file: the word itself, or what follows "--option=" or "-o". */
static const char *file_of(const char *word)
{
    const char *value = !strncmp(word, "--", 2) ? strchr(word, '=') : NULL;
    if (value)
        return value + 1;
    return strlen(word) > 2 && is_writing(word, 2) ? word + 2 : word;
}

static int is_output(int k, char *const argv[])
{
    const char *word = argv[k], *file = file_of(word);
    if (file != word)
        return is_writing(word, (size_t)(file - word) - (file[-1] == '='));
    return k > 1 && is_writing(argv[k - 1], strlen(argv[k - 1]));
}

static int is_same_file(const char *a, const char *b)
{
    struct stat of_a, of_b;
    return !stat(a, &of_a) && S_ISREG(of_a.st_mode) && !stat(b, &of_b) && of_a.st_dev == of_b.st_dev &&
           of_a.st_ino == of_b.st_ino;
}

const char *cli_overwritten(int argc, char *const argv[])
{
    for (int k = 1; k < argc; k++)
        for (int other = 1; is_output(k, argv) && other < argc; other++)
            if (other != k && is_same_file(file_of(argv[k]), file_of(argv[other])))
                return file_of(argv[k]);
    return NULL;
}
