/* A picture that is asked for as a file is drawn once more: its format may be another one than the page has inside. */
#include "report/pictures/page_picture.h"

#include <ctype.h>
#include <stdlib.h>

#include "pipeline/speak/error.h"

/* The bytes of the picture go into the page. */
static int put_inside(const struct picture *picture, enum canvas_format format, struct html *html)
{
    struct canvas canvas;
    unsigned char *bytes = NULL;
    size_t length = 0;
    if (canvas_begin_memory(&canvas, format, picture->width, picture->height))
        return -1;
    if (picture->draw(&canvas, picture->what)) {
        canvas_discard(&canvas);
        return -1;
    }
    if (canvas_take(&canvas, &bytes, &length))
        return -1;
    html_picture(html, format == CANVAS_PNG ? "image/png" : "image/svg+xml", bytes, length, picture->title);
    free(bytes);
    return 0;
}

/* FOLDER/Normal-stress-by-orientation.svg; to be freed. */
static char *path_of(const struct picture *picture, const struct html *html)
{
    char name[100];
    size_t length = 0;
    for (const char *c = picture->title; *c && length < sizeof name - 1; c++)
        if (isalnum((unsigned char)*c))
            name[length++] = *c;
        else if (length && name[length - 1] != '-')
            name[length++] = '-';
    while (length && name[length - 1] == '-')
        length--;
    char *path = NULL;
    if (asprintf(&path, "%s/%.*s.%s", html->pictures, (int)length, name, html->extension) < 0)
        return NULL;
    return path;
}

int picture_put(const struct picture *picture, enum canvas_format format, struct html *html)
{
    struct canvas canvas;
    if (put_inside(picture, format, html))
        return -1;
    if (!html->pictures)
        return 0;
    char *path = path_of(picture, html);
    int result = path ? canvas_begin(&canvas, path, picture->width, picture->height) : error_memory("a path");
    free(path);
    return result ? -1 : canvas_end(&canvas, picture->draw(&canvas, picture->what));
}
