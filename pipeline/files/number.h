/* Numbers in text, the same in every locale: no program of ours calls setlocale, so the decimal mark is the point
 * (tests/unit/test_directions holds this). */
#ifndef PIPELINE_NUMBER_H
#define PIPELINE_NUMBER_H

/* The whole text is one finite decimal number ("1", "-0.5", "2e3"; no hexadecimal, no inf, no spaces): 0 and *value
 * set, else -1 with *value untouched. Sets no error line: the caller knows where the text stands. */
int number_parse(const char *text, double *value);
/* The same for a whole number that fits a long. */
int number_parse_integer(const char *text, long *value);

#endif
