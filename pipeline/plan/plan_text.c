/* GNU make has no way to write some names as targets or prerequisites (line breaks, wildcards, some of % : = in
 * variables), and its rules for those that it has differ between targets, prerequisites and recipes. So results alone
 * are targets, and whether a file outside is newer is asked here, as make would ask it; only commands hold other names,
 * and in a recipe nothing but '$' means anything to make. */
#include "pipeline/plan/plan_text.h"

#include <stdlib.h>
#include <string.h>

#include "pipeline/files/json.h"
#include "pipeline/files/sha256.h"
#include "pipeline/plan/plan.h"
#include "pipeline/plan/plan_marks.h"
#include "pipeline/speak/error.h"

/* Text of the shell in a recipe: '$' is the one letter that means something to make there. */
static void put_in_recipe(const char *text, FILE *stream)
{
    for (; *text; text++)
        fprintf(stream, *text == '$' ? "$$" : "%c", *text);
}

static void print_rule(const struct plan *plan, const int parts[PLAN_STAGES], const struct product *product,
                       FILE *stream)
{
    fprintf(stream, "%s: %s%s", product->of.name, product->needs,
            plan_is_changed(plan, parts, product) ? " changed" : "");
    if (*product->command) {
        fputs("\n\t@", stream);
        put_in_recipe(product->command, stream);
        fputc('\n', stream);
    } else
        fputs(" ;\n", stream); /* an empty recipe: make looks again at the time of the file */
}

int plan_print_make(const struct plan *plan, FILE *stream)
{
    int parts[PLAN_STAGES];
    plan_changed_parts(plan, parts);
    fputs("# Made by `scene plan`.\nSHELL := /bin/bash\n.SUFFIXES:\n.DELETE_ON_ERROR:\n.PHONY: stages changed\n"
          "stages:\nchanged:\n",
          stream);
    for (size_t k = 0; k < plan->count; k++) {
        struct product product;
        if (plan_product(plan, k, &product))
            return -1;
        print_rule(plan, parts, &product, stream);
        product_free(&product);
    }
    fputs("stages:", stream); /* one line: make walks along what a target has at each further one */
    for (size_t k = 0; k < plan->count; k++)
        fprintf(stream, " %s", plan_name(plan, k).name);
    fputs("\n\t@:\n", stream);
    return 0;
}

static int print_line(const struct product *product, const char *part, FILE *stream)
{
    cJSON *object = cJSON_CreateObject();
    cJSON_AddStringToObject(object, "product", product->of.name);
    cJSON_AddStringToObject(object, "stage", PLAN_STAGE[product->stage]);
    cJSON_AddStringToObject(object, "job", product->job);
    cJSON_AddStringToObject(object, "part", part);
    cJSON_AddStringToObject(object, "needs", product->needs);
    cJSON_AddItemToObject(object, "reads",
                          cJSON_CreateStringArray((const char *const *)product->reads, (int)product->read_count));
    cJSON_AddStringToObject(object, "command", product->command);
    char *line = json_print(object);
    if (line)
        fprintf(stream, "%s\n", line);
    cJSON_Delete(object);
    free(line);
    return line ? 0 : -1;
}

int plan_print_json(const struct plan *plan, FILE *stream)
{
    char parts[PLAN_STAGES][65];
    struct product product;
    for (int s = 0; s < PLAN_STAGES; s++)
        if (text_sha256(plan->part[s], parts[s]))
            return -1;
    for (size_t k = 0; k < plan->count; k++) {
        if (plan_product(plan, k, &product))
            return -1;
        int failed = print_line(&product, parts[product.stage], stream);
        product_free(&product);
        if (failed)
            return -1;
    }
    return 0;
}
