/* The programs run by tests as a user runs them: in a folder of the test's own, their exit status, what they say and
 * what they write. Every function fails the test when something is not as it promises. */
#ifndef TESTS_COMMANDS_H
#define TESTS_COMMANDS_H

#include "tests/check.h"

#include <cjson/cJSON.h>

/* For cmocka's group: go to a new folder; leave and remove it with all that is in it. */
int folder_enter(void **state);
int folder_leave(void **state);

/* What the last command wrote on standard output and standard error (their first 64 kB). */
extern char command_out[], command_err[];

/* Run the words of a program of build/bin ("calibration scale ..."), split by the shell; its exit status. */
int command_run(const char *format, ...) __attribute__((format(printf, 1, 2)));
/* ... and it must end with 0 and nothing on standard error but the summary: one line of the program, none with --quiet.
 */
void command_done(const char *format, ...) __attribute__((format(printf, 1, 2)));
/* ... and it must end with that status, nothing on standard output, and on standard error the text `says`: for
 * statuses other than 2 in one line that begins with the program's name. */
void command_fails(int status, const char *says, const char *format, ...) __attribute__((format(printf, 3, 4)));

/* The whole file, ended by a zero, to be freed. */
char *file_text(const char *path);
void file_write(const char *path, const char *text);
int file_exists(const char *path);
/* How often `word` stands in the text. */
size_t text_count(const char *text, const char *word);

/* A JSON file that a command has written, to be deleted; its schema must be `schema` (NULL: any or none). */
cJSON *json_of(const char *path, const char *schema);
/* What stands at the end of a path of keys and places, as in "states.2.weber.xx": a number, NaN where there is none; a
 * text; 1 for true and 0 for false. */
double json_at(const cJSON *object, const char *format, ...) __attribute__((format(printf, 2, 3)));
const char *json_text_at(const cJSON *object, const char *format, ...) __attribute__((format(printf, 2, 3)));
int json_is(const cJSON *object, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* The file is a PNG of that size, whole to its last chunk, every chunk with its checksum; -1: any size. */
void check_png(const char *path, long width, long height);
/* The file is SVG that closes what it opens; its text, to be freed. */
char *check_svg(const char *path);
/* Its straight strokes of that colour (as cairo writes the beginning of it), in the order in which they are drawn;
 * more than `room` fail. */
struct svg_stroke {
    double width, x0, y0, x1, y1;
};
size_t svg_strokes(const char *svg, const char *colour, struct svg_stroke *strokes, size_t room);
/* Its filled shapes of that colour, by the points at which they begin: markers, dots, bars. */
struct svg_point {
    double x, y;
};
size_t svg_fills(const char *svg, const char *colour, struct svg_point *points, size_t room);

#endif
