/* picture.h -- a triangulated surface as one sees it: shaded, in parallel projection, with a
 * depth buffer, as pixels for gnuplot (with rgbimage). */
#ifndef STUDY_PICTURE_H
#define STUDY_PICTURE_H
#include <stdio.h>
#include "vec.h"

struct mesh; /* mesh.h */

struct picture {
    int wide, high;    /* pixels */
    double per;        /* pixels to the unit of length */
    double x, y, z;    /* what is in the middle, in units of length */
    double turn, tilt; /* radians: the surface about the vertical, then towards the eye */
    unsigned char *rgb;
    float *depth;
};

/* picture_begin(r): an empty picture; the members above rgb are set. */
void picture_begin(struct picture *r);

/* picture_mesh(r, m, bridge, unit, up, lift, colour): draw m, without the triangles whose bridge
 * is not 0 (NULL: with all); unit: lattice units to the unit of length; heights are multiplied
 * by up, then lifted; colour 0xrrggbb in full light. */
void picture_mesh(struct picture *r, const struct mesh *m, const uint8_t *bridge,
                  double unit, double up, double lift, unsigned colour);

/* picture_end(r, f): lines "across up r g b", in units of length from the middle. */
void picture_end(struct picture *r, FILE *f);

#endif
