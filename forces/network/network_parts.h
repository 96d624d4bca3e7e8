/* Inside of the network: what the file must hold, and what takes part. */
#ifndef FORCES_NETWORK_PARTS_H
#define FORCES_NETWORK_PARTS_H

#include "forces/network/equations.h"
#include "pipeline/laws/contact_law.h"
#include "pipeline/packing/packing.h"

/* Refuses a packing that nothing holds, and numbers that are not finite on rows that take part. */
int network_check(const struct packing *packing, const struct network_options *options);
int network_offers(const struct packing *packing, const struct network_options *options, size_t c); /* contact c */
int network_fixes(const struct packing *packing, size_t k);                                         /* grain k */
/* Grains with fewer than two live contacts carry nothing and go, then those that leaned on them, and so on; their
 * contacts are no longer live. A loaded grain that stands on one contact stays. */
int network_peel(const struct packing *packing, const struct contact_law *law, unsigned char *live,
                 unsigned char *peeled);

#endif
