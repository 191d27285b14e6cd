/* gate.h -- is it a face, and for an enrolment one that may be compared with for years?  Judged
 * over the mean face's cells alone, by the fit of a face's shape (shape.h).  The gate is for
 * things, not for people: what is rare in a face, its size and proportions included, is no
 * evidence against it; only too little evidence that there is a face at all is. */
#ifndef FIND_GATE_H
#define FIND_GATE_H
#include <stdbool.h>
#include "status.h"

/* Share of the face that may be covered at enrolment; and from which it is reported, as is the
 * share of points elsewhere. */
#define GATE_OCCLUDED_MOST  0.25
#define SCAN_OCCLUDED_SOME  0.05
#define SCAN_ELSEWHERE_SOME 0.05

struct shape_fit;  /* shape.h */
struct shape_work; /* shape.h */

/* The evidence, and the least of it that is wanted. */
struct gate {
    double support;  /* how much of what is seen a face explains, at most 1 */
    double likeness; /* how little is left (shape.h) */
    double eyes;     /* how much like eyes the places of both are, -1..1 (shape.h) */
    /* how much of a face's fine relief there is; 1: the mean face's (shape.h) */
    double detail;
    double seen;     /* share of the mean face's cells that are skin, 0..1 */
    double forehead; /* how much like a fitted face's it is, -1..1 (shape.h) */
    /* likeness + 4 eyes + 5 support + 5 detail (at most 5) + 2 seen + 2 forehead (0 at least:
     * who wears a fringe lacks none) */
    double evidence;
    double residual_mm; /* what the shape leaves of the scan (shape.h) */
    double support_wanted, seen_wanted, evidence_wanted;
    double residual_most; /* INFINITY for a probe */
    double size;          /* of the head, over the mean face's (shape.h) */
};

/* gate_judge(w, fit, enrolment, out): what shape_fit() found.
 * Returns ST_OK; ST_ENOTFACE; ST_EQUALITY: a face, but too little of it, too much covered, or too
 * noisy. */
enum status gate_judge(const struct shape_work *w, const struct shape_fit *fit,
                       bool enrolment, struct gate *out);

#endif
