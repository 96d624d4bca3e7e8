/* The table of force methods. Rows of the product stand there from the start; a program may add its own at run time. */
#include "forces/methods/method.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"

/* The table. */
static const struct method *rows[METHOD_COUNT + METHODS_ADDED_MOST] = {
    [METHOD_CEM] = &CEM_METHOD, [METHOD_CDM] = &CDM_METHOD, [METHOD_QSM] = &QSM_METHOD, [METHOD_MAP] = &MAP_METHOD};
static int count = METHOD_COUNT;

const struct method *method_row(enum force_method method)
{
    if ((int)method >= 0 && (int)method < count)
        return rows[method];
    error_set(EXIT_INPUT, "there is no force method of number %d: there are %d", (int)method, count);
    return NULL;
}

int method_find(const char *name, size_t length)
{
    for (int k = 0; k < count; k++)
        if (strlen(rows[k]->name) == length && !strncmp(rows[k]->name, name, length))
            return k;
    return -1;
}

/* The names, or name: sentence. of every row, with `between` in between. */
static char *listed(const char *between, int sentences)
{
    size_t room = 1;
    for (int k = 0; k < count; k++)
        room += strlen(rows[k]->name) + strlen(rows[k]->says) + strlen(between) + 3;
    char *text = calloc(room, 1), *end = text;
    for (int k = 0; text && k < count; k++)
        end += snprintf(end, room - (size_t)(end - text), "%s%s%s%s%s", k > 0 ? between : "", rows[k]->name,
                        sentences ? ": " : "", sentences ? rows[k]->says : "", sentences ? "." : "");
    if (!text)
        error_set(EXIT_FAILED, "out of memory: names of methods");
    return text;
}

char *method_names(void)
{
    return listed(",", 0);
}

char *method_help(void)
{
    return listed(" ", 1);
}

int method_add(const struct method *row)
{
    if (count == METHOD_COUNT + METHODS_ADDED_MOST)
        return error_input("method %s: no more than %d methods can be added", row->name, METHODS_ADDED_MOST);
    if (method_find(row->name, strlen(row->name)) >= 0)
        return error_input("method %s: there is one of that name already", row->name);
    rows[count] = row;
    return count++;
}

int method_network(const struct packing *packing, const struct force_options *options, const struct method *method,
                   struct network *network)
{
    int asked = method->candidates == CANDIDATES_IF_ASKED && options->candidates;
    const struct network_options network_options = {.candidates = asked || method->candidates == CANDIDATES_ALWAYS,
                                                    .wall_mass = options->wall_mass};
    return network_build(packing, &options->law, &network_options, network);
}
