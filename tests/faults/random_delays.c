/* A library to be preloaded: threads of OpenMP (libgomp) are held up at random when they start and whenever they ask
 * for more work, so that work is spread and finished in an order that is different each time. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

static atomic_ulong state;

/* Every fourth time up to 1 ms; 64-bit mixing of a shared counter and the clock. */
static void hold_up(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    uint64_t x = atomic_fetch_add(&state, 0x9E3779B97F4A7C15ull) + (uint64_t)now.tv_nsec;
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ull;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBull;
    if (x % 4 == 0)
        usleep((useconds_t)(x >> 32) % 1000);
}

struct region {
    void (*body)(void *);
    void *data;
};

static void delayed_body(void *data)
{
    struct region *region = data;
    hold_up();
    region->body(region->data);
}

void GOMP_parallel(void (*body)(void *), void *data, unsigned threads, unsigned flags)
{
    void (*real)(void (*)(void *), void *, unsigned, unsigned) = dlsym(RTLD_NEXT, "GOMP_parallel");
    struct region region = {body, data};
    real(delayed_body, &region, threads, flags);
}

#define LOOP(name, number)                                                                                             \
    _Bool name(number *first, number *last)                                                                            \
    {                                                                                                                  \
        static _Bool (*real)(number *, number *);                                                                      \
        if (!real)                                                                                                     \
            real = dlsym(RTLD_NEXT, #name);                                                                            \
        hold_up();                                                                                                     \
        return real(first, last);                                                                                      \
    }
LOOP(GOMP_loop_nonmonotonic_dynamic_next, long)
LOOP(GOMP_loop_nonmonotonic_guided_next, long)
LOOP(GOMP_loop_ull_nonmonotonic_dynamic_next, unsigned long long)
LOOP(GOMP_loop_ull_nonmonotonic_guided_next, unsigned long long)
