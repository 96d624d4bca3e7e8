/* Expectation maximisation for the mixture in the header. The E step gives each pair its odds and, of the law of what
 * touches, the shares of its parts and E(t^2 | x); the M step sets shares to mean odds and the scale to the root of the
 * mean t^2 (which is a^2 for a half-normal law, 2 a^2 for Rayleigh's). All conditional moments are those of a normal
 * law cut at zero, mass, m_1 = u mass + edge, m_2 = u m_1 + v^2 mass, m_3 = u m_2 + 2 v^2 m_1, by parts.
 *
 * Each round is linear in the pairs but converges slowly where the laws overlap. Every two rounds are extrapolated
 * (SQUAREM, Varadhan and Roland, Scand. J. Statist. 35 (2008) 335, in log ratios, which keep shares positive); a step
 * that lowers the likelihood is taken back. */
#include "contacts/radii/pair_statistics.h"

#include <float.h>
#include <math.h>

enum { MAX_ROUNDS = 300, FREE = 5 };
#define CONVERGED 1e-4     /* change of a share, relative change of a scale */
#define LEAST_PART 0.02    /* of each of the three laws */
#define WIDE 3.0           /* scale of the wide law over that of the others */
#define LEAST_RESTING 1e-3 /* where the next fit starts: a share of zero would stay zero */
#define LONGEST_STEP 32.0
#define ROOT_2_OVER_PI 0.79788456080286536
#define ROOT_PI_OVER_2 1.2533141373155003
/* Pseudo-pairs: what is believed before any pair has been seen. */
#define PRIOR_TOUCHING 2.0
#define PRIOR_RESTING 0.2
#define PRIOR_APART 1.0

/* Mean overlap over scale. */
static double mean_over_scale(const struct pair_statistics *st)
{
    return (st->flat + WIDE * st->wide) * ROOT_2_OVER_PI + (1 - st->flat - st->wide) * ROOT_PI_OVER_2;
}

double pair_mean_overlap(const struct pair_statistics *st)
{
    return mean_over_scale(st) * st->scale;
}

#define ROOT_2PI 2.5066282746310002
#define FAR 8.0 /* standard errors beyond which one of the cases alone is left */

static double normal_density(double z)
{
    return exp(-0.5 * z * z) / ROOT_2PI;
}

static double normal_mass(double z)
{
    return z > FAR ? 1 : 0.5 * erfc(-z * M_SQRT1_2);
}

/* A position without any error still has rounding. */
static double usable_error(const struct pair_statistics *st, double s)
{
    return fmax(s, 1e-6 * st->window);
}

/* The normal law of t given x under a scale, cut at zero: its mass and moments, each times N(x; 0, q). */
struct cut_normal {
    double mass, first, second, third;
};

static struct cut_normal cut_normal(double scale, double x, double s)
{
    double q2 = scale * scale + s * s, q = sqrt(q2), u = x * scale * scale / q2, v2 = scale * scale * s * s / q2;
    double v = scale * s / q, z = u / v, density = normal_density(x / q) / q;
    double mass = density * normal_mass(z), edge = z > FAR ? 0 : density * v * normal_density(z);
    double first = fmax(u * mass + edge, 0), second = fmax(u * first + v2 * mass, 0);
    return (struct cut_normal){mass, first, second, fmax(u * second + 2 * v2 * first, 0)};
}

/* The odds of one pair, and what the next round needs of it: the shares of two of the laws among what touches, and the
 * mean of t^2 over the square of its law's scale. */
struct pair_moments {
    struct pair_odds odds;
    double flat, wide, square;
};

