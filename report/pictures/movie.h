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

/* All files must be packings; the view is the box around all of them, the unit of width the mean over all states of the
 * method that is drawn. One DIR/NAME.png per file, NAME: the file's base name up to its first dot. The folder is made
 * when it is absent, and taken away again when no frame came to be. -1 with the error set at the first file that cannot
 * be read or drawn; frames before it stay. */
int movie_write(const struct movie *movie, char *const paths[], size_t count, const char *folder);

#endif
