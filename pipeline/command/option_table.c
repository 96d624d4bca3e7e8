/* One judge for two sources: text of the command line (option_take) and values of the scene (options_read) end in the
 * same is_allowed() and store_number(), and the messages of both, and --help, print the same range. What differs is
 * the type of what comes in: text has no types, JSON has, so that "3" in quotes is no number there. */
#include "pipeline/command/option_table.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/command/cli_inputs.h"
#include "pipeline/files/number.h"
#include "pipeline/speak/error.h"
#include "pipeline/files/json.h"

int option_is_row(const struct option_row *row)
{
    return row->name || row->key;
}

static void *member_of(const struct option_row *row, void *options)
{
    return (char *)options + row->at;
}

/* Must the value have no fraction? */
static int is_whole(const struct option_row *row)
{
    return row->type == OPTION_WHOLE || row->type == OPTION_LONG;
}

/* Types that have a range. */
static int is_numeric(const struct option_row *row)
{
    return row->type == OPTION_NUMBER || is_whole(row);
}

/* ---- what the row says of itself ---- */

enum { DIGITS = 10, WHOLE_DIGITS = 16 }; /* that are shown: whole numbers up to 2^53 in full */

/* "from 0 to 1", "0, or from 2 to 100000"; large whole numbers in full. */
static void print_range(const struct option_row *row, char *text, size_t size)
{
    int digits = is_whole(row) ? WHOLE_DIGITS : DIGITS;
    char least[40] = "above 0, up to";
    if (row->min != DBL_MIN)
        snprintf(least, sizeof least, "from %.*g to", digits, row->min);
    snprintf(text, size, "%s%s %.*g%s", row->zero ? "0, or " : "", least, digits, row->max,
             row->automatic ? ", or auto" : "");
}

/* "red, green", cut where there is no room. */
static void print_words(const char *const words[], char *text, size_t size)
{
    size_t used = 0;
    for (*text = '\0'; *words && used < size; words++)
        used += (size_t)snprintf(text + used, size - used, "%s%s", used ? ", " : "", *words);
}

/* In the range, or the 0 beside it. */
static int is_allowed(const struct option_row *row, double value)
{
    return (value >= row->min && value <= row->max && (!is_whole(row) || value == floor(value))) ||
           (row->zero && value == 0);
}

/* The member of a numeric row, which holds the default until something is taken. */
static double number_of(const struct option_row *row, const void *options)
{
    const char *member = (const char *)options + row->at;
    return row->type == OPTION_NUMBER  ? *(const double *)member
           : row->type == OPTION_WHOLE ? *(const int *)member
                                       : (double)*(const long *)member;
}

/* Empty where nothing is set: a number out of its range or NaN, no text, no choice (-1), a switch. */
static void print_default(const struct option_row *row, const void *options, char *text, size_t size)
{
    const char *member = (const char *)options + row->at;
    *text = '\0';
    if (row->parse)
        return;
    if (is_numeric(row) && is_allowed(row, number_of(row, options)))
        snprintf(text, size, "default %.*g", is_whole(row) ? WHOLE_DIGITS : DIGITS, number_of(row, options));
    else if (row->type == OPTION_CHOICE && *(const int *)member >= 0)
        snprintf(text, size, "default %s", row->words[*(const int *)member]);
    else if (row->type == OPTION_TEXT && *(const char *const *)member && **(const char *const *)member)
        snprintf(text, size, "default %s", *(const char *const *)member);
}

/* "help (range; default; scene: key)", each part only where the row has it. */
char *option_describe(const struct option_row *row, const char *section, const void *options)
{
    char parts[3][500] = {"", "", ""}, *text = NULL;
    if (is_numeric(row) && !row->parse)
        print_range(row, parts[0], sizeof parts[0]);
    if (row->type == OPTION_CHOICE)
        print_words(row->words, parts[0], sizeof parts[0]);
    print_default(row, options, parts[1], sizeof parts[1]);
    if (row->key && section)
        snprintf(parts[2], sizeof parts[2], "scene: %s.%s", section, row->key);
    size_t length = 0;
    FILE *stream = open_memstream(&text, &length);
    if (!stream)
        return NULL;
    fputs(row->help, stream);
    int open = 0;
    for (int k = 0; k < 3; k++)
        if (*parts[k])
            fprintf(stream, "%s%s", open++ ? "; " : " (", parts[k]);
    if (open)
        fputc(')', stream);
    fclose(stream);
    return text;
}

/* ---- the command line ---- */

int option_choice(const char *text, const char *const words[])
{
    char list[500];
    for (int k = 0; words[k]; k++)
        if (!strcmp(words[k], text))
            return k;
    print_words(words, list, sizeof list);
    return error_input("give one of: %s", list);
}

/* Whole numbers were judged to lie within their type (max of the row), so the casts are exact. A number undoes an
 * earlier "auto". */
static void store_number(const struct option_row *row, double value, void *options)
{
    void *member = member_of(row, options);
    if (row->type == OPTION_NUMBER)
        *(double *)member = value;
    else if (row->type == OPTION_WHOLE)
        *(int *)member = (int)value;
    else
        *(long *)member = (long)value;
    if (row->automatic)
        *(int *)((char *)options + row->automatic) = 0;
}

static int take_number(const struct option_row *row, const char *text, void *options)
{
    char range[200];
    double value;
    if (row->automatic && !strcmp(text, "auto")) {
        *(int *)((char *)options + row->automatic) = 1;
        return 0;
    }
    print_range(row, range, sizeof range);
    if (number_parse(text, &value) || !is_allowed(row, value))
        return error_input("give a %snumber %s", is_whole(row) ? "whole " : "", range);
    store_number(row, value, options);
    return 0;
}

