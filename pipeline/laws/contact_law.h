/* Contact laws (docs/theory.md section 5): what a law is (a row, struct law), what a scene says of its own (struct
 * contact_law), what the row makes of a pair of radii (struct contact_pair) and the history of one contact (struct
 * contact_spring).
 *
 * A law is one row, declared below, defined in a file of its own and listed once in contact_law.c. Whoever needs to
 * know something of a law asks its row, through contact_law_row(); nobody compares rows. The calls that go through a
 * row are in contact_spring.h. */
#ifndef PIPELINE_CONTACT_LAW_H
#define PIPELINE_CONTACT_LAW_H

#include <math.h>
#include <stddef.h>

struct cJSON; /* JSON of the scene: pipeline/files/json.h */
struct json;

/* What Coulomb says of a contact; the column `status` of /forces/METHOD. */
enum contact_status { STATUS_OPEN = 0, STATUS_STICK = 1, STATUS_SLIP = 2, STATUS_NOT_USED = 3 };

/* No law is better known than this: share of <fn> that is the least error of a force from an overlap. */
#define LEAST_FORCE_ERROR 0.01

/* A law with its numbers. Numbers that the law does not have are NaN. */
struct contact_law {
    const struct law *row; /* NULL: linear_law */
    double kn;             /* N/m; NaN: not given, and always so for the laws whose stiffness grows with the force */
    double kt_over_kn;     /* linear: 1 unless given; elastic bodies: 2 (1 - nu) / (2 - nu), Mindlin 1949 */
    double mu;             /* NaN: not given */
    double mu_wall;        /* 0 unless given */
    double young, poisson; /* Pa, 1: E and nu of the grains */
    double fractal, roughness; /* 1, m: fractal dimension D_f and height h of Pohrt and Popov */
};
/* Linear, nothing given. */
#define CONTACT_LAW_DEFAULT                                                                                            \
    {                                                                                                                  \
        .kn = NAN, .kt_over_kn = 1, .mu = NAN, .young = NAN, .poisson = NAN, .fractal = NAN, .roughness = NAN          \
    }

/* What a law makes of one pair of radii, computed once: its row fills in what the row's other calls read. R is the
 * reduced radius, 1/R = 1/R_i + 1/R_j (R_i at a wall); both bodies are of one material: E* = E / (2 (1 - nu^2)). */
struct contact_pair {
    double kn;                /* N/m: F = kn x */
    double hertz;             /* N/m^3/2: F = hertz x^3/2, 4/3 E* R^1/2 */
    double cube;              /* k = cube F^1/3: (6 E*^2 R)^1/3 */
    double exponent, factor;  /* of a power law; Pohrt and Popov: a and C of k = C F^a */
    double area, threshold;   /* m2, N: A0 and F_H(A0) */
    double threshold_overlap; /* m: x at F_H on virgin loading */
};

/* One contact through time; zeroed: not touched yet. */
struct contact_spring {
    double fn, ft;    /* N */
    double stiffness; /* N/m: dF/dx now */
    double peak;      /* N: largest normal force so far */
};

/* A number of the scene's "contact" object that a law reads. */
struct law_key {
    const char *name;
    size_t at;       /* offsetof its member of struct contact_law (a double) */
    double min, max; /* in the unit that the name says */
    int needed;      /* 1: the law does not work without it */
};

/* A law as a row. The calls are pure, see overlaps and forces of virgin loading only, and are asked for x > 0, F >= 0
 * (N, m): what a gap is, the history and friction are not their concern. */
struct law {
    const char *name;           /* the scene's contact.law */
    const char *says;           /* of itself, in a few words */
    const struct law_key *keys; /* a NULL name ends them; the first one is what all forces grow with: kn or E */
    int linear;                 /* F = kn x, kn given and the same for all radii */
    int smooth;                 /* Hertz: E and nu say everything */
    int keeps_ft;               /* on unloading ft stays; else it falls with the stiffness and creates no energy */
    struct contact_pair (*pair)(const struct contact_law *law, double reduced_radius);
    double (*force)(const struct contact_pair *pair, double overlap);
    double (*overlap)(const struct contact_pair *pair, double force); /* inverse of force() */
    double (*stiffness)(const struct contact_pair *pair, double force);
    double (*work)(const struct contact_pair *pair, double overlap, double force); /* J: integral of F dx from 0 */
    const struct law *back; /* plastic: the law that unloading from the largest force and reloading to it follow; NULL:
                               they take the way of the loading */
};

extern const struct law linear_law;
extern const struct law hertz_mindlin_law; /* ft shrinks with the normal force on unloading: no energy is created */
extern const struct law hertz_pfc_law;     /* the same stiffnesses, ft left as it is on unloading */
extern const struct law pohrt_popov_law;   /* rough, elastic */
extern const struct law pohrt_popov_plastic_law; /* rough on virgin loading, Hertz on unloading and reloading */

/* The row of a law, never NULL. */
const struct law *contact_law_row(const struct contact_law *law);
/* Is what all forces grow with given: kn, or E? */
int contact_law_known(const struct contact_law *law);
/* Elastic bodies of these numbers (Pa, 1): E, nu and kt / kn. */
void contact_law_set_grains(struct contact_law *law, double young, double poisson);

/* The scene's "contact" object: law, mu, mu_wall, and the keys of the law's row. On an error (EXIT_INPUT, with line
 * and column) *law is as it was. contact_law_read_as takes the row from the caller: a law that is not in the list. */
int contact_law_read(const struct json *json, const struct cJSON *object, struct contact_law *law);
int contact_law_read_as(const struct law *row, const struct json *json, const struct cJSON *object,
                        struct contact_law *law);

/* Nearest point of the Coulomb wedge fn >= 0, |ft| <= mu fn along ft (vertical projection; tensile: both zero).
 * A missing number makes both NaN and the status STATUS_NOT_USED. Returns the enum contact_status. */
int coulomb_clip(double mu, double *fn, double *ft);

#endif
