#include "pipeline/state/state_storage.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "pipeline/speak/error.h"

/* One chunk of a small column may be larger than the column; no more chunks than any program makes of its rows. */
enum { CHUNK_ROWS_SPARE = 1 << 20, MOST_CHUNKS = 100000, CHECKSUM_BYTES = 4 };

struct chunks {
    hsize_t rows, count; /* of one chunk; of them in the file */
    size_t bytes;        /* of one chunk, as numbers */
    int deflated;
    size_t before_deflate; /* bytes that filters ahead of gzip have added */
    size_t after;          /* bytes that filters behind it have added; all of them without gzip */
};

/* ---- filters ---- */

/* 0: filters that are understood; -1: others. */
static int look_at_filters(hid_t properties, struct chunks *chunks)
{
    int count = H5Pget_nfilters(properties);
    for (int k = 0; k < count; k++) {
        unsigned flags, setting;
        size_t values = 0;
        H5Z_filter_t filter = H5Pget_filter2(properties, (unsigned)k, &flags, &values, NULL, 0, NULL, &setting);
        if (filter == H5Z_FILTER_DEFLATE && !chunks->deflated) {
            chunks->deflated = 1;
            chunks->before_deflate = chunks->after;
            chunks->after = 0;
        } else if (filter == H5Z_FILTER_FLETCHER32) {
            chunks->after += CHECKSUM_BYTES;
        } else if (filter != H5Z_FILTER_SHUFFLE) {
            return -1;
        }
    }
    return count < 0 ? -1 : 0;
}

/* Does a gzip stream become just `wanted` bytes? */
static int inflates_to(const unsigned char *stream, size_t length, size_t wanted)
{
    unsigned char part[16384];
    z_stream z = {.next_in = (z_const Bytef *)stream, .avail_in = (uInt)length};
    size_t have = 0;
    int status = length <= UINT32_MAX ? inflateInit(&z) : Z_MEM_ERROR;
    if (status != Z_OK)
        return 0;
    while (status == Z_OK && have <= wanted) {
        z.next_out = part;
        z.avail_out = sizeof part;
        status = inflate(&z, Z_NO_FLUSH);
        have += sizeof part - z.avail_out;
    }
    inflateEnd(&z);
    return status == Z_STREAM_END && have == wanted;
}

/* 1: the chunk is as long as it has to be once gzip is undone. */
static int chunk_inflates(hid_t dataset, const hsize_t *offset, size_t stored, const struct chunks *chunks)
{
    uint32_t mask = 0;
    unsigned char *bytes = malloc(stored + 1);
    int good = bytes && stored > chunks->after && H5Dread_chunk(dataset, H5P_DEFAULT, offset, &mask, bytes) >= 0 &&
               inflates_to(bytes, stored - chunks->after, chunks->bytes + chunks->before_deflate);
    free(bytes);
    return good;
}

/* ---- chunks ---- */

/* 1: no chunk is missing, has skipped a filter, or has another length than its rows need: HDF5 would return fill
 * values or read past the end. */
static int every_chunk_is_whole(hid_t dataset, hid_t space, const struct chunks *chunks)
{
    for (hsize_t k = 0; k < chunks->count; k++) {
        hsize_t offset = 0, stored = 0;
        haddr_t address;
        unsigned mask = 1;
        if (H5Dget_chunk_info(dataset, space, k, &offset, &mask, &address, &stored) < 0 || mask != 0)
            return 0;
        if (chunks->deflated ? !chunk_inflates(dataset, &offset, (size_t)stored, chunks)
                             : stored != chunks->bytes + chunks->after)
            return 0;
    }
    return 1;
}

/* NULL: all is well; else what is wrong and what to do. */
static const char *check_chunks(hid_t dataset, hid_t properties, hsize_t rows)
{
    struct chunks chunks = {0};
    hid_t type = H5Dget_type(dataset), space = H5Dget_space(dataset);
    unsigned options = 0;
    const char *wrong = NULL;
    size_t size = type >= 0 ? H5Tget_size(type) : 0;
    int known = size > 0 && space >= 0 && H5Pget_chunk(properties, 1, &chunks.rows) == 1 && chunks.rows > 0;
    hsize_t needed = known ? (rows - 1) / chunks.rows + 1 : 0;
    if (needed > MOST_CHUNKS || (chunks.rows > rows && chunks.rows > CHUNK_ROWS_SPARE))
        wrong = "has absurd chunks: write it with chunks of up to its rows";
    else if (!known || H5Dget_num_chunks(dataset, space, &chunks.count) < 0 ||
             H5Pget_chunk_opts(properties, &options) < 0 || chunks.count != needed)
        wrong = "was never written completely: make the file again";
    else if (options != 0 || look_at_filters(properties, &chunks))
        wrong = "has a filter that is not known here: write it with gzip, shuffle, Fletcher32 or none";
    if (!wrong) {
        chunks.bytes = (size_t)chunks.rows * size;
        if (!every_chunk_is_whole(dataset, space, &chunks))
            wrong = "is damaged (a chunk is not as long as it should be): make the file again";
    }
    if (type >= 0)
        H5Tclose(type);
    if (space >= 0)
        H5Sclose(space);
    return wrong;
}

/* HDF5 1.10 copies rows x size bytes out of a compact column, whatever room its record has. */
static int block_is_whole(hid_t dataset, hsize_t rows)
{
    hid_t type = H5Dget_type(dataset);
    size_t size = type >= 0 ? H5Tget_size(type) : 0;
    if (type >= 0)
        H5Tclose(type);
    return size > 0 && H5Dget_storage_size(dataset) / size >= rows;
}

/* Space that was set aside when the file was made (by parallel HDF5) may never have been written. */
static const char *check_block(hid_t dataset, hid_t properties, hsize_t rows)
{
    H5D_space_status_t status;
    H5D_alloc_time_t when;
    int written = H5Dget_space_status(dataset, &status) >= 0 && status == H5D_SPACE_STATUS_ALLOCATED &&
                  H5Pget_alloc_time(properties, &when) >= 0 &&
                  (when != H5D_ALLOC_TIME_EARLY || H5Pget_layout(properties) == H5D_COMPACT);
    if (!written)
        return "was never written completely: make the file again";
    return block_is_whole(dataset, rows) ? NULL : "is shorter than its rows: make the file again";
}

int state_check_storage(const struct state *state, hid_t dataset, const char *group, const char *name, hsize_t rows)
{
    hid_t properties = H5Dget_create_plist(dataset);
    H5D_layout_t layout = properties >= 0 ? H5Pget_layout(properties) : H5D_LAYOUT_ERROR;
    int inside = layout == H5D_COMPACT || layout == H5D_CHUNKED ||
                 (layout == H5D_CONTIGUOUS && H5Pget_external_count(properties) == 0);
    const char *wrong = !inside                 ? "is stored outside the file: put the data into the file"
                        : rows == 0             ? NULL
                        : layout == H5D_CHUNKED ? check_chunks(dataset, properties, rows)
                                                : check_block(dataset, properties, rows);
    if (properties >= 0)
        H5Pclose(properties);
    return wrong ? error_input("%s: column /%s/%s %s", state->path, group, name, wrong) : 0;
}
