/* HTML in memory. Everything that comes from outside goes through html_text() or html_format(), which escape it. */
#ifndef REPORT_HTML_H
#define REPORT_HTML_H

#include <stddef.h>
#include <stdio.h>

struct html {
    FILE *stream; /* literal HTML goes here */
    char *text;
    size_t length;
    const char *pictures, *extension; /* folder that gets every picture as a file, too, and its format; NULL: none */
};

/* `html` is owned by the caller from here on, and freed by html_free() on success and failure alike. 0, or -1 with
 * an error. */
int html_begin(struct html *html); /* without a folder for pictures */
/* Closes the stream; -1 when memory ran out on the way. html->text is then whole. */
int html_end(struct html *html);
void html_free(struct html *html); /* accepts a zeroed struct */

/* Escaped: safe between tags and inside attributes. NULL is not allowed. */
void html_text(struct html *html, const char *text);
/* printf, then escaped. */
void html_format(struct html *html, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* <td> with text, to the left. */
void html_cell(struct html *html, const char *text);
/* <td> with a number of that many significant digits; NaN: a dash. */
void html_number(struct html *html, double value, int digits);
/* An image inside the page, as a data: URL (RFC 2397), so that the page is one file that can be sent; the caption is
 * escaped and serves as the text for people who cannot see it: media "image/png" or "image/svg+xml". */
void html_picture(struct html *html, const char *media, const unsigned char *bytes, size_t length, const char *caption);

#endif
