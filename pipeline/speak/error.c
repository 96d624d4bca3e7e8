#include "pipeline/speak/error.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static _Thread_local char message[1024];
static _Thread_local int status = EXIT_DONE;

enum { LONGEST_LINE = 1 << 14, KEPT_BEGINNING = 300 }; /* two paths of 4096 bytes and what is said about them */

/* The new line; of one that is too long the beginning and the end, where the reason and the remedy stand. */
static void keep(const char *line)
{
    size_t length = strlen(line), head = KEPT_BEGINNING;
    if (length < sizeof message) {
        memcpy(message, line, length + 1);
        return;
    }
    while (head > 0 && (line[head] & 0xC0) == 0x80) /* between two letters of UTF-8 */
        head--;
    const char *tail = line + length - (sizeof message - 1 - KEPT_BEGINNING - 3);
    while ((*tail & 0xC0) == 0x80)
        tail++;
    memcpy(message, line, head);
    memcpy(message + head, "...", 3);
    memcpy(message + head + 3, tail, strlen(tail) + 1);
}

void error_set(int new_status, const char *format, ...)
{
    char line[LONGEST_LINE]; /* the arguments may point into the old message */
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    keep(line);
    status = new_status;
}

void error_prepend(const char *format, ...)
{
    char line[LONGEST_LINE + sizeof message + 2];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(line, LONGEST_LINE, format, arguments);
    va_end(arguments);
    size_t length = strlen(line);
    memcpy(line + length, ": ", 2);
    memcpy(line + length + 2, message, strlen(message) + 1);
    keep(line);
}

void error_clear(void)
{
    message[0] = '\0';
    status = EXIT_DONE;
}

const char *error_message(void)
{
    return message;
}

int error_status(void)
{
    return status;
}

void error_share(struct error_shared *shared, long iteration)
{
#pragma omp critical(error_share)
    if (shared->iteration < 0 || iteration < shared->iteration) {
        shared->iteration = iteration;
        shared->status = status;
        memcpy(shared->message, message, sizeof message);
    }
}

int error_collect(const struct error_shared *shared)
{
    if (shared->iteration < 0)
        return 0;
    error_set(shared->status, "%s", shared->message);
    return -1;
}
