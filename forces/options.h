/* What a user may say to forces, on the command line and in the scene's section "forces", and the text that goes into
 * the file. */
#ifndef FORCES_OPTIONS_H
#define FORCES_OPTIONS_H

#include "forces/infer_forces.h"
#include "forces/series/series.h"
#include "pipeline/command/cli.h"
#include "pipeline/scene/scene.h"

/* Which methods, in which order, from a list like "cem,qsm"; or series alone. */
struct method_list {
    enum force_method method[METHOD_COUNT + METHODS_ADDED_MOST];
    int count;
    int series; /* 1: all states together, and count is 0 */
};
/* 0, or -1 with an error that lists the methods; no method may stand there twice. */
int method_list_parse(const char *text, struct method_list *list);

struct start_choice {
    enum force_start how;
    const char *file; /* START_FILE: forces to start from; else NULL */
};

struct force_arguments {
    struct cli cli;
    struct method_list methods;
    struct start_choice start;
    const char *previous, *fclib; /* paths; NULL: none */
    struct force_options options;
    struct series_options series;
    double shape_px; /* the unit in which the scene gives series.shape; NaN: not given */
};
#define FORCE_ARGUMENTS_DEFAULT                                                                                        \
    {                                                                                                                  \
        .cli = CLI_DEFAULT, .methods = {{METHOD_MAP}, 1, 0}, .options = FORCE_OPTIONS_DEFAULT,                         \
        .series = SERIES_OPTIONS_DEFAULT, .shape_px = NAN                                                              \
    }

/* The command line; a wrong one ends the program. */
void force_arguments_parse(int argc, char **argv, struct force_arguments *arguments);
/* Add the scene's contact law and section "forces" where the command line is silent, and judge them together. -1: an
 * error of the scene (EXIT_INPUT), or of a command line that its method does not take (EXIT_USAGE). */
int force_arguments_read(const struct scene *scene, struct force_arguments *arguments);
/* JSON of everything that changes numbers; to be freed with free(). */
char *force_options_text(const struct method_list *list, const struct force_options *options);

#endif
