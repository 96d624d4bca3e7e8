/* Reading JSON: the strict scanner (json_scan.h) sees the text first and notes where each value stands; then cJSON
 * makes the tree; then keys are looked through for repetitions, which cJSON would let pass (the first would win).
 * Places and items come in the same order, that of the text, so an item is found among the places by counting: slow,
 * but only an error asks for it. */
#include "pipeline/files/json.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/files/input_file.h"
#include "pipeline/files/json_scan.h"

/* 64 MB: what people and programs write is far smaller. */
enum { JSON_MAX_BYTES = 1 << 26 };

struct json {
    char *name, *text;
    size_t length;
    struct json_place *places; /* of every value, in the order of the text, which is the tree's order */
    size_t place_count;
    cJSON *root;
};

/* ---- reading ---- */

/* The next item of a walk through the whole tree in the order of the text; NULL after the last. `stack` holds the way
 * up: at most JSON_MAX_DEPTH items. */
static const cJSON *next_item(const cJSON *item, const cJSON *stack[], size_t *depth)
{
    if (item->child) {
        stack[(*depth)++] = item;
        return item->child;
    }
    while (!item->next) {
        if (*depth == 0)
            return NULL;
        item = stack[--*depth];
    }
    return *depth ? item->next : NULL;
}

/* Where an item stands: items are counted in the order of the text. NULL for an item of another tree. */
static const struct json_place *find_place(const struct json *json, const cJSON *wanted)
{
    const cJSON *stack[JSON_MAX_DEPTH + 1];
    size_t depth = 0, count = 0;
    for (const cJSON *item = json->root; item && count < json->place_count; item = next_item(item, stack, &depth)) {
        if (item == wanted)
            return &json->places[count];
        count++;
    }
    return NULL;
}

/* "name:line:column: message" for the item's value, or for its key; without a place, "name: message". */
static void error_at(const struct json *json, const cJSON *item, int at_key, const char *message)
{
    size_t line, column;
    const struct json_place *place = find_place(json, item);
    if (!place) {
        error_set(EXIT_INPUT, "%s: %s", json->name, message);
        return;
    }
    json_line_column(json->text, at_key ? place->key : place->value, &line, &column);
    error_set(EXIT_INPUT, "%s:%zu:%zu: %s", json->name, line, column, message);
}

void json_error_set(const struct json *json, const cJSON *item, const char *format, ...)
{
    char message[800];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    error_at(json, item, 0, message);
}

/* The same, but the place is that of the item's key. */
__attribute__((format(printf, 3, 4))) static int key_error(const struct json *json, const cJSON *item,
                                                           const char *format, ...)
{
    char message[800];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    error_at(json, item, 1, message);
    return -1;
}

/* A member and its number in the text, for sorting. */
struct keyed {
    const cJSON *item;
    size_t order;
};

/* For qsort(): by key, then by place in the text, so that of equal keys the later one is the repetition. */
static int compare_keys(const void *a, const void *b)
{
    const struct keyed *x = a, *y = b;
    int order = strcmp(x->item->string, y->item->string);
    return order ? order : (x->order > y->order) - (x->order < y->order);
}

/* Keys are compared after their escapes are undone. The first repetition in the text is the one that is reported. */
static int check_duplicates_in(const struct json *json, const cJSON *object)
{
    size_t count = 0;
    for (const cJSON *item = object->child; item; item = item->next)
        count++;
    if (count < 2)
        return 0;
    struct keyed *keys = calloc(count, sizeof *keys);
    if (!keys)
        return error_memory(json->name);
    count = 0;
    for (const cJSON *item = object->child; item; item = item->next, count++)
        keys[count] = (struct keyed){item, count};
    qsort(keys, count, sizeof *keys, compare_keys);
    const struct keyed *repeated = NULL;
    for (size_t k = 1; k < count; k++)
        if (!strcmp(keys[k - 1].item->string, keys[k].item->string) && (!repeated || keys[k].order < repeated->order))
            repeated = &keys[k];
    int status = repeated ? key_error(json, repeated->item, "the key '%s' stands here a second time: keep one of them",
                                      repeated->item->string)
                          : 0;
    free(keys);
    return status;
}

static int check_duplicates(const struct json *json)
{
    const cJSON *stack[JSON_MAX_DEPTH + 1];
    size_t depth = 0;
    for (const cJSON *item = json->root; item; item = next_item(item, stack, &depth))
        if (cJSON_IsObject(item) && check_duplicates_in(json, item))
            return -1;
    return 0;
}

/* From json->text to json->root. 0, or -1 with an error; json_free() frees what was made either way. */
static int parse(struct json *json)
{
    struct json_scan scan = {.text = json->text, .name = json->name, .length = json->length};
    int status = json_scan(&scan);
    json->places = scan.places;
    json->place_count = scan.count;
    if (status)
        return -1;
    json->root = cJSON_ParseWithLengthOpts(json->text, json->length + 1, NULL, 1);
    if (!json->root)
        return error_memory(json->name);
    return check_duplicates(json);
}

