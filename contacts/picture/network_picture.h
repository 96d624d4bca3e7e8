/* The histogram of the overlaps near zero with the fitted density, as an SVG file: whether the radii are right, and how
 * well contacts stand out against gaps. */
#ifndef CONTACTS_PICTURE_H
#define CONTACTS_PICTURE_H

#include "contacts/find_contacts.h"

/* Whole or not at all; an input error for another ending than .svg. */
int overlap_picture(const char *path, const struct contact_summary *summary);
int overlap_picture_is_svg(const char *path);

#endif
