#include "network_score.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "pipeline/speak/error.h"

#define CARRYING 0.01 /* of the mean overlap */

int scored_network_add(struct scored_network *network, struct scored_pair pair)
{
    if (network->count == network->room) {
        size_t room = network->room ? 2 * network->room : 1024;
        struct scored_pair *grown = realloc(network->pair, room * sizeof *grown);
        if (!grown)
            return error_memory("scored pairs");
        network->pair = grown;
        network->room = room;
    }
    network->pair[network->count++] = pair;
    return 0;
}

void scored_network_free(struct scored_network *network)
{
    free(network->pair);
    *network = (struct scored_network){0};
}

double find_carrying(const struct contacts *truth, size_t grains, unsigned char *carries)
{
    double sum = 0, count = 0, mean;
    for (size_t c = 0; c < truth->count; c++)
        if (truth->overlap[c] > 0) {
            sum += truth->overlap[c];
            count++;
        }
    mean = count > 0 ? sum / count : 0;
    for (size_t k = 0; k < grains; k++)
        carries[k] = 0;
    for (size_t c = 0; c < truth->count; c++) {
        int64_t ends[2] = {truth->i[c], truth->j[c]};
        for (int e = 0; e < 2; e++)
            if (truth->overlap[c] > CARRYING * mean && (size_t)ends[e] < grains && carries[ends[e]] < 2)
                carries[ends[e]]++;
    }
    for (size_t k = 0; k < grains; k++)
        carries[k] = carries[k] >= 2;
    return mean;
}

double precision(struct hits hits)
{
    return hits.right / hits.found;
}

double recall(struct hits hits)
{
    return hits.right / hits.expected;
}

double f1(struct hits hits)
{
    return 2 * hits.right / (hits.found + hits.expected);
}

static void hits_add(struct hits *sum, struct hits hits)
{
    sum->found += hits.found;
    sum->right += hits.right;
    sum->expected += hits.expected;
}

/* 1: it carries force, 0: it is apart, -1: counts neither way. */
static int carrying_truth(const struct scored_network *network, const struct scored_pair *pair)
{
    if (pair->truth > CARRYING * network->mean)
        return 1;
    return pair->truth > 0 || !pair->carries ? -1 : 0;
}

static int by_overlap(const void *a, const void *b)
{
    const struct scored_pair *x = a, *y = b;
    return (x->overlap < y->overlap) - (x->overlap > y->overlap);
}

/* Sorted from the deepest: the threshold with the best F1. */
static void best_thresholds(const struct scored_network *network, struct hits *best, struct hits *best_carrying)
{
    struct hits all = {0, 0, best->expected}, carrying = {0, 0, best_carrying->expected};
    for (size_t p = 0; p < network->count; p++) {
        int carries = carrying_truth(network, &network->pair[p]);
        all.found++;
        all.right += network->pair[p].truth > 0;
        carrying.found += carries >= 0;
        carrying.right += carries == 1;
        if (f1(all) > f1(*best))
            *best = all;
        if (f1(carrying) > f1(*best_carrying))
            *best_carrying = carrying;
    }
}

static void reliability_add(struct reliability *sum, double probability, int is)
{
    int bin = (int)fmin(SCORE_BINS - 1, SCORE_BINS * probability);
    sum->count[bin]++;
    sum->is[bin] += is;
    sum->stated[bin] += probability;
}

static void reliability_sum(struct reliability *sum, const struct reliability *one)
{
    for (int b = 0; b < SCORE_BINS; b++) {
        sum->count[b] += one->count[b];
        sum->is[b] += one->is[b];
        sum->stated[b] += one->stated[b];
    }
}

static void count_pair(const struct scored_network *network, const struct scored_pair *pair,
                       struct network_figures *sum)
{
    int is = pair->truth > 0, carries = carrying_truth(network, pair);
    struct hits hits = {pair->contact, pair->contact && is, is};
    hits_add(&sum->all, hits);
    hits_add(&sum->bearing, (struct hits){pair->contact && !pair->idle, pair->contact && !pair->idle && is, is});
    hits_add(&sum->carrying, (struct hits){pair->contact && carries >= 0, pair->contact && carries == 1, carries == 1});
    if (pair->wall)
        hits_add(&sum->walls, hits);
    for (int r = 0; r < RULES; r++) {
        int named = pair->probability > (r + 1) * 0.1;
        hits_add(&sum->rule[r], (struct hits){named, named && is, is});
    }
    reliability_add(&sum->every, pair->probability, is);
    if (carries >= 0)
        reliability_add(&sum->decidable, pair->probability, carries);
}

void network_figures_add(struct scored_network *network, struct network_figures *sum)
{
    struct network_figures one = {.all.expected = network->missing,
                                  .bearing.expected = network->missing,
                                  .carrying.expected = network->missing_carrying,
                                  .walls.expected = network->missing_wall};
    qsort(network->pair, network->count, sizeof *network->pair, by_overlap);
    for (int r = 0; r < RULES; r++)
        one.rule[r].expected = network->missing;
    for (size_t p = 0; p < network->count; p++)
        count_pair(network, &network->pair[p], &one);
    one.best.expected = one.all.expected;
    one.best_carrying.expected = one.carrying.expected;
    best_thresholds(network, &one.best, &one.best_carrying);
    hits_add(&sum->all, one.all);
    hits_add(&sum->bearing, one.bearing);
    hits_add(&sum->carrying, one.carrying);
    hits_add(&sum->walls, one.walls);
    hits_add(&sum->best, one.best);
    hits_add(&sum->best_carrying, one.best_carrying);
    for (int r = 0; r < RULES; r++)
        hits_add(&sum->rule[r], one.rule[r]);
    reliability_sum(&sum->every, &one.every);
    reliability_sum(&sum->decidable, &one.decidable);
}

void print_reliability(const struct network_figures *figures)
{
    const struct reliability *all = &figures->every, *some = &figures->decidable;
    printf("probability    pairs  stated observed  | without pairs at rest: pairs  stated observed\n");
    for (int b = 0; b < SCORE_BINS; b++)
        printf("%.1f-%.1f %12.0f %8.3f %8.3f  | %28.0f %7.3f %8.3f\n", b / 10.0, (b + 1) / 10.0, all->count[b],
               all->stated[b] / all->count[b], all->is[b] / all->count[b], some->count[b],
               some->stated[b] / some->count[b], some->is[b] / some->count[b]);
}
