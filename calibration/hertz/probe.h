/* A small-strain biaxial probe of a packing of discs (Qu et al., section 4): consolidate to an isotropic pressure,
 * raise the friction, shorten the height a little while the lateral stress is kept, relax to static equilibrium:
 * E = d sigma_y / d eps_y, nu = -d eps_x / d eps_y. */
#ifndef CALIBRATION_PROBE_H
#define CALIBRATION_PROBE_H

#include "simulation/dem/loading.h"

struct probe_options {
    double strain; /* of the height */
    double mu;     /* friction while it is probed */
};
#define PROBE_STRAIN 1e-5
#define PROBE_MU 1.0
#define PROBE_DEFAULT                                                                                                  \
    {                                                                                                                  \
        PROBE_STRAIN, PROBE_MU                                                                                         \
    }

/* A consolidated packing: probes start from copies of it. */
struct probe_packing {
    struct simulation simulation; /* lists are borrowed */
    struct loading loading;       /* after loading_begin() */
};
/* `simulation`: the packing, its pressure, its contact law (Hertz), friction during the compression. */
int probe_consolidate(const struct simulation *simulation, struct probe_packing *packing);
void probe_packing_free(struct probe_packing *packing);
/* The same packing with another law at the same pressure and the friction of the compression: relaxed again, not made
 * anew. */
int probe_adapt(const struct probe_packing *packing, const struct contact_law *law, struct probe_packing *adapted);

/* What a packing is like before it is probed. */
struct probe_fabric {
    double porosity, z;        /* voids over total; 2 N_c / N_p, contacts with walls counted once */
    double volume_per_contact; /* m2: S / N_c */
    double d50;                /* m: median diameter by number of grains */
};
void probe_fabric(const struct probe_packing *packing, struct probe_fabric *fabric);

struct probe_result {
    double young, poisson; /* N/m, 1: of the packing */
    struct probe_fabric fabric;
    long steps; /* time and relaxation steps, consolidation included */
    int rested; /* 1: both states came to rest */
};
/* Probe a copy of the packing as it stands. */
int probe_run(const struct probe_packing *packing, const struct probe_options *options, struct probe_result *result);

#endif
