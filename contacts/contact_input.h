/* What contacts is told: its options, and what is known of one photo. */
#ifndef CONTACTS_CONTACT_INPUT_H
#define CONTACTS_CONTACT_INPUT_H

#include "pipeline/packing/packing.h"
#include "pipeline/packing/patches.h"
#include "pipeline/scene/lens.h"
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

/* One photo and what belongs to it; all borrowed. Lengths in px of the photo but in `previous`, which is a state of
 * contacts. */
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

#endif
