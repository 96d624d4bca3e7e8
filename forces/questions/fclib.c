/* W couples contacts that share a body, through its inverse mass: block (k, c) is the sum over the degrees of freedom d
 * of both of (n_k, t_k)_d (n_c, t_c)_d' / m_d. It is written column by column, from a list of who acts on each degree
 * of freedom, so that nothing as large as W is held twice. */
#include "forces/questions/fclib.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <hdf5.h>

#include "pipeline/speak/error.h"
#include "pipeline/files/new_file.h"

/* ---- W and q ---- */

/* Which contacts act on each degree of freedom: contact[start[d]] ... */
struct actors {
    size_t *start;
    int *contact, *entry;
};

static void actors_free(struct actors *actors)
{
    free(actors->start), free(actors->contact), free(actors->entry);
}

/* A counting sort of the entries of A by degree of freedom. */
static int actors_find(const struct network *network, struct actors *actors)
{
    size_t entries = network->count * NETWORK_WIDTH + 1;
    actors->start = calloc(network->dofs + 2, sizeof *actors->start);
    actors->contact = malloc(entries * sizeof *actors->contact);
    actors->entry = malloc(entries * sizeof *actors->entry);
    if (!actors->start || !actors->contact || !actors->entry)
        return error_memory("contact problem");
    size_t *next = actors->start + 1; /* next[d]: first counts, then where d's following actor goes */
    for (size_t c = 0; c < network->count; c++)
        for (int e = 0; e < NETWORK_WIDTH && network->contact[c].dof[e] >= 0; e++)
            next[network->contact[c].dof[e]]++;
    for (size_t d = 0, sum = 0; d < network->dofs; d++) {
        size_t count = next[d];
        next[d] = sum, sum += count;
    }
    for (size_t c = 0; c < network->count; c++)
        for (int e = 0; e < NETWORK_WIDTH && network->contact[c].dof[e] >= 0; e++) {
            size_t at = next[network->contact[c].dof[e]]++;
            actors->contact[at] = (int)c, actors->entry[at] = e;
        }
    return 0;
}

/* The 2 x 2 blocks of one contact with itself and its neighbours. */
struct neighbours {
    int count, *contact, *mark; /* mark[k] is c + 1 where k is a neighbour of c */
    double (*block)[4];         /* [k]: rows (n, t) of k, columns (n, t) of c */
};

static void neighbours_free(struct neighbours *near)
{
    free(near->contact), free(near->mark), free(near->block);
}

/* -1 without memory. */
static int neighbours_begin(size_t contacts, struct neighbours *near)
{
    near->contact = malloc((contacts + 1) * sizeof *near->contact);
    near->mark = calloc(contacts + 1, sizeof *near->mark);
    near->block = malloc((contacts + 1) * sizeof *near->block);
    return near->contact && near->mark && near->block ? 0 : error_memory("contact problem");
}

/* For qsort(): ascending. */
static int compare_integers(const void *a, const void *b)
{
    int x = *(const int *)a, y = *(const int *)b;
    return (x > y) - (x < y);
}

/* The blocks of column c, in the order of the contacts: each body of c brings all its other contacts. */
static void neighbours_of(const struct network *network, const struct actors *actors, size_t c, struct neighbours *near)
{
    const struct network_contact *here = &network->contact[c];
    near->count = 0;
    for (int e = 0; e < NETWORK_WIDTH && here->dof[e] >= 0; e++) {
        double inverse = network->inverse_mass[here->dof[e]];
        for (size_t a = actors->start[here->dof[e]]; a < actors->start[here->dof[e] + 1]; a++) {
            int k = actors->contact[a], at = actors->entry[a];
            const struct network_contact *there = &network->contact[k];
            double *block = near->block[k];
            if (near->mark[k] != (int)c + 1) {
                near->mark[k] = (int)c + 1;
                near->contact[near->count++] = k;
                memset(block, 0, sizeof near->block[k]);
            }
            block[0] += there->n[at] * inverse * here->n[e], block[1] += there->n[at] * inverse * here->t[e];
            block[2] += there->t[at] * inverse * here->n[e], block[3] += there->t[at] * inverse * here->t[e];
        }
    }
    qsort(near->contact, (size_t)near->count, sizeof *near->contact, compare_integers);
}

/* At least so many entries has W: the blocks of all contacts of one body with each other. Quickly told, where W itself
 * would cost the square of a wall's contacts. */
static double least_entries(const struct network *network, const struct actors *actors)
{
    double most = 0;
    for (size_t d = 0; d < network->dofs; d++)
        most = fmax(most, (double)(actors->start[d + 1] - actors->start[d]));
    return 4 * most * most;
}

