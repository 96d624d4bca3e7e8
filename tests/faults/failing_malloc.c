/* A library to be preloaded: the allocation with the number FAIL_AT fails (ENOMEM), all others do not. Allocations
 * are counted in the order in which they are made, over all threads; FAIL_COUNT names a file that gets their number at
 * the end. FAIL_OWN: only those of the program itself are counted and fail, not those of the libraries that it uses.
 * FAIL_FROM: fail from FAIL_AT on, as on a machine that has run out of memory. */
#define _GNU_SOURCE
#include <errno.h>
#include <link.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *old, size_t size);
void *__libc_memalign(size_t alignment, size_t size);

static atomic_long made, failing;
static int lasting, own_only;
static uintptr_t first_own, last_own; /* the addresses of the program's own code */

/* The first object is the program itself. */
static int find_own(struct dl_phdr_info *info, size_t size, void *data)
{
    (void)size, (void)data;
    for (int k = 0; k < info->dlpi_phnum; k++)
        if (info->dlpi_phdr[k].p_type == PT_LOAD && info->dlpi_phdr[k].p_flags & PF_X) {
            first_own = info->dlpi_addr + info->dlpi_phdr[k].p_vaddr;
            last_own = first_own + info->dlpi_phdr[k].p_memsz;
        }
    return 1;
}

__attribute__((constructor)) static void begin(void)
{
    const char *at = getenv("FAIL_AT");
    lasting = getenv("FAIL_FROM") != NULL;
    own_only = getenv("FAIL_OWN") != NULL;
    dl_iterate_phdr(find_own, NULL);
    made = 0;
    failing = at ? atol(at) : 0;
}

__attribute__((destructor)) static void end(void)
{
    long total = made;
    const char *path = getenv("FAIL_COUNT");
    failing = 0;
    FILE *file = path ? fopen(path, "w") : NULL;
    if (file) {
        fprintf(file, "%ld\n", total);
        fclose(file);
    }
}

static int fails(const void *caller)
{
    if (own_only && !((uintptr_t)caller >= first_own && (uintptr_t)caller < last_own))
        return 0;
    long number = ++made;
    if (failing == 0 || !(number == failing || (lasting && number > failing)))
        return 0;
    errno = ENOMEM;
    return 1;
}

void *malloc(size_t size)
{
    return fails(__builtin_return_address(0)) ? NULL : __libc_malloc(size);
}

void *calloc(size_t count, size_t size)
{
    return fails(__builtin_return_address(0)) ? NULL : __libc_calloc(count, size);
}

void *realloc(void *old, size_t size)
{
    return fails(__builtin_return_address(0)) ? NULL : __libc_realloc(old, size);
}

void *memalign(size_t alignment, size_t size)
{
    return fails(__builtin_return_address(0)) ? NULL : __libc_memalign(alignment, size);
}

void *aligned_alloc(size_t alignment, size_t size)
{
    return fails(__builtin_return_address(0)) ? NULL : __libc_memalign(alignment, size);
}

int posix_memalign(void **result, size_t alignment, size_t size)
{
    void *block = fails(__builtin_return_address(0)) ? NULL : __libc_memalign(alignment, size);
    if (!block)
        return ENOMEM;
    *result = block;
    return 0;
}
