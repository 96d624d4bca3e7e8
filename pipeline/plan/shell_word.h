/* Text as a word of the shell. */
#ifndef PIPELINE_SHELL_WORD_H
#define PIPELINE_SHELL_WORD_H

#include <stdio.h>

/* One word of bash that says exactly this text, whatever stands in it: harmless names as they are, others as $'...'
 * with \ooo for quotes, backslashes and control characters; never a line break. */
void shell_word(FILE *stream, const char *text);

#endif