/* Columns 2 c and 2 c + 1. */
static void store_columns(const struct neighbours *near, size_t c, struct local_problem *problem)
{
    for (size_t side = 0; side < 2; side++) {
        int at = problem->start[2 * c + side];
        for (int k = 0; k < near->count; k++)
            for (int part = 0; part < 2; part++, at++) {
                problem->row[at] = 2 * near->contact[k] + part;
                problem->value[at] = near->block[near->contact[k]][2 * part + (int)side];
            }
        problem->start[2 * c + side + 1] = at;
    }
}

/* Twice over the contacts: first only to count, as the file's integers have 32 bits. */
static int fill_w(const struct network *network, const struct actors *actors, struct neighbours *near,
                  struct local_problem *problem)
{
    size_t entries = 0;
    if (least_entries(network, actors) > INT_MAX)
        return error_input("%.3g entries and more do not fit into the integers of FCLib: cut the packing",
                           least_entries(network, actors));
    for (size_t c = 0; c < network->count; c++) {
        neighbours_of(network, actors, c, near);
        entries += 4 * (size_t)near->count;
    }
    if (entries > INT_MAX || 2 * network->count > INT_MAX)
        return error_input("%zu entries do not fit into the integers of FCLib: cut the packing", entries);
    memset(near->mark, 0, network->count * sizeof *near->mark);
    problem->rows = (int)(2 * network->count), problem->entries = (int)entries;
    problem->start = calloc(2 * network->count + 1, sizeof *problem->start);
    problem->row = malloc((entries + 1) * sizeof *problem->row);
    problem->value = malloc((entries + 1) * sizeof *problem->value);
    if (!problem->start || !problem->row || !problem->value)
        return error_memory("contact problem");
    for (size_t c = 0; c < network->count; c++) {
        neighbours_of(network, actors, c, near);
        store_columns(near, c, problem);
    }
    return 0;
}

/* Velocities that the loads alone give the resting bodies in a time of 1. */
static int fill_q(const struct network *network, struct local_problem *problem)
{
    double *velocity = malloc((network->dofs + 1) * sizeof *velocity);
    problem->q = malloc((2 * network->count + 1) * sizeof *problem->q);
    problem->mu = malloc((network->count + 1) * sizeof *problem->mu);
    if (!velocity || !problem->q || !problem->mu) {
        free(velocity);
        return error_memory("contact problem");
    }
    for (size_t d = 0; d < network->dofs; d++)
        velocity[d] = network->inverse_mass[d] * network->load[d];
    network_motion(network, velocity, problem->q);
    for (size_t c = 0; c < network->count; c++)
        problem->mu[c] = network->contact[c].mu;
    free(velocity);
    return 0;
}

int local_problem_build(const struct network *network, struct local_problem *problem)
{
    struct actors actors = {0};
    struct neighbours near = {0};
    memset(problem, 0, sizeof *problem);
    int failed = network->count >= INT_MAX / 2 ? error_input("too many contacts for FCLib: cut the packing") : 0;
    failed = failed || actors_find(network, &actors) || neighbours_begin(network->count, &near) ||
             fill_w(network, &actors, &near, problem) || fill_q(network, problem);
    actors_free(&actors);
    neighbours_free(&near);
    if (failed)
        local_problem_free(problem);
    return failed ? -1 : 0;
}

void local_problem_free(struct local_problem *problem)
{
    free(problem->start), free(problem->row), free(problem->value), free(problem->q), free(problem->mu);
    memset(problem, 0, sizeof *problem);
}

/* ---- the file ---- */

/* Without the time of its making: two identical runs give identical files. */
static hid_t create_dataset(hid_t file, const char *name, hid_t type, hid_t space)
{
    hid_t properties = H5Pcreate(H5P_DATASET_CREATE), data = -1;
    if (properties >= 0 && H5Pset_obj_track_times(properties, 0) >= 0)
        data = H5Dcreate2(file, name, type, space, H5P_DEFAULT, properties, H5P_DEFAULT);
    if (properties >= 0)
        H5Pclose(properties);
    return data;
}