int option_take(const struct option_row *row, const char *text, void *options)
{
    void *member = member_of(row, options);
    if (row->parse)
        return row->parse(text, member);
    if (is_numeric(row))
        return take_number(row, text, options);
    if (row->type == OPTION_LIST)
        return cli_inputs_add(member, text);
    if (row->type == OPTION_TEXT || row->type == OPTION_OUTPUT)
        *(const char **)member = text;
    else if (row->type == OPTION_SWITCH)
        *(int *)member = 1;
    else if (row->type == OPTION_CHOICE)
        return (*(int *)member = option_choice(text, row->words)) < 0 ? -1 : 0;
    return 0;
}

/* ---- the scene ---- */

/* A section of the scene that is being read. */
struct section {
    const struct option_row *rows;
    const struct json *json;
    uint64_t given;
    void *options;
};

/* Not json_number(): its ranges know neither the 0 beside them nor "auto". */
static int read_number(const struct section *section, const cJSON *object, const char *key,
                       const struct option_row *row, void *options)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, key);
    char range[200];
    if (row->automatic && cJSON_IsString(item)) {
        if (take_number(row, item->valuestring, options))
            return json_error(section->json, item, "'%s' is \"%s\": give a number or \"auto\"", key, item->valuestring);
        return 0;
    }
    print_range(row, range, sizeof range);
    if (!cJSON_IsNumber(item) || !is_allowed(row, item->valuedouble))
        return json_error(section->json, item, "'%s' must be a %snumber: give one %s", key,
                          is_whole(row) ? "whole " : "", range);
    store_number(row, item->valuedouble, options);
    return 0;
}

/* Text, words and grammars: as if the text stood on the command line, with its place in the scene before the message.
 */
static int read_text(const struct section *section, const cJSON *object, const char *key, const struct option_row *row,
                     void *options)
{
    const char *text = NULL;
    if (json_string(section->json, object, key, &text) < 0)
        return -1;
    if (!option_take(row, text, options))
        return 0;
    char message[500];
    snprintf(message, sizeof message, "%s", error_message());
    return json_error(section->json, cJSON_GetObjectItemCaseSensitive(object, key), "'%s' is \"%s\": %s", key, text,
                      message);
}

/* A key that is there. What stood on the command line is judged in a copy that nobody reads. */
static int read_row(const struct section *section, const cJSON *object, const char *key, size_t k)
{
    union {
        double number;
        char room[OPTION_ROOM];
        struct {
            double number;
            int automatic;
        } either;
    } copy = {.room = {0}};
    struct option_row row = section->rows[k];
    void *options = section->options;
    if (section->given >> k & 1) {
        options = &copy;
        row.at = 0;
        row.automatic = row.automatic ? offsetof(__typeof__(copy.either), automatic) : 0;
    }
    if (row.type == OPTION_ELSE)
        return 0;
    if (is_numeric(&row) && !row.parse)
        return read_number(section, object, key, &row, options);
    if (row.type == OPTION_SWITCH)
        return json_boolean(section->json, object, key, member_of(&row, options)) < 0 ? -1 : 0;
    if (row.type == OPTION_CHOICE)
        return json_choice(section->json, object, key, row.words, member_of(&row, options)) < 0 ? -1 : 0;
    return read_text(section, object, key, &row, options);
}

/* The members of the group whose keys begin with the first `length` letters of `prefix` ("camera."): each name once,
 * with its first row. */
static size_t list_names(const struct section *section, const char *prefix, size_t length, char names[][40],
                         size_t rows[])
{
    size_t count = 0;
    for (size_t k = 0; option_is_row(&section->rows[k]); k++) {
        const char *key = section->rows[k].key;
        if (!key || strncmp(key, prefix, length))
            continue;
        char name[40];
        snprintf(name, sizeof name, "%.*s", (int)strcspn(key + length, "."), key + length);
        size_t other = 0;
        while (other < count && strcmp(names[other], name))
            other++;
        if (other == count) {
            memcpy(names[count], name, sizeof name);
            rows[count++] = k;
        }
    }
    return count;
}

/* Keys that no row names are refused first, so that a misspelt key is not taken for one left out. A member is a group
 * of its own where its row's key goes on with a dot. */
static int read_group(const struct section *section, const cJSON *object, const char *prefix, size_t length)
{
    char names[OPTION_MOST][40];
    const char *allowed[OPTION_MOST + 1] = {NULL};
    size_t rows[OPTION_MOST], count = list_names(section, prefix, length, names, rows);
    for (size_t m = 0; m < count; m++)
        allowed[m] = names[m];
    int failed = json_check_keys(section->json, object, allowed);
    for (size_t m = 0; m < count && !failed; m++) {
        const char *key = section->rows[rows[m]].key;
        size_t end = length + strlen(names[m]);
        const cJSON *group = NULL;
        if (!cJSON_GetObjectItemCaseSensitive(object, names[m]))
            continue;
        if (key[end] == '.')
            failed =
                json_object(section->json, object, names[m], &group) < 0 || read_group(section, group, key, end + 1);
        else
            failed = read_row(section, object, names[m], rows[m]);
    }
    return failed ? -1 : 0;
}

int options_read(const struct option_row *rows, const struct scene *scene, const char *section, uint64_t given,
                 void *options)
{
    const struct section what = {rows, scene->json, given, options};
    const cJSON *object = scene_section(scene, section);
    return object ? read_group(&what, object, "", 0) : 0;
}
