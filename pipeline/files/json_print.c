#include "pipeline/files/json.h"

#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>

#include "pipeline/speak/error.h"

/* cJSON_AddNumberToObject() and its like return NULL when memory is gone, and the object then lacks a member. Rather
 * than at hundreds of calls this is noticed here: cJSON allocates through remember_failure(), and nothing is printed
 * after a failure, since nobody knows which object it was. */
static atomic_int memory_failed;

static void *remember_failure(size_t size)
{
    void *block = malloc(size);
    if (!block)
        memory_failed = 1;
    return block;
}

/* Before any tree is built; a library has no other moment. */
__attribute__((constructor)) static void watch_memory(void)
{
    cJSON_InitHooks(&(cJSON_Hooks){remember_failure, free});
}

static int print_item(FILE *out, const cJSON *item);

static void print_string(FILE *out, const char *text)
{
    fputc('"', out);
    for (const unsigned char *c = (const unsigned char *)text; *c; c++) {
        if (*c == '"' || *c == '\\')
            fprintf(out, "\\%c", *c);
        else if (*c < 0x20)
            fprintf(out, "\\u%04x", *c);
        else
            fputc(*c, out);
    }
    fputc('"', out);
}

static int print_members(FILE *out, const cJSON *item, int is_object)
{
    fputc(is_object ? '{' : '[', out);
    for (const cJSON *child = item->child; child; child = child->next) {
        if (child != item->child)
            fputc(',', out);
        if (is_object) {
            print_string(out, child->string);
            fputc(':', out);
        }
        if (print_item(out, child))
            return -1;
    }
    fputc(is_object ? '}' : ']', out);
    return 0;
}

static int print_item(FILE *out, const cJSON *item)
{
    if (cJSON_IsObject(item) || cJSON_IsArray(item))
        return print_members(out, item, cJSON_IsObject(item));
    if (cJSON_IsString(item)) {
        print_string(out, item->valuestring);
        return 0;
    }
    if (cJSON_IsNumber(item)) {
        if (!isfinite(item->valuedouble))
            return error_failed("JSON has no number for infinity or NaN: leave it out");
        fprintf(out, "%.17g", item->valuedouble);
        return 0;
    }
    fputs(cJSON_IsTrue(item) ? "true" : cJSON_IsFalse(item) ? "false" : "null", out);
    return 0;
}

char *json_print(const cJSON *item)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = memory_failed ? NULL : open_memstream(&text, &size);
    if (!out) {
        error_set(EXIT_FAILED, "out of memory: JSON text: use a machine with more memory");
        return NULL;
    }
    int status = print_item(out, item);
    if ((fclose(out) != 0) && status == 0)
        status = error_memory("JSON text");
    if (status) {
        free(text);
        return NULL;
    }
    return text;
}
