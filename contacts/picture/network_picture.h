/* The histogram of the overlaps near zero with the fitted density, as a picture: whether the radii are right, and how
 * well contacts stand out against gaps. */
#ifndef CONTACTS_PICTURE_H
#define CONTACTS_PICTURE_H

#include "contacts/find_contacts.h"

/* A PNG, SVG or PDF by the path's ending, whole or not at all; an input error for other endings. Its title says what
 * was found out about the radii; without a histogram (too few pairs near zero) it is an empty chart. */
int overlap_picture(const char *path, const struct contact_summary *summary);

#endif
