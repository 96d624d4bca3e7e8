/* From a rough place to a rim: falling edges along rays from the place, circles through three of them, the circle that
 * most rays support (Fischler and Bolles, CACM 24 (1981) 381), least squares on its supporters. */
#ifndef FINDGRAINS_CAPTURE_H
#define FINDGRAINS_CAPTURE_H

#include <stdint.h>

#include "findgrains/look/level.h"
#include "findgrains/capture/candidates.h"

/* `place`: a rough rim in level coordinates; `key`: of the random numbers; a
 * grain is brighter than the void by `least_contrast` at least. 1: *found holds a rim in level coordinates
 * with its support; 0: there is none. */
int capture_rim(const struct level *level, const struct rim *place, double void_level, uint64_t key,
                double least_contrast, struct candidate *found);

#endif
