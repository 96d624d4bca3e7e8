/* The scene in layers, painted onto one tile: faces in front, then flanks, then the backdrop. */
#ifndef SIMULATION_LAYERS_H
#define SIMULATION_LAYERS_H

#include "simulation/render/picture.h"
#include "simulation/render/tile.h"

/* Keys of what is painted; each body adds its own number. */
enum body {
    BODY_GRAIN,
    BODY_HOLLOW,
    BODY_FRAME,
    BODY_HINGE,
    BODY_OUTSIDE,
    BODY_RING,
    BODY_LEVEL,
    BODY_PLATE,
    BODY_LINE
};
uint64_t body_key(const struct optics *optics, enum body body, size_t number);

/* faces.c: light of the rods into tile->value, and what they hide into tile->cover. */
void faces_paint(const struct picture *picture, const struct optics *optics, struct tile *tile);
/* backdrop.c: everything behind them into tile->back. */
void backdrop_paint(const struct picture *picture, const struct optics *optics, struct tile *tile);
/* Light of everything into tile->value. */
void layers_paint(const struct picture *picture, const struct optics *optics, struct tile *tile);

#endif
