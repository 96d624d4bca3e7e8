/* Nine discs in a square lattice between four walls, in equilibrium by construction: column c carries LATTICE_V(c)
 * newtons downwards, row r carries LATTICE_H(r) across, no friction. In SI and as a photo sees it. */
#ifndef TESTS_LATTICE_H
#define TESTS_LATTICE_H

#include "tests/check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/packing/packing_file.h"

enum { LATTICE_SIDE = 3, LATTICE_GRAINS = 9, LATTICE_CONTACTS = 24 };
#define LATTICE_RADIUS 0.01 /* m; the box is 0.06 m wide and high, its lower left corner at 0, 0 */
#define LATTICE_BOX 0.06
#define LATTICE_SCALE 2e-4 /* m/px: a radius is 50 px, the box 300 px */
#define LATTICE_LEFT 50    /* px: the box in the photo */
#define LATTICE_BOTTOM 350
#define LATTICE_V(c) (100.0 + 50 * (c)) /* N: in all 450 */
#define LATTICE_H(r) (80.0 + 30 * (r))  /* N: in all 330 */

/* The scene that places such a photo of 400 x 400 px. */
#define LATTICE_SCENE                                                                                                  \
    "{\"schema\": \"film.scene/1\", \"name\": \"nine <discs>\", \"photos\": {\"pattern\": \"{index:04d}.tif\", "       \
    "\"first\": 0, \"last\": 1, \"size_px\": [400, 400]}, \"scale_m_per_px\": 2e-4, \"origin_px\": [50, 350]}"

static inline void lattice_walls(struct walls *walls)
{
    static const char *const names[] = {"bottom", "right", "top", "left"};
    static const double at[4][4] = {{0, 0, 1, 0}, {1, 0, 1, 1}, {1, 1, 0, 1}, {0, 1, 0, 0}};
    check_done(table_alloc(&WALLS, walls, 4, NULL));
    for (int w = 0; w < 4; w++) {
        strcpy(walls->name[w], names[w]);
        walls->x0[w] = LATTICE_BOX * at[w][0], walls->y0[w] = LATTICE_BOX * at[w][1];
        walls->x1[w] = LATTICE_BOX * at[w][2], walls->y1[w] = LATTICE_BOX * at[w][3];
        walls->radius[w] = 0;
    }
    walls->fx[1] = -330, walls->fy[2] = -450;
}

/* Contact c of LATTICE_CONTACTS: the first twelve stand, column by column upwards, the others lie, row by row. */
static inline void lattice_contact(struct packing *p, int c)
{
    int lying = c >= 12, line = c / 4 % 3, place = c % 4, step = lying ? 1 : 3;
    int first = lying ? 3 * line : line, i = first + step * (place - 1), j = i + step;
    double along = 2 * LATTICE_RADIUS * place, across = LATTICE_RADIUS * (2 * line + 1), sign = 1;
    if (place == 0)
        i = j, j = LATTICE_GRAINS + (lying ? 3 : 0), sign = -1;
    if (place == 3)
        j = LATTICE_GRAINS + (lying ? 1 : 2);
    p->contacts.i[c] = i, p->contacts.j[c] = j;
    p->contacts.nx[c] = lying ? sign : 0, p->contacts.ny[c] = lying ? 0 : sign;
    p->contacts.x[c] = lying ? along : across, p->contacts.y[c] = lying ? across : along;
    p->contacts.overlap[c] = 1e-5;
    p->contacts.flags[c] = j >= LATTICE_GRAINS ? CONTACT_WALL : 0;
    p->forces->contact.fn[c] = lying ? LATTICE_H(line) : LATTICE_V(line);
    p->forces->contact.ft[c] = 0;
    p->forces->contact.status[c] = STATUS_STICK;
}

