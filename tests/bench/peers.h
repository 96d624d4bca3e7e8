/* What else finds circles: OpenCV's two Hough transforms, the distance transform of a thresholded photo, and ellipses
 * through the outlines of its parts, each with one setting that works on these photos. */
#ifndef TESTS_BENCH_PEERS_H
#define TESTS_BENCH_PEERS_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum peer { PEER_HOUGH_GRADIENT, PEER_HOUGH_GRADIENT_ALT, PEER_DISTANCE_TRANSFORM, PEER_CONTOURS, PEERS };

/* Circles x y r (px of the photo) into `circles`, at most `room`; returns how many. `shrink`: search at so many times
 * coarser pixels. */
int peer_find(enum peer peer, const uint16_t *pixels, int width, int height, int shrink, double radius_min,
              double radius_max, double (*circles)[3], int room);

#ifdef __cplusplus
}
#endif

#endif