static struct pair_moments moments_of(const struct pair_statistics *st, double x, double s)
{
    s = usable_error(st, s);
    if (x < -FAR * s) /* apart for sure */
        return (struct pair_moments){.odds = {0, 0, 1, log(st->apart / st->window)}};
    double a = st->scale;
    if (x > 30 * fmax(a, s)) /* squeezed for sure, beyond all that the density knows */
        return (struct pair_moments){{1, 0, 0, -450}, st->flat, st->wide, pow(x / a, 2)};
    struct cut_normal cut = cut_normal(a, x, s), broad = cut_normal(WIDE * a, x, s);
    double flat = 2 * st->flat * cut.mass, wide = 2 * st->wide * broad.mass;
    double hump = ROOT_2PI * (1 - st->flat - st->wide) * cut.first / a, law = fmax(flat + wide + hump, DBL_MIN);
    double resting = x > FAR * s ? 0 : st->resting * normal_density(x / s) / s;
    double apart = x > FAR * s ? 0 : st->apart / st->window * normal_mass(-x / s);
    double touching = st->touching * law, sum = touching + resting + apart;
    double square = (cut.mass > 0 ? flat * cut.second / cut.mass : 0) +
                    (cut.first > 0 ? hump * cut.third / cut.first : 0) +
                    (broad.mass > 0 ? wide * broad.second / broad.mass / (WIDE * WIDE) : 0);
    return (struct pair_moments){.odds = {touching / sum, resting / sum, apart / sum, log(sum)},
                                 .flat = flat / law,
                                 .wide = wide / law,
                                 .square = square / (law * a * a)};
}

struct pair_odds pair_odds(const struct pair_statistics *statistics, double x, double s)
{
    return moments_of(statistics, x, s).odds;
}

/* First guess: what is positive touches. */
static void first_guess(const double *x, const double *s, size_t count, struct pair_statistics *st)
{
    double touching = 0, overlap = 0, error = 0;
    for (size_t k = 0; k < count; k++) {
        if (!(x[k] >= -st->window))
            continue;
        st->pairs++;
        error += s[k];
        if (x[k] > 0) {
            touching++;
            overlap += x[k];
        }
    }
    double pairs = (double)st->pairs, sum = pairs + PRIOR_TOUCHING + PRIOR_APART;
    double mean = touching > 0 ? overlap / touching : 0.1 * st->window;
    mean = fmax(mean, fmax(st->pairs ? 0.25 * error / pairs : 0, 1e-6 * st->window));
    st->flat = 0.5;
    st->wide = 0.1;
    st->scale = mean;
    st->resting = 0.05;
    st->touching = 0.95 * (touching + PRIOR_TOUCHING) / sum;
    st->apart = 0.95 * (pairs - touching + PRIOR_APART) / sum;
}

static void keep_inside(struct pair_statistics *st)
{
    st->scale = fmax(st->scale, 1e-6 * st->window);
    double flat = fmax(st->flat, LEAST_PART), wide = fmax(st->wide, LEAST_PART);
    double sum = flat + wide + fmax(1 - st->flat - st->wide, LEAST_PART);
    st->flat = flat / sum;
    st->wide = wide / sum;
}

/* The scale with which the overlaps add up to what is known. */
static double scale_of_sum(const struct pair_statistics *st, double sum)
{
    return sum / ((double)st->pairs * st->touching * mean_over_scale(st));
}

/* One round; the guess counts as PRIOR pairs. Returns the largest change. log_likelihood is that of before. */
static double improve(const double *x, const double *s, size_t count, const struct pair_premises *premises,
                      const struct pair_statistics *guess, struct pair_statistics *st)
{
    double touching = PRIOR_TOUCHING, resting = guess->resting > 0 ? PRIOR_RESTING : 0, apart = PRIOR_APART;
    double flat = touching * guess->flat, wide = touching * guess->wide;
    double square = (2 * touching - flat - wide) * pow(guess->scale / st->scale, 2);
    st->log_likelihood = 0;
    for (size_t k = 0; k < count; k++) {
        if (!(x[k] >= -st->window))
            continue;
        struct pair_moments pair = moments_of(st, x[k], s[k]);
        touching += pair.odds.touching;
        resting += pair.odds.resting;
        apart += pair.odds.apart;
        flat += pair.odds.touching * pair.flat;
        wide += pair.odds.touching * pair.wide;
        square += pair.odds.touching * pair.square;
        st->log_likelihood += pair.odds.log_density;
    }
    struct pair_statistics old = *st;
    double sum = touching + resting + apart;
    st->touching = touching / sum;
    st->resting = resting / sum;
    st->apart = apart / sum;
    if (premises->sum > 0) {
        st->scale = scale_of_sum(st, premises->sum);
    } else {
        st->flat = flat / touching;
        st->wide = wide / touching;
        st->scale *= sqrt(square / (2 * touching - flat - wide)); /* the mean of t^2 is a^2, and 2 a^2 for Rayleigh */
    }
    keep_inside(st);
    double shares = fmax(fabs(st->touching - old.touching), fabs(st->resting - old.resting));
    return fmax(shares,
                fmax(fabs(log(st->scale / old.scale)), fmax(fabs(st->flat - old.flat), fabs(st->wide - old.wide))));
}

