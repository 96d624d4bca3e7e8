/* Laws of elastic bodies, smooth and rough. With E* and R of contact_law.h:
 *
 * Hertz                F = 4/3 E* R^1/2 x^3/2, k = dF/dx = 2 E* (R x)^1/2 = (6 E*^2 R F)^1/3; integrated over F,
 *                      x = 3/2 F^2/3 / (6 E*^2 R)^1/3, and the integral of F dx is 2/5 F x
 * rough (Pohrt and     k = C F^a below F_H, a = 0.2567 D_f, C = (pi/10) D_f E* A0^1/2 (h E* A0^1/2)^-a, hence
 *  Popov)              F = ((1 - a) C x)^(1/(1 - a)) and the integral of F dx is (1 - a) / (2 - a) F x; Hertz's k
 *                      above F_H, where the asperities are pressed flat over A0
 * rough, plastic       this on virgin loading; Hertz's k on unloading from the largest force and on reloading to it
 * tangential           kt = k kt_over_kn, Mindlin's ratio
 *
 * Sources: Johnson, Contact Mechanics, 1985, chapters 4 and 7; Pohrt and Popov, Phys. Rev. Lett. 108, 104301,
 * 2012; as put together by Tolomeo and McDowell 2022. */
#include "pipeline/laws/contact_law.h"

#include <float.h>
#include <math.h>

/* E* = E / (2 (1 - nu^2)) of two bodies of one material. */
static double plane_modulus(const struct contact_law *law)
{
    return 0.5 * law->young / (1 - law->poisson * law->poisson);
}

static struct contact_pair smooth_pair(const struct contact_law *law, double radius)
{
    double modulus = plane_modulus(law);
    return (struct contact_pair){.hertz = 4.0 / 3.0 * modulus * sqrt(radius),
                                 .cube = cbrt(6 * modulus * modulus * radius)};
}

static double smooth_force(const struct contact_pair *pair, double overlap)
{
    return pair->hertz * overlap * sqrt(overlap);
}

static double smooth_overlap(const struct contact_pair *pair, double force)
{
    double root = cbrt(force);
    return 1.5 * root * root / pair->cube;
}

static double smooth_stiffness(const struct contact_pair *pair, double force)
{
    return pair->cube * cbrt(force);
}

static double smooth_work(const struct contact_pair *pair, double overlap, double force)
{
    (void)overlap;
    return 0.4 * force * smooth_overlap(pair, force);
}

/* Hertz's force by the stiffness alone, which the rough laws share with it: F^2/3 = cube x / (3/2). */
static double flat_force(const struct contact_pair *pair, double overlap)
{
    double square = pair->cube * overlap / 1.5;
    return square > 0 ? square * sqrt(square) : 0;
}

static struct contact_pair rough_pair(const struct contact_law *law, double radius)
{
    struct contact_pair pair = smooth_pair(law, radius);
    double modulus = plane_modulus(law), a = 0.2567 * law->fractal, h = law->roughness;
    pair.exponent = a;
    pair.area = 0.75 * pow(M_PI, 1.5) * radius * h * pow(20 / (pow(M_PI, 1.5) * law->fractal), 1 / a);
    pair.threshold = 4 * modulus / (3 * radius) * pow(pair.area / M_PI, 1.5);
    pair.factor = M_PI / 10 * law->fractal * modulus * sqrt(pair.area) * pow(h * modulus * sqrt(pair.area), -a);
    pair.threshold_overlap = pow(pair.threshold, 1 - a) / ((1 - a) * pair.factor);
    return pair;
}

static double rough_force(const struct contact_pair *pair, double overlap)
{
    if (overlap < pair->threshold_overlap)
        return pow((1 - pair->exponent) * pair->factor * overlap, 1 / (1 - pair->exponent));
    return flat_force(pair, overlap - pair->threshold_overlap + smooth_overlap(pair, pair->threshold));
}

static double rough_overlap(const struct contact_pair *pair, double force)
{
    if (force < pair->threshold)
        return pow(force, 1 - pair->exponent) / ((1 - pair->exponent) * pair->factor);
    return pair->threshold_overlap + smooth_overlap(pair, force) - smooth_overlap(pair, pair->threshold);
}

static double rough_stiffness(const struct contact_pair *pair, double force)
{
    return force < pair->threshold ? pair->factor * pow(force, pair->exponent) : smooth_stiffness(pair, force);
}

static double rough_work(const struct contact_pair *pair, double overlap, double force)
{
    double a = pair->exponent;
    if (force < pair->threshold)
        return force * overlap * (1 - a) / (2 - a);
    double at_threshold = pair->threshold * pair->threshold_overlap * (1 - a) / (2 - a);
    return at_threshold +
           0.4 * (force * smooth_overlap(pair, force) - pair->threshold * smooth_overlap(pair, pair->threshold));
}

#define SMOOTH_KEYS                                                                                                    \
    {"young_Pa", offsetof(struct contact_law, young), DBL_MIN, 1e15, 1},                                               \
    {                                                                                                                  \
        "poisson", offsetof(struct contact_law, poisson), 0, 0.5, 1                                                    \
    }
static const struct law_key SMOOTH[] = {SMOOTH_KEYS, {0}};
static const struct law_key ROUGH[] = {SMOOTH_KEYS,
                                       {"fractal_dimension", offsetof(struct contact_law, fractal), 2, 3, 1},
                                       {"roughness_m", offsetof(struct contact_law, roughness), DBL_MIN, 1, 1},
                                       {0}};

#define SMOOTH_CALLS                                                                                                   \
    .keys = SMOOTH, .smooth = 1, .pair = smooth_pair, .force = smooth_force, .overlap = smooth_overlap,                \
    .stiffness = smooth_stiffness, .work = smooth_work
#define ROUGH_CALLS                                                                                                    \
    .keys = ROUGH, .pair = rough_pair, .force = rough_force, .overlap = rough_overlap, .stiffness = rough_stiffness,   \
    .work = rough_work

const struct law hertz_mindlin_law = {.name = "hertz_mindlin", .says = "smooth elastic spheres", SMOOTH_CALLS};
const struct law hertz_pfc_law = {
    .name = "hertz_pfc", .says = "smooth elastic spheres, friction as PFC has it", .keeps_ft = 1, SMOOTH_CALLS};
const struct law pohrt_popov_law = {.name = "pohrt_popov", .says = "rough elastic spheres", ROUGH_CALLS};

/* A flattened contact: Hertz again. */
static const struct law flat_law = {
    .force = flat_force, .overlap = smooth_overlap, .stiffness = smooth_stiffness, .work = smooth_work};
const struct law pohrt_popov_plastic_law = {
    .name = "pohrt_popov_plastic", .says = "rough spheres that stay flattened", .back = &flat_law, ROUGH_CALLS};
