/* Greedy colouring: each contact takes the first colour that no contact of its grains has yet, one bit per colour and
 * degree of freedom. Where no grain has more than d contacts, 2 d - 1 colours are enough. */
#include "forces/methods/cdm_order.h"

#include <stdlib.h>
#include <string.h>

#include "pipeline/speak/error.h"

enum { MOST_COLOURS = 64 }; /* bits of a word */

/* First degree of freedom of a wall: they come last. */
static long first_wall(const struct network *network)
{
    long first = (long)network->dofs;
    for (size_t w = 0; w < network->walls; w++)
        if (network->wall_dof[w] >= 0 && network->wall_dof[w] < first)
            first = network->wall_dof[w];
    return first;
}

/* The first colour that none of its grains has; MOST_COLOURS: none is left, or it touches a wall. */
static int choose(const struct network_contact *contact, long walls, uint64_t *used)
{
    uint64_t taken = 0;
    int colour = 0;
    for (int e = 0; e < NETWORK_WIDTH && contact->dof[e] >= 0; e++) {
        if (contact->dof[e] >= walls)
            return MOST_COLOURS;
        taken |= used[contact->dof[e]];
    }
    while (colour < MOST_COLOURS && taken >> colour & 1)
        colour++;
    for (int e = 0; e < NETWORK_WIDTH && contact->dof[e] >= 0 && colour < MOST_COLOURS; e++)
        used[contact->dof[e]] |= (uint64_t)1 << colour;
    return colour;
}

/* Counting sort by colour. */
static void fill(const struct network *network, uint64_t *used, int *colour, struct cdm_order *order)
{
    long walls = first_wall(network);
    for (size_t c = 0; c < network->count; c++) {
        colour[c] = choose(&network->contact[c], walls, used);
        if (colour[c] < MOST_COLOURS && colour[c] >= order->colours)
            order->colours = colour[c] + 1;
    }
    size_t next = 0;
    for (int k = 0; k <= order->colours; k++) {
        order->start[k] = next;
        for (size_t c = 0; c < network->count; c++)
            if (colour[c] == (k < order->colours ? k : MOST_COLOURS))
                order->contact[next++] = (int)c;
    }
    order->start[order->colours + 1] = next;
}

int cdm_order_build(const struct network *network, int coloured, struct cdm_order *order)
{
    uint64_t *used = calloc(network->dofs + 1, sizeof *used);
    int *colour = calloc(network->count + 1, sizeof *colour);
    *order = (struct cdm_order){calloc(network->count + 1, sizeof(int)), calloc(MOST_COLOURS + 2, sizeof(size_t)), 0};
    int status = used && colour && order->contact && order->start ? 0 : error_memory("contact dynamics");
    if (!status && coloured) {
        fill(network, used, colour, order);
    } else if (!status) {
        for (size_t c = 0; c < network->count; c++)
            order->contact[c] = (int)c;
        order->start[1] = network->count;
    }
    free(used), free(colour);
    return status;
}

void cdm_order_free(struct cdm_order *order)
{
    free(order->contact), free(order->start);
    memset(order, 0, sizeof *order);
}
