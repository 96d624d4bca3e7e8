/* The frames of a film: force maps of a series in one view and with one unit of width. */
#ifndef REPORT_MOVIE_H
#define REPORT_MOVIE_H

#include "pipeline/scene/scene.h"

struct movie {
    const char *method; /* NULL: one for all files (report/states/method_choice.h); each file's default where they have
                           none in common */
    const struct scene *scene; /* over its photos; NULL: over circles */
    double width;              /* px */
};

/* One DIR/NAME.png per file, NAME: the file's base name up to its first dot. The folder is made when it is absent. */
int movie_write(const struct movie *movie, char *const paths[], size_t count, const char *folder);

#endif
