/* overlay.h -- the exact volume between two triangulated surfaces: both triangulations laid
 * over each other, every triangle of the one clipped against those of the other that its
 * box meets.  Slow beside the general triangulation, and independent of it. */
#ifndef STUDIES_OVERLAY_H
#define STUDIES_OVERLAY_H

struct mesh; /* mesh.h */

/* overlay_volume(a, b, area): the integral of |height of b - height of a| over what both
 * hulls have in common, lattice units; *area: of what is common.  About O(n sqrt n). */
double overlay_volume(const struct mesh *a, const struct mesh *b, double *area);

#endif
