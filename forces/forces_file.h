/* Forces into the packing that they belong to, and that packing into its file. */
#ifndef FORCES_FORCES_FILE_H
#define FORCES_FORCES_FILE_H

#include "pipeline/packing/packing.h"
#include "pipeline/scene/scene.h"

/* The worst verdict of a run: the first forces that were worse than those before. */
struct verdict_seen {
    enum verdict verdict; /* VERDICT_UNKNOWN: none was seen */
    char method[NAME_LENGTH], reasons[1000];
    const char *input; /* whose forces */
    size_t states, of_them_void;
    char summary[400]; /* of the forces that were seen, each in some words */
};
void verdict_note(struct verdict_seen *seen, const char *input, const struct packing *packing,
                  const struct forces *forces);

/* Was the packing of that file made with the scene as it says now (state/freshness.h), and with its loads? 0, or -1
 * with an error that names the key. */
int check_fresh(const char *path, const struct packing *packing, const struct scene *scene);

/* Takes the forces over (`forces` is empty afterwards); an old result of the same method gives way. */
int forces_take_in(struct packing *packing, struct forces *forces);
/* Writes N.forces.hdf: the packing with all its forces, how they came about (JSON), and the files they came from. The
 * file is whole or absent. */
int forces_write(const char *path, const struct packing *packing, const struct scene *scene, const char *parameters,
                 const char *const *inputs, size_t count);

#endif
