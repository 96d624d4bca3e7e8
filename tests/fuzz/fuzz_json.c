/* Whatever the scanner accepts, cJSON must read the same: the printed text is read again and printed to itself. */
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/files/json.h"
#include "tests/fuzz/target.h"

static void demand(int truth)
{
    if (!truth)
        abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const char *const keys[] = {"schema", "name", "photos", NULL};
    error_clear();
    struct json *json = json_parse((const char *)data, size, "fuzz");
    if (!json) {
        demand(error_status() == EXIT_INPUT && *error_message());
        return 0;
    }
    json_check_keys(json, json_root(json), keys);
    char *text = json_print(json_root(json));
    demand(text != NULL);
    struct json *again = json_parse(text, strlen(text), "printed");
    demand(again != NULL);
    char *second = json_print(json_root(again));
    demand(second && !strcmp(text, second));
    free(second);
    free(text);
    json_free(again);
    json_free(json);
    return 0;
}
