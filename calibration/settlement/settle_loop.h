/* Settlement of a packing under many cycles with few of them simulated (Karrech and others, section 5): k_i cycles to
 * begin with, then k cycles are simulated, every grain and the box are extrapolated by h cycles, grains that overlap
 * too much are parted, the packing relaxes at the stress, and so on. */
#ifndef CALIBRATION_SETTLE_LOOP_H
#define CALIBRATION_SETTLE_LOOP_H

#include "calibration/settlement/settlement.h"
#include "calibration/settlement/unpress.h"
#include "simulation/dem/simulate.h"

struct settle_options {
    size_t initial, train, ahead; /* k_i, k, h; h = 0: every cycle is simulated */
    size_t cycles;                /* in all */
    enum trend_kind trend;
    int carry; /* 1: contacts keep their overlaps through a jump; 0: only where grains are extrapolated to (the paper)
                */
    double excess; /* part grains when the largest overlap exceeds so many times that before the jump */
};
#define SETTLE_DEFAULT                                                                                                 \
    {                                                                                                                  \
        .initial = 10, .train = 20, .ahead = 40, .cycles = 250, .trend = TREND_LOG, .carry = 1, .excess = 3            \
    }

/* One jump: the settlement that the trend of the height promises, and the one at which the packing came to rest. */
struct settle_jump {
    size_t cycle;                     /* to which it led */
    double before, promised, arrived; /* m */
};

struct settle_result {
    double *settlement; /* m, cycles + 1: height lost since cycle 0 at the end of each cycle; NaN: jumped over */
    double *z;          /* likewise: 2 N_c / N_p of the contacts between grains */
    size_t cycles, simulated, jumps, parted;
    struct settle_jump *jump; /* jumps */
    double height;            /* m: in state 0 */
    double *start, *end;      /* positions x0 y0 x1 y1 ... at cycle 0 and at the end */
    size_t grains;
    long steps;           /* time and relaxation steps: cost */
    size_t unrested;      /* states that did not come to rest */
    struct unpress worst; /* of the partings, the one with the largest overlap before */
    struct trend last;    /* of the height over the last training */
};
/* `simulation` is a cyclic test; its steps do not matter. */
int settle_run(const struct simulation *simulation, const struct settle_options *options, struct settle_result *result);
void settle_result_free(struct settle_result *result);

#endif
