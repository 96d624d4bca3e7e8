/* Are the results still made of what lies on the disk? */
#ifndef REPORT_VERIFY_H
#define REPORT_VERIFY_H

#include <stdio.h>

#include "pipeline/scene/scene.h"

struct verify_count {
    size_t files, inputs, wrong;
    size_t of_others; /* states that another version of the programs wrote: no difference, but worth a word */
};

/* Read every file whole (each column has a checksum) and compare the hash of every input that it names with that of
 * the file of this name: beside the state file, else among the photos, the lens and the loads of the scene; and of the
 * scene's part with that of the scene. One line on `stream` per file that is damaged and per input that differs or is
 * not there. A picture, table or page (.png .csv .html) has no checksums of its own: it and the states that it shows
 * are compared with the list that pipeline/stage left of them in the folder .sums beside it, one "SHA-256  NAME" a
 * line, its own first. -1 only when the work itself fails. */
int verify_files(const struct scene *scene, char *const paths[], size_t count, FILE *stream,
                 struct verify_count *found);

#endif
