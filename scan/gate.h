/* gate.h -- is it a face, and for an enrolment one that may be compared with for years?  Judged
 * over the mean face's cells alone, by the fit of a face's shape (shape.h): how much of what is
 * seen the fit explains, how little it leaves, how much of a face is seen, whether there are eyes
 * where a face has them, and whether another scale would fit better. */
#ifndef SCAN_GATE_H
#define SCAN_GATE_H
#include <stdbool.h>
#include <stddef.h>
#include "status.h"
#include "vec.h"

struct scan_found; /* scan.h */
struct shape_fit;  /* shape.h */
struct shape_work; /* shape.h */

/* What the gate looks at. */
struct gate_scan {
    struct shape_work *shape;
    const struct shape_fit *fit; /* shape_fit()'s for an enrolment, or shape_judge()'s */
    const struct dvec3 *pts;     /* that it was fitted to, mm */
    size_t n;
    bool enrolment;
};

/* gate_judge(s, found): fills found's evidence and what is wanted of it, and of an enrolment that
 * is refused as no face, or explained less than well, the scale.
 * Returns ST_OK; ST_ENOTFACE; ST_EQUALITY: a face, but too little of it, or too much covered;
 * ST_ENOMEM. */
enum status gate_judge(const struct gate_scan *s, struct scan_found *found);

#endif
