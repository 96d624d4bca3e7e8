#include "pipeline/error.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static _Thread_local char message[1024];
static _Thread_local int status = EXIT_DONE;

void error_set(int new_status, const char *format, ...)
{
    char line[sizeof message]; /* the arguments may point into the old message */
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    memcpy(message, line, sizeof line);
    status = new_status;
}

void error_prepend(const char *format, ...)
{
    char context[sizeof message];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(context, sizeof context, format, arguments);
    va_end(arguments);
    size_t length = strlen(context);
    if (length + 3 > sizeof message)
        return;
    memmove(message + length + 2, message, sizeof message - length - 2);
    memcpy(message, context, length);
    memcpy(message + length, ": ", 2);
    message[sizeof message - 1] = '\0';
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
