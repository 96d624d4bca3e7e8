#include "forces/options.h"

#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"

int method_list_parse(const char *text, struct method_list *list)
{
    list->count = 0;
    for (const char *c = text;; c++) {
        size_t length = strcspn(c, ",");
        int method = method_find(c, length);
        char *names = method < 0 ? method_names() : NULL;
        if (names)
            error_set(EXIT_INPUT, "method '%.*s': give one or more of %s", (int)length, c, names);
        free(names);
        if (method < 0)
            return -1;
        for (int k = 0; k < list->count; k++)
            if (list->method[k] == (enum force_method)method)
                return error_input("method %.*s stands there twice", (int)length, c);
        list->method[list->count++] = (enum force_method)method;
        c += length;
        if (!*c)
            return 0;
    }
}

static const char *const KEYS[] = {"method",     "start",      "fix",        "rescale",   "tolerance",
                                   "iterations", "relaxation", "thickness",  "wall_mass", "orthogonal",
                                   "anderson",   "samples",    "walk",       "block",     "colours",
                                   "stability",  "series",     "candidates", NULL};

static int read_words(const struct scene *scene, const cJSON *section, struct method_list *list,
                      struct force_options *options)
{
    const char *methods = NULL;
    int start = (int)options->start, fix = (int)options->fix;
    int given = json_string(scene->json, section, "method", &methods);
    if (given < 0 || json_choice(scene->json, section, "start", FORCE_STARTS, &start) < 0 ||
        json_choice(scene->json, section, "fix", FORCE_FIXES, &fix) < 0)
        return -1;
    if (given && method_list_parse(methods, list))
        return error_context("%s: forces.method", scene->path);
    if (start == START_FILE)
        return error_input("%s: forces.start: name the file on the command line, --start FILE", scene->path);
    options->start = (enum force_start)start;
    options->fix = (enum force_fix)fix;
    return 0;
}

static int read_numbers(const struct scene *scene, const cJSON *section, struct force_options *options)
{
    const struct json *json = scene->json;
    long iterations = options->iterations, anderson = options->anderson, block = options->block,
         samples = options->samples, walk = options->walk;
    if (json_boolean(json, section, "rescale", &options->rescale) < 0 ||
        json_boolean(json, section, "orthogonal", &options->orthogonal) < 0 ||
        json_boolean(json, section, "candidates", &options->candidates) < 0 ||
        json_boolean(json, section, "stability", &options->stability) < 0 ||
        json_number(json, section, "tolerance", 1e-14, 1, &options->tolerance) < 0 ||
        json_integer(json, section, "iterations", 0, 100000000, &iterations) < 0 ||
        json_number(json, section, "relaxation", 0.1, 1.9, &options->relaxation) < 0 ||
        json_number(json, section, "thickness", 0, 1, &options->thickness) < 0 ||
        json_number(json, section, "wall_mass", 1e-6, 1e12, &options->wall_mass) < 0 ||
        json_integer(json, section, "anderson", 0, 30, &anderson) < 0 ||
        json_integer(json, section, "block", 0, 100000, &block) < 0 ||
        json_boolean(json, section, "colours", &options->colours) < 0 ||
        json_integer(json, section, "samples", 0, 100000, &samples) < 0 ||
        json_integer(json, section, "walk", 0, 1000000, &walk) < 0)
        return -1;
    options->iterations = (int)iterations;
    options->anderson = (int)anderson;
    options->block = (int)block;
    options->samples = (int)samples;
    options->walk = (int)walk;
    return 0;
}

int force_options_read(const struct scene *scene, struct method_list *list, struct force_options *options)
{
    const cJSON *section = scene_section(scene, "forces");
    if (!scene->contact_given || !isfinite(scene->contact.mu))
        return scene_lacks(scene, "contact.mu", "forces needs the friction coefficient");
    options->law = scene->contact;
    if (!section)
        return 0;
    if (json_check_keys(scene->json, section, KEYS) || read_words(scene, section, list, options) ||
        read_numbers(scene, section, options))
        return -1;
    return 0;
}

static int add_words(cJSON *object, const struct method_list *list, const struct force_options *options)
{
    cJSON *methods = cJSON_AddArrayToObject(object, "method");
    for (int k = 0; methods && k < list->count; k++)
        if (!cJSON_AddItemToArray(methods, cJSON_CreateString(method_row(list->method[k])->name)))
            return -1;
    return methods && cJSON_AddStringToObject(object, "start", FORCE_STARTS[options->start]) &&
                   cJSON_AddStringToObject(object, "fix", FORCE_FIXES[options->fix])
               ? 0
               : -1;
}

static int add_number(cJSON *object, const char *key, double value)
{
    cJSON *added = isfinite(value) ? cJSON_AddNumberToObject(object, key, value) : cJSON_AddNullToObject(object, key);
    return added ? 0 : -1;
}

char *force_options_text(const struct method_list *list, const struct force_options *options)
{
    cJSON *object = cJSON_CreateObject();
    char *text = NULL;
    int failed =
        !object || add_words(object, list, options) || add_number(object, "kn_N_per_m", options->law.kn) ||
        add_number(object, "kt_over_kn", options->law.kt_over_kn) || add_number(object, "mu", options->law.mu) ||
        add_number(object, "mu_wall", options->law.mu_wall) || add_number(object, "rescale", options->rescale) ||
        add_number(object, "tolerance", options->tolerance) || add_number(object, "iterations", options->iterations) ||
        add_number(object, "relaxation", options->relaxation) || add_number(object, "thickness", options->thickness) ||
        add_number(object, "wall_mass", options->wall_mass) || add_number(object, "candidates", options->candidates) ||
        add_number(object, "orthogonal", options->orthogonal) || add_number(object, "anderson", options->anderson) ||
        add_number(object, "block", options->block) || add_number(object, "colours", options->colours) ||
        add_number(object, "samples", options->samples) || add_number(object, "walk", options->walk) ||
        add_number(object, "stability", options->stability) ||
        (options->range && !cJSON_AddStringToObject(object, "range", options->range));
    if (!failed)
        text = json_print(object);
    cJSON_Delete(object);
    if (!text)
        error_set(EXIT_FAILED, "out of memory: parameters");
    return text;
}
