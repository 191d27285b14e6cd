/* contrived.h -- point sets made to cost a triangulation's users much work: columns, rows,
 * fans, hulls and clusters on a face, in shares and sizes that a search chooses. */
#ifndef TESTS_CONTRIVED_H
#define TESTS_CONTRIVED_H
#include <stdint.h>
#include "vec.h"

enum contrived_gene {
    CONTRIVED_FACE,    /* shares of the points: sampled evenly from the face */
    CONTRIVED_COLUMNS, /* on columns and */
    CONTRIVED_ROWS,    /* rows, which cross the face */
    CONTRIVED_FAN,     /* on an arc round one point */
    CONTRIVED_HULL,    /* on half a parabola below the face: one long hull */
    CONTRIVED_CLUSTER, /* in one spot */
    CONTRIVED_LINES,   /* columns and rows: how many, */
    CONTRIVED_APART,   /* how far apart, */
    CONTRIVED_PITCH,   /* and the points on them */
    CONTRIVED_SPOT,    /* size of the spot and the arc */
    CONTRIVED_ORDER,   /* below 0.5: shuffled */
    CONTRIVED_STRAY,   /* above 0.5: one point 900 mm off */
    CONTRIVED_GENES
};

/* contrived_make(gene, seed, n, out): n points, mm.  gene: CONTRIVED_GENES numbers, 0..1. */
void contrived_make(const double *gene, uint64_t seed, uint32_t n, struct dvec3 *out);

#endif