/* One dimension, `count` values; not 0 on failure. */
static int write_array(hid_t file, const char *name, hid_t file_type, hid_t memory_type, int count, const void *values)
{
    hsize_t dims = (hsize_t)count;
    hid_t space = H5Screate_simple(1, &dims, NULL);
    hid_t data = space < 0 ? -1 : create_dataset(file, name, file_type, space);
    int failed = data < 0 || H5Dwrite(data, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0;
    if (data >= 0)
        failed |= H5Dclose(data) < 0;
    if (space >= 0)
        H5Sclose(space);
    return failed;
}

static int write_integers(hid_t file, const char *name, int count, const int *values)
{
    return write_array(file, name, H5T_STD_I32LE, H5T_NATIVE_INT, count, values);
}

static int write_doubles(hid_t file, const char *name, int count, const double *values)
{
    return write_array(file, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, count, values);
}

/* A scalar string of fixed length, ended by a zero, as FCLib reads it. */
static int write_string(hid_t file, const char *name, const char *text)
{
    hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR), data = -1;
    if (type >= 0 && space >= 0 && H5Tset_size(type, strlen(text) + 1) >= 0)
        data = create_dataset(file, name, type, space);
    int failed = data < 0 || H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text) < 0;
    if (data >= 0)
        failed |= H5Dclose(data) < 0;
    if (space >= 0)
        H5Sclose(space);
    if (type >= 0)
        H5Tclose(type);
    return failed;
}

static int make_groups(hid_t file, hid_t properties)
{
    static const char *const names[] = {"/fclib_local", "/fclib_local/W", "/fclib_local/vectors", "/fclib_local/info"};
    for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
        hid_t group = H5Gcreate2(file, names[k], H5P_DEFAULT, properties, H5P_DEFAULT);
        if (group < 0 || H5Gclose(group) < 0)
            return 1;
    }
    return 0;
}

static int make_timeless_groups(hid_t file)
{
    hid_t properties = H5Pcreate(H5P_GROUP_CREATE);
    int failed = properties < 0 || H5Pset_obj_track_times(properties, 0) < 0 || make_groups(file, properties);
    if (properties >= 0)
        H5Pclose(properties);
    return failed;
}

/* What the numbers mean, in words and units, for whoever opens the file. */
static int write_info(hid_t file, const struct network *network)
{
    char text[600];
    snprintf(
        text, sizeof text,
        "Quasi-static packing of discs, bodies at rest, one time step of 1. u = W r + q; rows 2c (normal) and 2c+1 "
        "(tangential) of contact c; r on the second body. Units: r in %.17g N, lengths (so rotations) in %.17g m, "
        "masses in the mean mass of a free grain; u in the unit of force over that mass.",
        network->force, network->radius);
    return write_string(file, "/fclib_local/info/title", "contact forces of a packing of discs") ||
           write_string(file, "/fclib_local/info/description", text) ||
           write_string(file, "/fclib_local/info/math_info", "W symmetric, positive semidefinite, compressed columns");
}

static int write_problem(hid_t file, const struct network *network, const struct local_problem *problem)
{
    static const int plane = 2, columns = -1;
    return make_timeless_groups(file) || write_integers(file, "/fclib_local/spacedim", 1, &plane) ||
           write_integers(file, "/fclib_local/W/m", 1, &problem->rows) ||
           write_integers(file, "/fclib_local/W/n", 1, &problem->rows) ||
           write_integers(file, "/fclib_local/W/nz", 1, &columns) ||
           write_integers(file, "/fclib_local/W/nzmax", 1, &problem->entries) ||
           write_integers(file, "/fclib_local/W/p", problem->rows + 1, problem->start) ||
           write_integers(file, "/fclib_local/W/i", problem->entries, problem->row) ||
           write_doubles(file, "/fclib_local/W/x", problem->entries, problem->value) ||
           write_doubles(file, "/fclib_local/vectors/q", problem->rows, problem->q) ||
           write_doubles(file, "/fclib_local/vectors/mu", problem->rows / 2, problem->mu) || write_info(file, network);
}

static int write_file(const char *path, const struct network *network, const struct local_problem *problem)
{
    struct new_file target;
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    if (new_file_begin(&target, path))
        return -1;
    hid_t file = H5Fcreate(target.temporary, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    int failed = file < 0 || write_problem(file, network, problem) || H5Fflush(file, H5F_SCOPE_GLOBAL) < 0;
    if (file >= 0)
        failed |= H5Fclose(file) < 0;
    if (!failed)
        return new_file_commit(&target);
    new_file_discard(&target);
    return error_failed("%s: the contact problem cannot be written: check the room on the disk, then run again", path);
}

int fclib_write(const char *path, const struct packing *packing, const struct force_options *options)
{
    struct network network;
    struct local_problem problem = {0};
    struct network_options network_options = {.wall_mass = options->wall_mass};
    if (network_build(packing, &options->law, &network_options, &network))
        return -1;
    int status = local_problem_build(&network, &problem) || write_file(path, &network, &problem) ? -1 : 0;
    local_problem_free(&problem);
    network_free(&network);
    return status;
}
