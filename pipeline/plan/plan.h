/* What has to be made from what in a series: every result of a scene, the command that makes it, and all that it is
 * made from. Only this says so; make, Snakemake and Slurm run it (pipeline/Makefile, pipeline/Snakefile).
 *
 * A result has a name that needs no quoting anywhere: NNNN.grains.hdf (reference photo), NNNN.tracks.hdf,
 * NNNN.contacts.hdf, NNNN.forces.hdf, NNNN.forces.png (each photo), series.csv (all states together), report.html.
 * Commands run in the folder of the results and call results by these names; every other path in them is absolute. */
#ifndef PIPELINE_PLAN_H
#define PIPELINE_PLAN_H

#include <stddef.h>

#include "pipeline/scene/scene.h"

enum plan_stage { PLAN_FINDGRAINS, PLAN_TRACKER, PLAN_CONTACTS, PLAN_FORCES, PLAN_REPORT, PLAN_STAGES };
/* Names of the programs, in the order of the enum; they also name the parts of a scene (scene_part()). */
extern const char *const PLAN_STAGE[PLAN_STAGES];

enum plan_kind {
    RESULT_GRAINS,
    RESULT_TRACKS,
    RESULT_CONTACTS,
    RESULT_TABLE,
    RESULT_FORCES,
    RESULT_PICTURE,
    RESULT_PAGE
};

/* A result without its commands: what a table of the state of a series needs. */
struct plan_name {
    enum plan_kind kind;
    long photo; /* 0 for the first photo of the series that counts, 1 for the next; of the page and the table: 0 */
    char name[32];
};

/* What the command line says of a series; "" where it says nothing. */
struct plan_words {
    const char *out;      /* folder of the results; need not be there */
    const char *method;   /* methods of forces, "map,qsm" or "series"; else the scene's */
    const char *start;    /* what forces starts from; else the scene's */
    const char *programs; /* absolute path of the folder with the programs */
    const char *runner;   /* path of a program that runs each command (pipeline/stage) */
    int allow_outside;    /* 1: the programs are told so */
};

struct plan {
    const struct scene *scene; /* borrowed, as are the words */
    struct plan_words words;
    int folder;              /* words.out, opened; -1 where it is not there: then all that lies in it is missing */
    char *scene_path;        /* absolute */
    char *part[PLAN_STAGES]; /* what a stage's results depend on besides files: its part of the scene, and for forces
                                and report a line "METHOD START" */
    int together;            /* 1: forces of all photos in one run (method series) */
    long photos;             /* >= 1: those that count (scene_photo_next()) */
    long *number;            /* of each of them, ascending */
    char *there;             /* of each of them: can its file be read? Photos that cannot have results that will fail;
                                the others, series.csv and the page are made without them */
    size_t count;            /* results: 4 photos + 2, and series.csv where together */
};

/* -1 with an error: the scene has no photos.pattern; more than 100,000 photos (10,000 where all are taken together:
 * their names are one command line); no memory. Then nothing has to be freed. */
int plan_make(struct plan *plan, const struct scene *scene, const struct plan_words *words);
void plan_free(struct plan *plan);

/* The k-th result, k < count, so ordered that each one comes after those that it is made from. */
struct plan_name plan_name(const struct plan *plan, size_t k);
/* Is it of one of these kinds (bits), and of a photo that is there? */
int plan_is_made(const struct plan *plan, const struct plan_name *of, unsigned kinds);

/* Everything about one result. */
struct product {
    struct plan_name of;
    enum plan_stage stage; /* whose part of the scene it depends on, and whose program makes it */
    char job[32];          /* results of one job are made one after the other on one machine: "tracks_0", "page" */
    char *command;         /* of bash: program and arguments but -o, behind RUNNER NAME where there is a runner;
                              "": the command of another result makes this one */
    char *needs;           /* names of the results that it is made from, separated by spaces */
    char *reads[4];        /* absolute paths of the other files: photos, lens, loads, forces to start from */
    size_t read_count;
};

/* -1 with an error: a path leads out of the scene's folder; no memory. Then nothing has to be freed. */
int plan_product(const struct plan *plan, size_t k, struct product *product);
void product_free(struct product *product);

/* The files in the folder .scene of the results that hold further words of a command, one name a line: the states that
 * the page shows, the contacts that forces takes together. */
enum { PLAN_STATES = 1 << RESULT_GRAINS | 1 << RESULT_TRACKS | 1 << RESULT_CONTACTS | 1 << RESULT_FORCES };
#define PLAN_PAGE_LIST ".scene/page.list"
#define PLAN_CONTACTS_LIST ".scene/contacts.list"

#endif