/* The numbers as free ones: log ratios of the shares, log of the scale, log ratios of the laws. */
static void to_free(const struct pair_statistics *st, double free[FREE])
{
    free[0] = log(st->touching / st->apart);
    free[1] = log(fmax(st->resting, DBL_MIN) / st->apart);
    free[2] = log(st->scale);
    free[3] = log(st->flat / (1 - st->flat - st->wide));
    free[4] = log(st->wide / (1 - st->flat - st->wide));
}

static void from_free(const double free[FREE], struct pair_statistics *st)
{
    double touching = exp(free[0]), resting = exp(free[1]), sum = 1 + touching + resting;
    st->touching = touching / sum;
    st->resting = resting / sum;
    st->apart = 1 / sum;
    st->scale = exp(free[2]);
    double flat = exp(free[3]), wide = exp(free[4]);
    st->flat = flat / (1 + flat + wide);
    st->wide = wide / (1 + flat + wide);
    keep_inside(st);
}

/* Squared extrapolation (Varadhan and Roland 2008, scheme S3): two rounds tell where the row of rounds is going. */
static void extrapolate(const double a[FREE], const double b[FREE], const double c[FREE], struct pair_statistics *st)
{
    double first = 0, second = 0, to[FREE];
    for (int k = 0; k < FREE; k++) {
        first += pow(b[k] - a[k], 2);
        second += pow(c[k] - 2 * b[k] + a[k], 2);
    }
    double step = second > 0 ? fmin(fmax(1, sqrt(first / second)), LONGEST_STEP) : 1;
    for (int k = 0; k < FREE; k++)
        to[k] = a[k] + 2 * step * (b[k] - a[k]) + step * step * (c[k] - 2 * b[k] + a[k]);
    from_free(to, st);
}

void pair_statistics_fit(const double *x, const double *s, size_t count, const struct pair_premises *premises,
                         const struct pair_statistics *start, struct pair_statistics *st)
{
    struct pair_statistics guess = {.window = premises->window}, good;
    int rests = premises->rests;
    double at[3][FREE];
    first_guess(x, s, count, &guess);
    guess.resting = rests ? guess.resting : 0;
    *st = guess;
    if (start) {
        *st = *start;
        st->window = premises->window;
        st->pairs = guess.pairs;
        st->resting = rests ? fmax(st->resting, LEAST_RESTING) : 0;
    }
    good = *st;
    good.log_likelihood = -INFINITY;
    for (int round = 0; round < MAX_ROUNDS; round += 2) {
        to_free(st, at[0]);
        double change = improve(x, s, count, premises, &guess, st);
        if (st->log_likelihood < good.log_likelihood - 1e-6) { /* went too far */
            *st = good;
            continue;
        }
        to_free(st, at[1]);
        if (change < CONVERGED)
            break;
        improve(x, s, count, premises, &guess, st);
        to_free(st, at[2]);
        good = *st;
        extrapolate(at[0], at[1], at[2], st);
    }
}

void pair_statistics_shares(const double *x, const double *s, size_t count, const struct pair_statistics *like,
                            struct pair_statistics *st)
{
    const struct pair_premises premises = {.window = like->window, .rests = 1};
    struct pair_statistics guess = {.window = like->window};
    first_guess(x, s, count, &guess);
    *st = *like;
    st->pairs = guess.pairs;
    st->touching = st->resting = st->apart = 1.0 / 3;
    for (int round = 0; round < MAX_ROUNDS; round++) {
        struct pair_statistics old = *st;
        improve(x, s, count, &premises, &guess, st);
        st->scale = like->scale;
        st->flat = like->flat;
        st->wide = like->wide;
        if (fmax(fabs(st->touching - old.touching), fabs(st->resting - old.resting)) < CONVERGED)
            break;
    }
}