/* The forces stand under that method's name, their mu is 0.5. */
static inline void lattice_make(struct packing *p, const char *method)
{
    memset(p, 0, sizeof *p);
    p->length_m = NAN;
    check_done(table_alloc(&GRAINS, &p->grains, LATTICE_GRAINS, NULL));
    check_done(table_alloc(&CONTACTS, &p->contacts, LATTICE_CONTACTS, NULL));
    lattice_walls(&p->walls);
    p->forces = calloc(1, sizeof *p->forces), p->force_count = 1;
    assert_non_null(p->forces);
    strcpy(p->forces->method, method);
    p->forces->mu = 0.5, p->forces->converged = 1;
    check_done(table_alloc(&CONTACT_FORCES, &p->forces->contact, LATTICE_CONTACTS, NULL));
    check_done(table_alloc(&RESIDUALS, &p->forces->residual, LATTICE_GRAINS, NULL));
    for (int k = 0; k < LATTICE_GRAINS; k++) {
        p->grains.x[k] = LATTICE_RADIUS * (2 * (k % LATTICE_SIDE) + 1);
        p->grains.y[k] = LATTICE_RADIUS * (2 * (k / LATTICE_SIDE) + 1);
        p->grains.radius[k] = LATTICE_RADIUS, p->grains.angle[k] = 0;
        p->grains.mass[k] = p->grains.inertia[k] = 1;
        p->forces->residual.residual_x[k] = p->forces->residual.residual_y[k] = 0;
    }
    for (int c = 0; c < LATTICE_CONTACTS; c++)
        lattice_contact(p, c);
}

static inline void lattice_write(struct packing *p, const char *path, int index)
{
    struct provenance provenance = PROVENANCE_DEFAULT;
    provenance.stage = "forces", provenance.coordinates = "si";
    provenance.index = index, provenance.time_s = 10 * index;
    check_done(packing_write(path, p, &provenance));
    packing_free(p);
}

/* The same nine discs in px, all of them moved by (dx, dy) px (y down) and turned by `turn` rad. */
static inline void lattice_photo(struct photo_grains *g, double dx, double dy, double turn)
{
    static const char *const names[] = {"x_px",     "y_px",    "radius_px", "angle",    "s_x",   "s_y", "zncc",
                                        "s_radius", "s_angle", "x_ref_px",  "y_ref_px", "flags", NULL};
    check_done(table_alloc(&PHOTO_GRAINS, g, LATTICE_GRAINS, names));
    for (int k = 0; k < LATTICE_GRAINS; k++) {
        g->x_ref_px[k] = LATTICE_LEFT + 50 * (2 * (k % LATTICE_SIDE) + 1);
        g->y_ref_px[k] = LATTICE_BOTTOM - 50 * (2 * (k / LATTICE_SIDE) + 1);
        g->x_px[k] = g->x_ref_px[k] + dx, g->y_px[k] = g->y_ref_px[k] + dy;
        g->radius_px[k] = 50, g->angle[k] = turn, g->zncc[k] = 0.99;
        g->s_x[k] = g->s_y[k] = 0.1, g->s_radius[k] = 0.05, g->s_angle[k] = 1e-3;
    }
}

static inline void lattice_photo_write(struct photo_grains *g, const char *path, const char *stage, int index)
{
    struct provenance provenance = PROVENANCE_DEFAULT;
    int found = !strcmp(stage, "findgrains"); /* it knows of no reference */
    for (int axis = 0; axis < 2 && found; axis++) {
        free(axis ? g->y_ref_px : g->x_ref_px);
        *(axis ? &g->y_ref_px : &g->x_ref_px) = NULL;
    }
    provenance.stage = stage, provenance.coordinates = found ? "seen" : "corrected";
    provenance.index = index, provenance.time_s = 10 * index;
    struct state_writer *writer = state_create(path, &provenance);
    assert_non_null(writer);
    check_done(state_write(writer, "grains", &PHOTO_GRAINS, g));
    check_done(state_commit(writer));
    table_free(&PHOTO_GRAINS, g);
}

#endif
