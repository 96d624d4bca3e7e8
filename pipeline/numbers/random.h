/* Counter-based random numbers: a value depends on its key only, never on the order or the thread that asks.
 * splitmix64 finaliser (Steele, Lea and Flood, OOPSLA 2014) over a chain of keys. */
#ifndef PIPELINE_RANDOM_H
#define PIPELINE_RANDOM_H

#include <math.h>
#include <stdint.h>

static inline uint64_t random_bits(uint64_t key, uint64_t counter)
{
    uint64_t z = key + (counter + 1) * 0x9E3779B97F4A7C15u;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
}

/* Uniform in [0, 1). */
static inline double random_uniform(uint64_t key, uint64_t counter)
{
    return (double)(random_bits(key, counter) >> 11) * 0x1p-53;
}

/* Mean 0, variance 1 (Box and Muller 1958); uses counters 2 c and 2 c + 1 of the key. */
static inline double random_normal(uint64_t key, uint64_t counter)
{
    double u = 1.0 - random_uniform(key, 2 * counter), v = random_uniform(key, 2 * counter + 1);
    return sqrt(-2.0 * log(u)) * cos(6.283185307179586 * v);
}

#endif
