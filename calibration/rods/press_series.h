/* From tracks files and a force record to the force-deflection curve of two rods. */
#ifndef CALIBRATION_PRESS_SERIES_H
#define CALIBRATION_PRESS_SERIES_H

#include "calibration/rods/stiffness.h"
#include "pipeline/packing/grains.h"

/* A force record: CSV with the header "time_s,force_N" or "index,force_N", in growing order. */
struct force_record {
    size_t count;
    int by_index;
    double *at, *force; /* s or photo index; N */
};
int force_record_read(const char *path, struct force_record *record);
void force_record_free(struct force_record *record);
/* Force at a time or index, interpolated; NaN outside the record. */
double force_record_at(const struct force_record *record, double at);

/* One photo: where it stands in time, and its tracked grains (px). */
struct press_photo {
    int64_t index;
    double time; /* s */
    struct photo_grains grains;
};

struct press_series_options {
    long rods[2]; /* rows of the two rods */
    double scale; /* m/px */
    double delay; /* s (or photos): added to the photos' time to give the record's */
};

/* Deflections between the two rods since the first photo that shows both; a photo in
 * which a rod is flagged, or outside the record, keeps its row with used = 0. */
int press_series_points(const struct press_photo *photos, size_t count, const struct force_record *record,
                        const struct press_series_options *options, struct press_point *points);
/* Read a tracks file's grains, index and time. */
int press_photo_read(const char *path, struct press_photo *photo);
void press_photo_free(struct press_photo *photo);

#endif