struct json *json_parse(const char *text, size_t length, const char *name)
{
    struct json *json = calloc(1, sizeof *json);
    if (json && (json->name = strdup(name)) && (json->text = malloc(length + 1))) {
        memcpy(json->text, text, length);
        json->text[length] = '\0';
        json->length = length;
        if (parse(json) == 0)
            return json;
    } else {
        error_set(EXIT_FAILED, "out of memory: %s: use a machine with more memory", name);
    }
    json_free(json);
    return NULL;
}

/* The rest of a stream; NULL with an error. */
static char *read_stream(FILE *file, const char *path, size_t *length)
{
    char *text = NULL;
    size_t room = 0;
    *length = 0;
    do {
        room = 2 * room + 4096;
        char *larger = room <= JSON_MAX_BYTES ? realloc(text, room) : NULL;
        if (!larger) {
            if (room > JSON_MAX_BYTES)
                error_set(EXIT_INPUT, "%s: more than 64 megabytes of JSON: is this the right file?", path);
            else
                error_set(EXIT_FAILED, "out of memory: %s: use a machine with more memory", path);
            free(text);
            return NULL;
        }
        text = larger;
        *length += fread(text + *length, 1, room - *length, file);
    } while (*length == room);
    if (ferror(file)) {
        error_set(EXIT_INPUT, "%s: %s: name a file that can be read", path, strerror(errno));
        free(text);
        return NULL;
    }
    return text;
}

/* The file in memory, *length bytes and no zero at its end; to be freed; NULL with an error. */
static char *read_whole(const char *path, size_t *length)
{
    FILE *file = input_file_open(path, JSON_MAX_BYTES);
    if (!file)
        return NULL;
    char *text = read_stream(file, path, length);
    fclose(file);
    return text;
}

struct json *json_read(const char *path)
{
    size_t length;
    char *text = read_whole(path, &length);
    struct json *json = text ? json_parse(text, length, path) : NULL;
    free(text);
    return json;
}

void json_free(struct json *json)
{
    if (!json)
        return;
    cJSON_Delete(json->root);
    free(json->places);
    free(json->text);
    free(json->name);
    free(json);
}

const cJSON *json_root(const struct json *json)
{
    return json->root;
}

/* ---- keys ---- */

/* Letters; longer words are like nothing. */
enum { LONGEST_KEY = 64 };

/* Edits (insert, delete, replace) that turn a into b (Levenshtein 1966, the row-by-row table of Wagner and Fischer
 * 1974). */
static size_t edit_distance(const char *a, const char *b)
{
    size_t row[LONGEST_KEY + 1], m = strlen(a), n = strlen(b);
    if (m > LONGEST_KEY || n > LONGEST_KEY)
        return LONGEST_KEY;
    for (size_t j = 0; j <= n; j++)
        row[j] = j;
    for (size_t i = 1; i <= m; i++) {
        size_t diagonal = row[0];
        row[0] = i;
        for (size_t j = 1; j <= n; j++) {
            size_t best = diagonal + (a[i - 1] != b[j - 1]);
            diagonal = row[j];
            if (row[j] + 1 < best)
                best = row[j] + 1;
            if (row[j - 1] + 1 < best)
                best = row[j - 1] + 1;
            row[j] = best;
        }
    }
    return row[n];
}

/* The nearest word when it is near enough to be a slip of the finger, or the same but for its end (a unit left out);
 * else NULL. */
static const char *nearest(const char *text, const char *const words[])
{
    const char *best = NULL;
    size_t least = strlen(text) / 3 > 2 ? strlen(text) / 3 : 2;
    for (size_t k = 0; words[k]; k++) {
        size_t distance = edit_distance(text, words[k]);
        if (strlen(text) >= 2 && !strncmp(words[k], text, strlen(text)))
            distance = 0;
        if (distance < least || (distance == least && !best)) {
            least = distance;
            best = words[k];
        }
    }
    return best;
}

/* "a, b, c" of a word list, cut where the buffer ends. */
static void join_words(const char *const words[], char *buffer, size_t size)
{
    size_t used = 0;
    buffer[0] = '\0';
    for (size_t k = 0; words[k] && used < size; k++)
        used += (size_t)snprintf(buffer + used, size - used, "%s%s", k ? ", " : "", words[k]);
}

int json_check_keys(const struct json *json, const cJSON *object, const char *const allowed[])
{
    if (!cJSON_IsObject(object))
        return json_error(json, object, "a group is expected here: write {\"key\": value}");
    for (const cJSON *item = object->child; item; item = item->next) {
        size_t k = 0;
        while (allowed[k] && strcmp(allowed[k], item->string))
            k++;
        if (allowed[k])
            continue;
        const char *guess = nearest(item->string, allowed);
        if (guess)
            return key_error(json, item, "unknown key '%.80s': did you mean '%s'?", item->string, guess);
        char list[500];
        join_words(allowed, list, sizeof list);
        return key_error(json, item, "unknown key '%.80s': the keys here are: %s", item->string, list);
    }
    return 0;
}

