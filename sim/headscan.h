/* headscan.h -- a head as scanners deliver it: views, a depth camera's grid, points all round,
 * with covers, in any unit and axes.  Everything follows from the head and the seed. */
#ifndef TOOLS_HEADSCAN_H
#define TOOLS_HEADSCAN_H
#include <stdbool.h>
#include <stdint.h>
#include "head.h"
#include "headspec.h"

/* The kinds by name: head, bust, round, half, depth, grid, behind, two, and the covers.
 * headscan_kind(k, seed, crop, o): the kind's options, drawn by the seed. */
#define HEADSCAN_KINDS 15
const char *headscan_name(unsigned kind);
void headscan_kind(unsigned kind, uint64_t seed, bool crop, struct headscan_options *o);

/* headscan_render(h, other, o, out): h in the canonical frame, measured; other: the second
 * head (may be h).  out: released by headscan_free(). */
void headscan_render(const struct head *h, const struct head *other,
                     const struct headscan_options *o, struct headscan *out);
void headscan_free(struct headscan *s);

#endif
