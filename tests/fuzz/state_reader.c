#include "tests/fuzz/state_reader.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "pipeline/speak/error.h"
#include "pipeline/packing/packing_file.h"
#include "pipeline/packing/patches.h"

/* HDF5 1.10.8 itself keeps blocks when it meets damaged metadata. */
const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void)
{
    return "leak:libhdf5";
}

static char name[] = "/tmp/fuzz_state.XXXXXX";

static void remove_file(void)
{
    unlink(name);
}

const char *fuzz_named_file(const uint8_t *data, size_t size)
{
    static int descriptor = -1;
    if (descriptor < 0 && (descriptor = mkstemp(name)) >= 0)
        atexit(remove_file);
    if (descriptor < 0 || ftruncate(descriptor, 0) || pwrite(descriptor, data, size, 0) != (ssize_t)size)
        abort();
    return name;
}

static void demand_line(void)
{
    if (!*error_message() || error_status() == EXIT_DONE)
        abort();
}

static void read_table(const struct state *state, const char *group, const struct table_kind *kind, void *table)
{
    error_clear();
    if (state_read(state, group, kind, NULL, table))
        demand_line();
    table_free(kind, table);
}

static void read_packing(const char *path)
{
    struct packing packing;
    error_clear();
    if (packing_read(path, &packing)) {
        demand_line();
        return;
    }
    for (size_t c = 0; c < packing.contacts.count; c++) {
        struct vec branch = packing_branch(&packing, c); /* every index that was let through can be used */
        (void)branch;
    }
    packing_free(&packing);
}

void read_state_file(const char *path)
{
    struct state_info info;
    struct photo_grains photo;
    struct grains grains;
    struct contacts contacts;
    struct patches patches;
    error_clear();
    struct state *state = state_open(path);
    if (!state) {
        demand_line();
        return;
    }
    if (state_read_info(state, &info))
        demand_line();
    else
        state_info_free(&info);
    read_table(state, "grains", &PHOTO_GRAINS, &photo);
    read_table(state, "grains", &GRAINS, &grains);
    read_table(state, "contacts", &CONTACTS, &contacts);
    read_table(state, "patches", &PATCHES, &patches);
    state_close(state);
    read_packing(path);
}
