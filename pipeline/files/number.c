#include "pipeline/files/number.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define DIGITS "0123456789"

static const char *skip_sign(const char *at)
{
    return *at == '-' || *at == '+' ? at + 1 : at;
}

/* sign, digits with at most one point and at least one digit, optional exponent; strtod alone would also take "0x1p3",
 * "nan" and leading spaces. */
static int is_decimal(const char *text)
{
    const char *at = skip_sign(text);
    size_t whole = strspn(at, DIGITS), fraction = 0;
    at += whole;
    if (*at == '.') {
        fraction = strspn(at + 1, DIGITS);
        at += 1 + fraction;
    }
    if (whole + fraction == 0)
        return 0;
    if (*at == 'e' || *at == 'E') {
        at = skip_sign(at + 1);
        size_t exponent = strspn(at, DIGITS);
        if (exponent == 0)
            return 0;
        at += exponent;
    }
    return *at == '\0';
}

int number_parse(const char *text, double *value)
{
    if (!is_decimal(text))
        return -1;
    double number = strtod(text, NULL);
    if (!isfinite(number))
        return -1;
    *value = number;
    return 0;
}

int number_parse_integer(const char *text, long *value)
{
    const char *digits = skip_sign(text);
    if (*digits == '\0' || digits[strspn(digits, DIGITS)] != '\0')
        return -1;
    errno = 0;
    long number = strtol(text, NULL, 10);
    if (errno)
        return -1;
    *value = number;
    return 0;
}
