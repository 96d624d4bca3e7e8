#include "pipeline/speak/progress.h"

#include <stdio.h>
#include <time.h>
#include <unistd.h>

enum { REDRAW_MS = 100, BAR_WIDTH = 30 };

static atomic_int silent;

static double now_s(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void progress_silence(void)
{
    atomic_store(&silent, 1);
}

/* One write per picture, so that lines from other threads cannot cut it. */
static void draw(const struct progress *progress, size_t done)
{
    char bar[BAR_WIDTH + 1], line[200];
    double share = progress->total ? (double)done / (double)progress->total : 0;
    share = share < 1 ? share : 1;
    int filled = (int)(share * BAR_WIDTH);
    for (int k = 0; k < BAR_WIDTH; k++)
        bar[k] = k < filled ? '#' : '.';
    bar[BAR_WIDTH] = '\0';
    double left = share > 0 ? (now_s() - progress->begin) * (1 - share) / share : 0;
    int length = snprintf(line, sizeof line, "\r%.40s [%s] %zu of %zu, %.0f s left \033[K", progress->what, bar, done,
                          progress->total, left);
    if (write(STDERR_FILENO, line, (size_t)length) < 0)
        return; /* a bar that cannot be drawn is no failure */
}

void progress_begin(struct progress *progress, const char *what, size_t total)
{
    progress->what = what;
    progress->total = total;
    atomic_init(&progress->done, 0);
    atomic_init(&progress->drawn_ms, 0);
    progress->begin = now_s();
    progress->visible = !atomic_load(&silent) && isatty(STDERR_FILENO);
}

void progress_step(struct progress *progress)
{
    size_t done = atomic_fetch_add(&progress->done, 1) + 1;
    if (!progress->visible)
        return;
    long now = (long)((now_s() - progress->begin) * 1000), drawn = atomic_load(&progress->drawn_ms);
    /* Of several threads that find the picture old, the one that sets the new time draws. */
    if (now - drawn >= REDRAW_MS && atomic_compare_exchange_strong(&progress->drawn_ms, &drawn, now))
        draw(progress, done);
}

void progress_end(struct progress *progress)
{
    static const char clear[] = "\r\033[K";
    if (progress->visible && write(STDERR_FILENO, clear, sizeof clear - 1) < 0)
        return;
    progress->visible = 0;
}
