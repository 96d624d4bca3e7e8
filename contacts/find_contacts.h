/* The contact network of one photo in SI units: grains, walls and every pair that touches or may touch, with its
 * overlap, its probability and its motion. Photo pixels end here. */
#ifndef CONTACTS_FIND_CONTACTS_H
#define CONTACTS_FIND_CONTACTS_H

#include "pipeline/scene/lens.h"
#include "pipeline/packing/packing.h"
#include "pipeline/packing/patches.h"
#include "pipeline/scene/scene.h"

struct contact_options {
    int radius_scale_auto, radius_offset_auto; /* 1: found from the photo; not both */
    double radius_scale;                       /* every radius times this, */
    double radius_offset_px;                   /* plus this */
    double tolerance_px;     /* NaN: decide by probability; else a contact is what overlaps more than -tolerance */
    double candidate_sigmas; /* pairs whose overlap is within so many standard errors of zero are kept */
    int repair;              /* promote candidates that a loaded grain cannot stand without */
    double frame_error_px;   /* standard error of the frame's corners in the scene; 0: exact */
};
#define CONTACT_OPTIONS_DEFAULT                                                                                        \
    {                                                                                                                  \
        .radius_scale = 1, .radius_offset_px = 0, .tolerance_px = NAN, .candidate_sigmas = 4, .frame_error_px = 0.3    \
    }

struct contact_input {
    const struct scene *scene;
    const struct photo_grains *grains; /* of findgrains or tracker */
    const struct patches *patches;     /* NULL: none */
    const struct packing *previous;    /* NULL: none */
    const struct lens *lens;           /* NULL: none. Undone for the frame, and for grains that are as seen */
    int seen;                          /* the grains are where the photo shows them; 0: the lens is undone already */
    const struct photo_grains *const *more_radii; /* further measurements of the radii and rims of the same rows */
    size_t more_count;
    int64_t index;    /* of the photo, for the scene's loads */
    int is_reference; /* this photo is the reference: no motion yet */
};

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
    double resting_share;     /* of near pairs: those that rest at zero overlap */
    double indeterminacy;     /* h and k of packing_indeterminacy(); NaN until then */
    double mechanisms;        /* k */
    struct overlap_histogram histogram;
};

/* packing must be zeroed; it is left empty on failure. packing->info.strain is the strain between the walls. Loads
 * are not applied (loads_apply). summary may be NULL. */
int find_contacts(const struct contact_input *input, const struct contact_options *options, struct packing *packing,
                  struct contact_summary *summary);

/* packing_indeterminacy() with the friction of the scene (not given: friction everywhere), into packing and summary;
 * apply the loads first. 0, or -1 when out of memory. */
int contact_indeterminacy(const struct scene *scene, struct packing *packing, struct contact_summary *summary);

#endif
