/* A progress bar on stderr: only when stderr is a terminal and not --quiet; steps may come from any thread. */
#ifndef PIPELINE_PROGRESS_H
#define PIPELINE_PROGRESS_H

#include <stdatomic.h>
#include <stddef.h>

struct progress {
    const char *what;
    size_t total;
    atomic_size_t done;
    atomic_long drawn_ms; /* when it was last drawn */
    double begin;
    int visible;
};

void progress_begin(struct progress *progress, const char *what, size_t total);
void progress_step(struct progress *progress);
void progress_end(struct progress *progress); /* clears the line */
void progress_silence(void);                  /* --quiet, and tests */

#endif
