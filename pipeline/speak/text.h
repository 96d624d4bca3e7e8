/* Text from outside: names of files, words of the command line, strings in files. */
#ifndef PIPELINE_TEXT_H
#define PIPELINE_TEXT_H

#include <stddef.h>
#include <stdio.h>

/* Bytes of the UTF-8 letter that begins at `text`, of which `left` > 0 bytes are there: 1 to 4; 0: none begins here
 * (overlong, surrogate, above U+10FFFF, cut, or another encoding). */
size_t text_letter(const char *text, size_t left);

/* For a terminal or a picture: control characters (C0, DEL, C1) and bytes that are no UTF-8 become '?', so that a
 * name neither moves the cursor nor makes a line. Into `room`, cut after a whole letter. */
void text_clean(const char *text, char *room, size_t size);
/* The same, whole, to a stream. */
void text_print(FILE *stream, const char *text);

/* A name as UTF-8 that says it exactly: '%' and bytes that are no UTF-8 as %25, %E9. To be freed; NULL: no memory. */
char *text_escape(const char *name);
/* Back, in place; '%' without two hexadecimal digits stays. */
void text_unescape(char *name);

#endif
