/* The commands of the program `scene`. */
#ifndef PIPELINE_SCENE_COMMANDS_H
#define PIPELINE_SCENE_COMMANDS_H

#include "pipeline/plan/plan.h"

enum scene_command {
    SCENE_CHECK,
    SCENE_PHOTOS,
    SCENE_SERIES,
    SCENE_PART,
    SCENE_PLAN,
    SCENE_BEGIN,
    SCENE_STATUS,
    SCENE_RESULTS
};
/* Their names, in the order of the enum; NULL-terminated. */
extern const char *const SCENE_COMMANDS[];

/* What may stand behind a command. */
struct scene_words {
    const char *scene;      /* its path */
    const char *part;       /* SCENE_PART: whose */
    struct plan_words plan; /* out "": the folder `results` beside the scene; the programs are found here */
    int make;               /* SCENE_PLAN: as a makefile, else as lines of JSON */
};

/* Does it, and prints to standard output what there is to say. -1 with an error. */
int scene_run(enum scene_command command, const struct scene_words *words);

#endif
