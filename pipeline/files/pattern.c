#include "pipeline/files/pattern.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"
#include "pipeline/files/number.h"

enum { MAX_DIGITS = 9 };

/* A pattern is prefix, field, suffix; `digits` is the least number of digits, 1 for {index}, 0 without a field. */
struct parts {
    size_t prefix;
    const char *suffix;
    int digits;
};

static const char *split(const char *pattern, struct parts *parts)
{
    static const char plain[] = "{index}", padded[] = "{index:0";
    const char *field = strchr(pattern, '{');
    if (!field) { /* one photo, index 0 */
        *parts = (struct parts){strlen(pattern), pattern + strlen(pattern), 0};
        return strchr(pattern, '}') ? "use exactly one {index} and no other braces" : NULL;
    }
    parts->prefix = (size_t)(field - pattern);
    parts->digits = 1;
    if (!strncmp(field, plain, strlen(plain))) {
        parts->suffix = field + strlen(plain);
    } else {
        const char *width = field + strlen(padded);
        if (strncmp(field, padded, strlen(padded)) || *width < '1' || *width > '0' + MAX_DIGITS ||
            strncmp(width + 1, "d}", 2))
            return "write the number as {index}, or as {index:04d} for four digits";
        parts->digits = *width - '0';
        parts->suffix = width + 3;
    }
    if (strpbrk(parts->suffix, "{}") || memchr(pattern, '}', parts->prefix))
        return "use exactly one {index} and no other braces";
    if (strchr(parts->suffix, '/'))
        return "put {index} into the file's name, not into its folder";
    return NULL;
}

const char *pattern_check(const char *pattern, int only_one)
{
    struct parts parts;
    const char *remedy = split(pattern, &parts);
    if (!remedy && parts.digits == 0 && !only_one)
        remedy = "put {index} or {index:04d} where the number stands (one single photo: first 0, last 0)";
    return remedy;
}

char *pattern_format(const char *pattern, long index)
{
    struct parts parts;
    char *name = NULL;
    if (split(pattern, &parts) || index < 0 || (parts.digits == 0 && index > 0)) {
        error_set(EXIT_FAILED, "%s: no name for photo %ld", pattern, index);
        return NULL;
    }
    if (parts.digits == 0) {
        if (!(name = strdup(pattern)))
            error_set(EXIT_FAILED, "out of memory: name of a photo: use a machine with more memory");
        return name;
    }
    if (asprintf(&name, "%.*s%0*ld%s", (int)parts.prefix, pattern, parts.digits, index, parts.suffix) < 0) {
        error_set(EXIT_FAILED, "out of memory: name of photo %ld: use a machine with more memory", index);
        return NULL;
    }
    return name;
}

static const char *base_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

long pattern_index(const char *pattern, const char *path)
{
    struct parts parts;
    if (split(pattern, &parts))
        return -1;
    const char *prefix = base_name(pattern), *name = base_name(path);
    if (parts.digits == 0)
        return strcmp(prefix, name) ? -1 : 0;
    size_t before = (size_t)(pattern + parts.prefix - prefix), after = strlen(parts.suffix), length = strlen(name);
    if (length <= before + after || length - before - after > MAX_DIGITS || strncmp(name, prefix, before) ||
        strcmp(name + length - after, parts.suffix))
        return -1;
    char digits[MAX_DIGITS + 1], again[MAX_DIGITS + 1];
    size_t count = length - before - after;
    memcpy(digits, name + before, count);
    digits[count] = '\0';
    long index;
    if (digits[0] < '0' || digits[0] > '9' || number_parse_integer(digits, &index))
        return -1;
    /* The name must be the one that this index would get: 07 does not fit {index}. */
    snprintf(again, sizeof again, "%0*ld", parts.digits, index);
    return strcmp(again, digits) ? -1 : index;
}
