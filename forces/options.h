/* Options of forces: the scene's section "forces" and contact law, and the text that goes into the file. */
#ifndef FORCES_OPTIONS_H
#define FORCES_OPTIONS_H

#include "forces/infer_forces.h"
#include "pipeline/scene/scene.h"

/* Which methods, in which order; a list like "cem,qsm". */
struct method_list {
    enum force_method method[METHOD_COUNT + METHODS_ADDED_MOST];
    int count;
};
/* 0, or -1 with an error that lists the methods; no method may stand there twice. */
int method_list_parse(const char *text, struct method_list *list);

/* Fill what the scene gives; `list` and `options` keep their values where it is silent. */
int force_options_read(const struct scene *scene, struct method_list *list, struct force_options *options);
/* JSON of everything that changes numbers; to be freed with free(). */
char *force_options_text(const struct method_list *list, const struct force_options *options);

#endif
