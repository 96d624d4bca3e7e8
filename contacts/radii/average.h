/* Radii and rim shapes measured in several photos of a series, averaged: the rods do not change. */
#ifndef CONTACTS_AVERAGE_H
#define CONTACTS_AVERAGE_H

#include "contacts/contact_input.h"

/* Set radius, s_radius and, where a photo has them, shape_c shape_s s_shape (m, before any correction) from this photo
 * and the further ones: the mean of the measurements with weights 1/s^2; rows that are flagged or have no number in a
 * photo do not count there. The error is that of the weighted mean, enlarged by sqrt(chi^2 / (n - 1)) where the
 * measurements scatter more than they state. Shapes are turned with the grain: in all files they are given at the
 * orientation of the reference, angle 0. */
int average_rims(const struct contact_input *input, struct grains *grains);

#endif
