/* The small files that people or other programs write: force records, corrections of grains, lens files, records of
 * probes. Each is read or refused with one line; nothing that could not be used is let through. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "calibration/rods/press_series.h"
#include "calibration/hertz/probe_record.h"
#include "findgrains/corrections.h"
#include "pipeline/speak/error.h"
#include "pipeline/scene/lens.h"
#include "tests/fuzz/target.h"

static void demand(int truth)
{
    if (!truth)
        abort();
}

static int refused(int failed)
{
    demand(!failed || (error_status() == EXIT_INPUT && *error_message()));
    return failed;
}

static void read_force_record(const char *path)
{
    struct force_record record;
    error_clear();
    if (refused(force_record_read(path, &record)))
        return;
    demand(record.count >= 2);
    for (size_t k = 0; k < record.count; k++)
        demand(isfinite(record.at[k]) && isfinite(record.force[k]) && (k == 0 || record.at[k] > record.at[k - 1]));
    demand(force_record_at(&record, record.at[0]) == record.force[0]);
    demand(isnan(force_record_at(&record, NAN)));
    force_record_free(&record);
}

/* One grain per line that does not begin with '#', however long the lines are. */
static void read_corrections(const char *path, size_t lines, int (*read)(const char *, struct corrections *), int added)
{
    struct corrections corrections = {0};
    error_clear();
    if (!refused(read(path, &corrections))) {
        demand(corrections.count <= lines);
        for (size_t k = 0; k < corrections.count; k++) {
            const struct correction *item = &corrections.items[k];
            demand(isfinite(item->x) && isfinite(item->y) && (added ? item->radius > 0 : item->radius == 0));
        }
    }
    corrections_free(&corrections);
}

static void read_lens(const char *path)
{
    struct lens lens;
    error_clear();
    if (refused(lens_read(path, &lens)))
        return;
    struct vec seen = lens_seen(&lens, vec(10, 20)); /* ends, whatever the numbers are */
    (void)seen;
}

/* The reader cuts off an unfinished last line and may write the first: it comes last, on this input's file. */
static void read_probe_record(const char *path)
{
    struct probe_record record;
    error_clear();
    if (refused(probe_record_open(path, "{\"packing\":1}", &record)))
        return;
    for (size_t k = 0; k < record.count; k++)
        demand(isfinite(record.rows[k].young) && record.rows[k].grain_young > 0);
    probe_record_close(&record);
}

static size_t count_lines(const uint8_t *data, size_t size)
{
    size_t lines = 0;
    for (size_t k = 0; k < size; k++)
        lines += (k == 0 || data[k - 1] == '\n') && data[k] != '#' && data[k] != '\n';
    return lines;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const char *path = fuzz_file(data, size);
    size_t lines = count_lines(data, size);
    read_force_record(path);
    read_corrections(path, lines, corrections_read_added, 1);
    read_corrections(path, lines, corrections_read_removed, 0);
    read_lens(path);
    read_probe_record(path);
    return 0;
}
