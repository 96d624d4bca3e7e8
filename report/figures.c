#include "report/figures.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/error.h"
#include "pipeline/json.h"
#include "report/text_file.h"

void figures_add(struct figures *figures, const char *name, double value, const char *units, const char *text)
{
    if (figures->count == sizeof figures->list / sizeof *figures->list)
        return;
    struct figure *figure = &figures->list[figures->count++];
    snprintf(figure->name, sizeof figure->name, "%s", name);
    figure->value = value;
    figure->units = units;
    figure->text = text;
}

double figures_value(const struct figures *figures, const char *name)
{
    for (size_t k = 0; k < figures->count; k++)
        if (!strcmp(figures->list[k].name, name))
            return figures->list[k].value;
    return NAN;
}

void figures_print(const struct figures *figures, FILE *stream)
{
    for (size_t k = 0; k < figures->count; k++) {
        const struct figure *figure = &figures->list[k];
        int plain = !strcmp(figure->units, "1");
        if (isnan(figure->value))
            fprintf(stream, "%-62s %12s\n", figure->text, "-");
        else
            fprintf(stream, "%-62s %12.6g%s%s\n", figure->text, figure->value, plain ? "" : " ",
                    plain ? "" : figure->units);
    }
}

int figures_write_json(const struct figures *figures, const char *path)
{
    cJSON *object = cJSON_CreateObject();
    for (size_t k = 0; k < figures->count; k++) {
        const struct figure *figure = &figures->list[k];
        if (isfinite(figure->value))
            cJSON_AddNumberToObject(object, figure->name, figure->value);
        else
            cJSON_AddNullToObject(object, figure->name);
    }
    char *text = json_print(object);
    cJSON_Delete(object);
    if (!text)
        return error_memory("JSON");
    int result = text_file_write(path, text, strlen(text));
    free(text);
    return result;
}
