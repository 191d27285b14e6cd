/* find_view.h -- a cloud seen from one side: the places that protrude as a nose does, and how well the
 * mean face lies there, at every roll.  Internal to find.h. */
#ifndef CORE_FIND_VIEW_H
#define CORE_FIND_VIEW_H
#include <stdint.h>
#include "find_grid.h"
#include "pose.h"
#include "status.h"
#include "vec.h"

struct frame_mean; /* frame.h */

#define FIND_STARTS       64
#define FIND_VIEW_SAMPLES 96
#define FIND_VIEW_ROLLS   16
#define FIND_VIEW_MM                                                                     \
    50.0 /* about a face's half width, so that sums of squares are alike */

/* Samples of the mean face, by the roll of the face. */
struct find_view_face {
    struct dvec3 tip; /* of the nose, mm */
    uint32_t n;
    /* from the tip, in units of FIND_VIEW_MM */
    float x[FIND_VIEW_SAMPLES][FIND_VIEW_ROLLS], y[FIND_VIEW_SAMPLES][FIND_VIEW_ROLLS];
    float z[FIND_VIEW_SAMPLES]; /* from the tip, mm */
};

/* find_view_prepare(mean, out): Takes the samples of a mean face. */
void find_view_prepare(const struct frame_mean *mean, struct find_view_face *out);

struct find_start {
    float cost;       /* mean square of the levelled gap, mm^2, times odds */
    float odds;       /* 1; more for a position that is rarer for a head */
    struct pose pose; /* cloud, mm from its corner -> canonical frame */
};

/* The best starts, by rising cost. */
struct find_starts {
    struct find_start start[FIND_STARTS];
    uint32_t n;
    int64_t left; /* budget, in noses (FIND_SPENT, find.c) */
};

/* Buffers for the maps of one cloud, one after the other; reset between two views. */
struct find_view_room {
    float *z;       /* height of each cell, mm; NONE: no points */
    float *out;     /* protrusion of each cell, mm; NONE: not as of a nose */
    uint32_t *cell; /* numbers of the cells that have a height */
};

/* find_view_open(g, r): Allocates r for views of g from every side.
 * Returns ST_OK; ST_ENOMEM: r is closed. */
enum status find_view_open(const struct find_grid *g, struct find_view_room *r);
void find_view_close(struct find_view_room *r);

/* find_view_all(f, g, axis, r, s): Searches g, seen from axis (any length), and adds starts to s.
 * The cloud becomes a map of the heights that are nearest to the eye.  On each cell that
 * protrudes from a ring around it as the tip of a nose does, the samples of the mean face are laid, at
 * each of the rolls.  The cost is the mean square of the gap, up to FIND_CAP_MM each, without the best
 * plane; times FIND_ABOVE_COST if the place above the head is occupied, and times FIND_ASLANT_COST
 * if the head is not upright.  The plane tilts the start: axis need be right to some 30 degrees
 * only.
 * Cost: O(g->n + noses), however large g is. */
void find_view_all(const struct find_view_face *f, const struct find_grid *g,
                   struct dvec3 axis, struct find_view_room *r, struct find_starts *s);

#endif
