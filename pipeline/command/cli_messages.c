/* argp and getopt print to stderr, with words of the command line as they came. A word may hold anything: escapes that
 * move the cursor, or a line break and a line that looks like ours. So stderr is a stream of our own while they work,
 * with room for one whole message, which is cleaned before it is shown. */
#include "pipeline/command/cli_messages.h"

#include <string.h>
#include <unistd.h>

#include "pipeline/speak/text.h"

enum { LONGEST_MESSAGE = 1 << 14 };
static char *const *words;
static FILE *terminal;

/* The line breaks of a word are found in the text by what follows them in the word. */
static void join_lines(char *text, const char *word)
{
    for (const char *end = strchr(word, '\n'); end; end = strchr(end + 1, '\n'))
        for (char *found = end[1] ? strstr(text, end) : NULL; found; found = strstr(found, end))
            *found = '?';
}

static ssize_t write_clean(void *cookie, const char *bytes, size_t length)
{
    char text[LONGEST_MESSAGE + 1];
    size_t used = length < LONGEST_MESSAGE ? length : LONGEST_MESSAGE;
    (void)cookie;
    memcpy(text, bytes, used);
    text[used] = '\0';
    for (int k = 0; words[k]; k++)
        join_lines(text, words[k]);
    for (char *line = text, *end; line; line = end) {
        if ((end = strchr(line, '\n')))
            *end++ = '\0';
        text_print(terminal, line);
        if (end)
            fputc('\n', terminal);
    }
    return (ssize_t)used;
}

FILE *cli_messages_begin(char *const argv[])
{
    static char buffer[LONGEST_MESSAGE];
    FILE *before = stderr, *stream = fopencookie(NULL, "w", (cookie_io_functions_t){.write = write_clean});
    words = argv;
    terminal = stderr;
    if (stream && setvbuf(stream, buffer, _IOFBF, sizeof buffer) == 0)
        stderr = stream; /* glibc's is a variable; argp and getopt write there */
    return before;
}

/* The stream stays open: what was loaded in between (the C++ streams behind a profiler of OpenMP) may have kept it. */
void cli_messages_end(FILE *before)
{
    fflush(stderr);
    stderr = before;
}
