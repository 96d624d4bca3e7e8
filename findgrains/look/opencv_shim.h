/* The few OpenCV functions that help, behind a C interface. Whatever OpenCV throws becomes an error line and -1. Rows
 * of floats follow each other without gaps; nothing is allocated for the caller. */
#ifndef FINDGRAINS_OPENCV_SHIM_H
#define FINDGRAINS_OPENCV_SHIM_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Resample the window (x0, y0, width, height) of a 16-bit picture with `stride` pixels per row to
 * out_width x out_height floats: pixel areas when it shrinks, cubic when it grows. */
int shim_resample(const uint16_t *pixels, int stride, int x0, int y0, int width, int height, int out_width,
                  int out_height, float *out);
/* Scharr derivatives, in grey levels per pixel. */
int shim_gradient(const float *pixels, int width, int height, float *gx, float *gy);
/* In-place sum over 3 x 3 pixels, zero outside. */
int shim_sum3(float *pixels, int width, int height);

#ifdef __cplusplus
}
#endif

#endif
