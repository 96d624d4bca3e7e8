/* How a failure travels: a function returns -1 (or NULL) and leaves one line for its thread; callers may put
 * context in front of it; only a main prints it. Libraries never print and never exit.
 *
 *     if (rows < 0)
 *         return error_input("%s: %d rows: give a count of 0 or more", path, rows);
 *
 * A good line names the file, says what is wrong and what to do: "0012.tif: strip 4 is short: copy the photo again". */
#ifndef PIPELINE_ERROR_H
#define PIPELINE_ERROR_H

#include <stddef.h>

/* The exit statuses of every program (README.md). */
enum { EXIT_DONE = 0, EXIT_FAILED = 1, EXIT_USAGE = 2, EXIT_INPUT = 3, EXIT_FLAGGED = 4 };

/* Replace this thread's line. Macros, so that static analysers see the -1. */
#define error_failed(...) (error_set(EXIT_FAILED, __VA_ARGS__), -1) /* disk, memory: status 1 */
#define error_input(...) (error_set(EXIT_INPUT, __VA_ARGS__), -1)   /* bad input data: status 3 */
#define error_memory(what) (error_set(EXIT_FAILED, "out of memory: %s: use a machine with more memory", what), -1)
/* Put "context: " in front of this thread's line, keep its status. */
#define error_context(...) (error_prepend(__VA_ARGS__), -1)

void error_set(int status, const char *format, ...) __attribute__((format(printf, 2, 3)));
void error_prepend(const char *format, ...) __attribute__((format(printf, 1, 2)));
void error_clear(void);
const char *error_message(void); /* "" when nothing failed; valid until the thread's next error */
int error_status(void);          /* EXIT_DONE when nothing failed */

/* Work shared among threads: each iteration that fails calls error_share() with the number of its iteration; the
 * failure of the smallest iteration wins, so the message does not depend on the thread count. After the parallel
 * region error_collect() returns -1 with that line, or 0. */
struct error_shared {
    long iteration;
    int status;
    char message[1024];
};
#define ERROR_SHARED_NONE                                                                                              \
    {                                                                                                                  \
        -1, 0, ""                                                                                                      \
    }
void error_share(struct error_shared *shared, long iteration);
int error_collect(const struct error_shared *shared);

#endif
