/* What contacts says about its network beside the tables: numbers for the log, the picture and the attributes. */
#ifndef CONTACTS_CONTACT_SUMMARY_H
#define CONTACTS_CONTACT_SUMMARY_H

#include <stddef.h>

/* How overlaps are spread near zero, and what the fitted density says: pairs per bin, of grains that can be squeezed
 * and of those with an idle one (contact_network.h). */
enum { HISTOGRAM_BINS = 60 };
struct overlap_histogram {
    double low_px, width_px;
    double bearing[HISTOGRAM_BINS], idle[HISTOGRAM_BINS];
    double fit_bearing[HISTOGRAM_BINS], fit_idle[HISTOGRAM_BINS];
};

/* What was found, for people. */
struct contact_summary {
    size_t grains, unusable; /* rows; rows with a number missing: they touch nothing */
    size_t contacts, wall_contacts, candidates;
    size_t rattlers, floating, promoted;
    double mean_overlap_px, s_overlap_px;      /* of touching pairs; median standard error of an overlap */
    double radius_scale, radius_offset_px;     /* as used */
    double s_radius_scale, s_radius_offset_px; /* of an automatic one; 0: given */
    const char *undecided;                     /* why an automatic one was left out; NULL: it was not */
    const char *doubt;        /* why one that was found should not be relied on; NULL: nothing speaks against it */
    double loaded_overlap_px; /* mean overlap of touching pairs that the loads give; 0: they give none, or none was
                                 sought */
    /* Looked at where a contact network is missing (contacts_are_few()) or `undecided` says something: pairs of grains
     * with gaps below near_px, and their median gap; 0, 0 and NaN otherwise. */
    size_t near;
    double near_px, gap_px;
    double resting_share; /* of near pairs: those that rest at zero overlap */
    double indeterminacy; /* h and k of packing_indeterminacy(); NaN until then */
    double mechanisms;    /* k */
    struct overlap_histogram histogram;
};

#endif
