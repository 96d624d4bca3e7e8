/* Contact laws compared on one small-strain probe (Tolomeo and McDowell 2022, in the plane): the same loose packing,
 * consolidated under each law, is shortened in growing steps at constant lateral stress; tangent modulus, and which
 * contacts load for the first time, unload, or reload, and how they lie. */
#ifndef CALIBRATION_LAWS_H
#define CALIBRATION_LAWS_H

#include "calibration/hertz/probe.h"

enum law_group { GROUP_LOADING, GROUP_UNLOADING, GROUP_RELOADING, GROUPS };
extern const char *const GROUP_NAMES[GROUPS];

/* From one static state to the next. */
struct law_step {
    double strain;        /* at its end */
    double young;         /* N/m: d sigma_y / d eps_y over the step */
    double deviator;      /* N/m: sigma_y - sigma_x at its end */
    size_t count[GROUPS]; /* contacts */
    double angle[GROUPS]; /* rad from the horizontal, 0 to pi/2: main direction of their normals; NaN: none */
    int rested;
};

struct law_curve {
    struct contact_law law;
    struct probe_fabric fabric; /* consolidated */
    double mean_stiffness;      /* N/m: of the contacts, consolidated */
    double mobilised;           /* mean of fn / largest fn so far over the contacts, consolidated */
    struct law_step *steps;
    size_t count, loading; /* steps; those before the strain turns back */
};
void law_curve_free(struct law_curve *curve);

struct law_probe {
    double first, last; /* strains of the first and the last loading step */
    int per_decade;
    int back; /* so many steps back, to half of the strain */
};
#define LAW_PROBE_DEFAULT                                                                                              \
    {                                                                                                                  \
        .first = 1e-7, .last = 1e-3, .per_decade = 3, .back = 4                                                        \
    }

/* `simulation`: the packing and its pressure; its law is replaced. */
int law_compare(const struct simulation *simulation, const struct contact_law *law, const struct law_probe *probe,
                struct law_curve *curve);

#endif
