/* Statistics of the contacts of one state. */
#ifndef REPORT_DISTRIBUTION_H
#define REPORT_DISTRIBUTION_H

#include "pipeline/packing/packing.h"

enum { DISTRIBUTION_BINS = 24, ROSE_BINS = 36 };

/* Probability density of fn / <fn> over loaded contacts; bin b covers 0.25 b to 0.25 (b + 1), larger forces are left
 * out of the bins but not of the total. NaN where a bin is empty. Returns the number of loaded contacts. */
size_t force_distribution(const struct forces *forces, double density[DISTRIBUTION_BINS]);
#define DISTRIBUTION_STEP 0.25

/* Contact directions in bins of 10 degrees from -5 degrees on, both n and -n counted, candidates and walls left out
 * (thesis Fig. 4.20). share: of the mean over all bins. mean_fn: of the contacts in the bin, over that of all; may be
 * NULL with forces NULL. */
void contact_rose(const struct packing *packing, const struct forces *forces, double share[ROSE_BINS],
                  double mean_fn[ROSE_BINS]);

#endif
