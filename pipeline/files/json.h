/* Strict JSON around cJSON: what cJSON lets through is refused before it sees the text (duplicate keys, numbers that
 * are not finite, leading zeros, bad UTF-8, text after the end, depth above JSON_MAX_DEPTH). Errors carry file, line
 * and column: "scene.json:7:12: unknown key 'graivty_m_per_s2': ...". */
#ifndef PIPELINE_JSON_H
#define PIPELINE_JSON_H

#include <stddef.h>

#include <cjson/cJSON.h>

#include "pipeline/files/json_scan.h"

struct json; /* a parsed document: its name, its text (for positions) and its tree */

struct json *json_read(const char *path);
struct json *json_parse(const char *text, size_t length, const char *name);
void json_free(struct json *json); /* NULL is fine */
const cJSON *json_root(const struct json *json);

/* Always -1: "name:line:column: " of the item, then the message; status EXIT_INPUT. */
#define json_error(json, item, ...) (json_error_set(json, item, __VA_ARGS__), -1)
void json_error_set(const struct json *json, const cJSON *item, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Every key of the object must stand in the NULL-terminated list; the error suggests the nearest allowed key. */
int json_check_keys(const struct json *json, const cJSON *object, const char *const allowed[]);

/* Members. 1: there, *value set; 0: absent, *value untouched; -1: wrong type or out of range (error set). */
int json_number(const struct json *json, const cJSON *object, const char *key, double min, double max, double *value);
int json_integer(const struct json *json, const cJSON *object, const char *key, long min, long max, long *value);
int json_boolean(const struct json *json, const cJSON *object, const char *key, int *value);
int json_string(const struct json *json, const cJSON *object, const char *key, const char **value); /* borrowed */
int json_numbers(const struct json *json, const cJSON *object, const char *key, size_t count, double *values);
int json_object(const struct json *json, const cJSON *object, const char *key, const cJSON **value);
int json_array(const struct json *json, const cJSON *object, const char *key, const cJSON **value);
/* One of the NULL-terminated words; *value is its position. */
int json_choice(const struct json *json, const cJSON *object, const char *key, const char *const words[], int *value);

/* Text with 17 significant digits and no spaces, to be freed with free(); NULL when not finite or out of memory, also
 * when memory was out while a tree was built: the calls cJSON_Add...() need no check of their own. */
char *json_print(const cJSON *item);

#endif