/* ---- members ---- */

/* The member, or NULL when it is left out; the case of letters counts. */
static const cJSON *member(const cJSON *object, const char *key)
{
    return object ? cJSON_GetObjectItemCaseSensitive(object, key) : NULL;
}

/* DBL_MIN as lower end stands for "above 0". */
static int range_error(const struct json *json, const cJSON *item, const char *key, const char *kind, double min,
                       double max)
{
    char low[48], high[48] = "";
    if (min == DBL_MIN)
        snprintf(low, sizeof low, "above 0");
    else
        snprintf(low, sizeof low, "of at least %.10g", min);
    if (max < DBL_MAX)
        snprintf(high, sizeof high, " and at most %.10g", max);
    if (min <= -DBL_MAX)
        snprintf(low, sizeof low, "%s", max < DBL_MAX ? "of" : "");
    return json_error(json, item, "'%s' must be %s: give one %s%s", key, kind, low, high);
}

/* A finite number in [min, max]: the scanner has refused all others. */
static int check_number(const struct json *json, const cJSON *item, const char *key, double min, double max)
{
    if (!cJSON_IsNumber(item))
        return json_error(json, item, "'%s' must be a number: write it without quotes", key);
    if (!(item->valuedouble >= min && item->valuedouble <= max))
        return range_error(json, item, key, "a number in its range", min, max);
    return 0;
}

int json_number(const struct json *json, const cJSON *object, const char *key, double min, double max, double *value)
{
    const cJSON *item = member(object, key);
    if (!item)
        return 0;
    if (check_number(json, item, key, min, max))
        return -1;
    *value = item->valuedouble;
    return 1;
}

int json_integer(const struct json *json, const cJSON *object, const char *key, long min, long max, long *value)
{
    const cJSON *item = member(object, key);
    if (!item)
        return 0;
    if (!cJSON_IsNumber(item) || item->valuedouble != floor(item->valuedouble) ||
        !(item->valuedouble >= (double)min && item->valuedouble <= (double)max) || fabs(item->valuedouble) > 0x1p53)
        return range_error(json, item, key, "a whole number in its range", (double)min, (double)max);
    *value = (long)item->valuedouble;
    return 1;
}

int json_boolean(const struct json *json, const cJSON *object, const char *key, int *value)
{
    const cJSON *item = member(object, key);
    if (!item)
        return 0;
    if (!cJSON_IsBool(item))
        return json_error(json, item, "'%s' must be true or false: write one of them, without quotes", key);
    *value = cJSON_IsTrue(item) ? 1 : 0;
    return 1;
}

int json_string(const struct json *json, const cJSON *object, const char *key, const char **value)
{
    const cJSON *item = member(object, key);
    if (!item)
        return 0;
    if (!cJSON_IsString(item))
        return json_error(json, item, "'%s' must be text: write it in quotes", key);
    *value = item->valuestring;
    return 1;
}

int json_numbers(const struct json *json, const cJSON *object, const char *key, size_t count, double *values)
{
    const cJSON *item = member(object, key);
    if (!item)
        return 0;
    if (!cJSON_IsArray(item) || (size_t)cJSON_GetArraySize(item) != count)
        return json_error(json, item, "'%s' must be a list of %zu numbers: write [ ... ]", key, count);
    size_t k = 0;
    for (const cJSON *element = item->child; element; element = element->next)
        if (check_number(json, element, key, -DBL_MAX, DBL_MAX))
            return -1;
    for (const cJSON *element = item->child; element; element = element->next)
        values[k++] = element->valuedouble;
    return 1;
}

int json_object(const struct json *json, const cJSON *object, const char *key, const cJSON **value)
{
    const cJSON *item = member(object, key);
    if (!item)
        return 0;
    if (!cJSON_IsObject(item))
        return json_error(json, item, "'%s' must be a group: write {\"key\": value}", key);
    *value = item;
    return 1;
}

int json_array(const struct json *json, const cJSON *object, const char *key, const cJSON **value)
{
    const cJSON *item = member(object, key);
    if (!item)
        return 0;
    if (!cJSON_IsArray(item))
        return json_error(json, item, "'%s' must be a list: write [ ... ]", key);
    *value = item;
    return 1;
}

int json_choice(const struct json *json, const cJSON *object, const char *key, const char *const words[], int *value)
{
    const cJSON *item = member(object, key);
    char list[500];
    if (!item)
        return 0;
    for (int k = 0; cJSON_IsString(item) && words[k]; k++)
        if (!strcmp(words[k], item->valuestring)) {
            *value = k;
            return 1;
        }
    join_words(words, list, sizeof list);
    return json_error(json, item, "'%s' has an unknown value: give one of: %s", key, list);
}
