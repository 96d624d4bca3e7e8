/* The strict scanner in front of cJSON (RFC 8259), used by json.c only. */
#ifndef PIPELINE_JSON_SCAN_H
#define PIPELINE_JSON_SCAN_H

#include <stddef.h>

enum { JSON_MAX_DEPTH = 64 }; /* of groups and lists in each other */

/* Where a value stands in the text: byte offsets. Outside an object, key == value. */
struct json_place {
    size_t key, value;
};

struct json_scan {
    const char *text, *name;
    size_t length, at;
    struct json_place *places; /* of every value, in the order of the text; owned, to be freed by the caller */
    size_t count, capacity;
    int depth;
};

/* Check the whole text and collect the places of its values; -1 with "name:line:column: what: what to do". */
int json_scan(struct json_scan *scan);

/* Line and column (both from 1; columns count characters, not bytes) of a byte offset. */
void json_line_column(const char *text, size_t offset, size_t *line, size_t *column);

#endif
