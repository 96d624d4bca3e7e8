#include "report/compare/figures.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/files/json.h"
#include "report/export/text_file.h"

void figures_add(struct figures *figures, const char *name, double value, const char *units, const char *text)
{
    if (figures->count == sizeof figures->list / sizeof *figures->list) {
        figures->overflow = 1;
        return;
    }
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

/* Units that people read: the first of these in which the number is not below one. */
static const struct unit {
    const char *units, *shown;
    double size;
} scales[] = {{"m", "m", 1},           {"m", "mm", 1e-3},       {"m", "um", 1e-6},
              {"m/px", "mm/px", 1e-3}, {"m/px", "um/px", 1e-6}, {"Pa", "MPa", 1e6},
              {"Pa", "kPa", 1e3},      {"Pa", "Pa", 1},         {"N/m", "kN/m", 1e3}};

/* The last one of these units is for all that is smaller. */
static struct unit unit_of(double value, const char *units)
{
    struct unit chosen = {units, units, 1};
    for (size_t k = 0; k < sizeof scales / sizeof *scales; k++) {
        if (strcmp(scales[k].units, units))
            continue;
        chosen = scales[k];
        if (fabs(value) >= chosen.size)
            break;
    }
    return chosen;
}

/* Three digits, but counts whole, and four decimals near one, where correlations and shares differ. */
static void number_text(double value, char text[32])
{
    double size = fabs(value);
    if (!isfinite(value) || size >= 1e9 || (size < 1e-4 && size > 0))
        snprintf(text, 32, "%.3g", value);
    else if (value == round(value))
        snprintf(text, 32, "%.0f", value + 0.0); /* no -0 */
    else if (size >= 0.9 && size < 1)
        snprintf(text, 32, "%.4f", value);
    else
        snprintf(text, 32, "%.*f", (int)fmax(0, 2 - floor(log10(size))), value);
}

static int check_room(const struct figures *figures)
{
    return figures->overflow ? error_failed("compare: more than %zu figures", figures->count) : 0;
}

int figures_print(const struct figures *figures, FILE *stream)
{
    if (check_room(figures))
        return -1;
    for (size_t k = 0; k < figures->count; k++) {
        const struct figure *figure = &figures->list[k];
        struct unit unit = unit_of(figure->value, figure->units);
        int plain = !strcmp(figure->units, "1");
        char text[32] = "-";
        if (!isnan(figure->value))
            number_text(figure->value / unit.size, text);
        if (isnan(figure->value) || plain)
            fprintf(stream, "%-62s %12s\n", figure->text, text);
        else
            fprintf(stream, "%-62s %12s %s\n", figure->text, text, unit.shown);
    }
    return 0;
}

int figures_write_json(const struct figures *figures, const char *path)
{
    if (check_room(figures))
        return -1;
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
