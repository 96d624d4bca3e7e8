/* The scene in layers, painted onto one tile: grains in front, then hinges, frame, surroundings, void. */
#ifndef SIMULATION_LAYERS_H
#define SIMULATION_LAYERS_H

#include "simulation/render.h"
#include "simulation/tile.h"

/* Light of everything into tile->value. */
void layers_paint(const struct picture *picture, const struct optics *optics, struct tile *tile);

#endif
