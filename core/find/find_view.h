/* find_view.h -- a cloud seen from one side: where it sticks out as a nose does, and how well the
 * mean face lies there, at every roll.  Internal to find.h. */
#ifndef CORE_FIND_VIEW_H
#define CORE_FIND_VIEW_H
#include <stddef.h>
#include <stdint.h>
#include "find_grid.h"
#include "pose.h"
#include "status.h"
#include "vec.h"

struct frame_mean; /* frame.h */

/* Starts that are kept; of these followed roughly at most, and of what that finds to the end: of
 * those along a scanner's axes, where nothing is plain MORE of them, and of the OTHERS, and the LAST
 * of these.  What is worth SURE roughly is followed at once. */
#define FIND_STARTS       64
#define FIND_SEEKS        12
#define FIND_SEEKS_MORE   16
#define FIND_FITS         4
#define FIND_FITS_MORE    6
#define FIND_SEEKS_OTHERS 30
#define FIND_FITS_OTHERS  6
#define FIND_SEEKS_LAST   16
#define FIND_FITS_LAST    4
#define FIND_SURE         400.0

/* The search ends with what it has once it has spent what SPENT noses cost, some 4 us each, and
 * one more for PER points each.  A view costs one for CUBES cubes and one for CELLS cells that
 * are seen; a fit costs FIT and one for FAR cubes.  For a head that may be small there are SMALL, and
 * what PER allowed for if it is left. */
#define FIND_SPENT       4600
#define FIND_SPENT_SMALL 1120
#define FIND_SPENT_ONCE  300
#define FIND_SPENT_PER   12
#define FIND_SPENT_CUBES 512
#define FIND_SPENT_CELLS 96
#define FIND_SPENT_FIT   25
#define FIND_SPENT_FAR   1000

#define FIND_VIEW_SAMPLES 96
#define FIND_VIEW_ROLLS   16

/* mm from the tip of the nose: above LOW the crown has ended, and hair nearly always.  Where most of a
 * band from there to HIGH, SIDE to each side, has points no more than BEFORE before the nose and BEHIND
 * behind it, there is something else above: of a place on a chest or a shoulder the head, or the body. */
#define FIND_ABOVE_LOW_MM    210.0
#define FIND_ABOVE_HIGH_MM   270.0
#define FIND_ABOVE_SIDE_MM   45.0
#define FIND_ABOVE_BEFORE_MM 80.0
#define FIND_ABOVE_BEHIND_MM 140.0

/* Samples of the mean face from its tip, by the roll of the face. */
struct find_view_face {
    struct dvec3 tip;
    uint32_t n;
    float x[FIND_VIEW_SAMPLES][FIND_VIEW_ROLLS], y[FIND_VIEW_SAMPLES][FIND_VIEW_ROLLS];
    float z[FIND_VIEW_SAMPLES]; /* mm; x and y in units of FIND_VIEW_MM */
};

/* About a face's half width, so that sums of squares are alike. */
#define FIND_VIEW_MM 50.0

/* find_view_prepare(mean, out): once for a mean face. */
void find_view_prepare(const struct frame_mean *mean, struct find_view_face *out);

struct find_start {
    float cost; /* mm^2: of what is left of the gap once it is levelled, times odds */
    float odds; /* 1, or more where a head stands so less often */
    struct pose pose; /* cloud, mm from its corner -> canonical frame */
};

/* The best, by rising cost. */
struct find_starts {
    struct find_start start[FIND_STARTS];
    uint32_t n;
    int64_t left; /* to spend, in noses (FIND_SPENT) */
};

/* Maps of one cloud, one after the other: empty between two views. */
struct find_view_room {
    float *z;       /* mm; NONE: no points */
    float *out;     /* how far it stands out, mm; NONE: not as a nose does */
    uint32_t *cell; /* the cells of a view that have a height */
};

/* find_view_open(g, r): room for g from every side.  Returns ST_OK, ST_ENOMEM (r is closed).
 * find_view_close(r). */
enum status find_view_open(const struct find_grid *g, struct find_view_room *r);
void find_view_close(struct find_view_room *r);

/* find_view_all(f, g, axis, r, s): look at g from axis (any length) and add what is found.
 * The cloud becomes a map of the heights that are nearest to the eye.  Where a cell of it stands
 * out from a ring about it as the tip of a nose does, samples of the mean face are laid on the
 * map, their tip on that cell, at each of the rolls; of what is left once the best plane is
 * taken out, the mean square, up to FIND_CAP_MM each, is the cost; times FIND_ABOVE_COST where the place
 * above the head is taken, and FIND_ASLANT_COST where the head is not upright.  The plane tilts the start:
 * axis need be right to some 30 degrees alone.
 * O(g->n + noses), however large g is. */
void find_view_all(const struct find_view_face *f, const struct find_grid *g,
                   struct dvec3 axis, struct find_view_room *r, struct find_starts *s);

#endif
