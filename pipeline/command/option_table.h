/* One table says everything about what a user may set, on the command line and in the program's section of the scene.
 * Adding an option is one row (and the member of the struct where its value goes, with its default):
 *
 *     {"samples", "samples", OPTION_WHOLE, AT(options.samples), "N", .help = "Draws", .min = 2, .max = 1e5, .zero = 1},
 *
 * with
 *
 *     #define AT(member) .at = offsetof(struct options, member)
 *
 * is --samples N and {"forces": {"samples": N}}; from it come the line of --help with its range and default, the
 * messages of both judges, and the value. A row without `name` is for scenes only, one without `key` for the command
 * line only. Rows with neither end a table. What more than one row tells together is judged by struct program's
 * check(). */
#ifndef PIPELINE_OPTION_TABLE_H
#define PIPELINE_OPTION_TABLE_H

#include <stddef.h>
#include <stdint.h>

#include "pipeline/scene/scene.h"

/* What a value is, and the member that takes it. */
enum option_type {
    OPTION_NUMBER, /* double, in any locale; no inf, nan or hexadecimal */
    OPTION_WHOLE,  /* int: 0.5 and 2.9 are refused */
    OPTION_LONG,   /* long, size_t, int64_t or uint64_t: a whole number */
    OPTION_SWITCH, /* int: 1 when the option stands there; true or false in a scene */
    OPTION_CHOICE, /* int or enum: position among `words` */
    OPTION_TEXT,   /* const char *: borrowed from the command line or the scene */
    OPTION_OUTPUT, /* the same: a file that will be written, so it may not be one of the inputs */
    OPTION_LIST,   /* struct cli_inputs: the option may stand there more than once */
    OPTION_ELSE    /* a key of the scene that the program reads by itself, such as a list */
};

struct option_row {
    const char *name; /* --name; NULL: not on the command line */
    const char *key;  /* in the section; "camera.zoom" is {"camera": {"zoom": ...}}; NULL: not in a scene */
    enum option_type type;
    size_t at;                /* offset of the member in the struct of options, which holds the default; one out of
                                 range is no number but stands for what `help` tells */
    const char *argument;     /* what --help calls the value; NULL: a switch, or scene only */
    const char *help;         /* without range, words and default: they are added */
    double min, max;          /* of numbers; whole ones: at most 2^53 */
    int zero;                 /* 1: 0 is allowed beside [min, max] */
    const char *const *words; /* of a choice; ends with NULL */
    size_t automatic; /* a number may be "auto": offset of an int that tells (the number stays); 0: it may not */
    /* A text with a grammar: fills the member at `at`, any struct of at most OPTION_ROOM bytes. -1: an error that says
     * what to give. NULL: by type. */
    int (*parse)(const char *text, void *member);
    int letter; /* -letter; 0: none */
    int group;  /* rows of one group stand together in --help, in this order */
};

enum { OPTION_MOST = 64, OPTION_ROOM = 128 }; /* rows of one table; bytes of one member */

/* Is there a row at all? */
int option_is_row(const struct option_row *row);

/* The member from the argument of an option (NULL for a switch). -1: an error (EXIT_INPUT) that says what to give,
 * without naming the option: "give a number from 0 to 1". */
int option_take(const struct option_row *row, const char *text, void *options);

/* Help of the row, with its range or words, the default that `options` holds, and where it stands in the scene's
 * `section` (NULL: in none). To be freed; NULL: out of memory. */
char *option_describe(const struct option_row *row, const char *section, const void *options);

/* The scene's section by the same rows; what it leaves out stays as it is. Unknown keys, wrong types and values out of
 * range are errors with line and column (EXIT_INPUT). `given`: bit k set means that row k stood on the command line:
 * its key is judged, but the command line's value stays. Texts are borrowed from the scene. */
int options_read(const struct option_row *rows, const struct scene *scene, const char *section, uint64_t given,
                 void *options);

/* Position of a word among NULL-terminated ones; -1: an error that lists them. */
int option_choice(const char *text, const char *const words[]);

#endif
