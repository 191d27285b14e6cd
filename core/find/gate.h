/* gate.h -- is it a face, and for an enrolment one that may be compared with for years?  Judged
 * over the mean face's cells alone, by the fit of a face's shape (shape.h).  The gate is for
 * things, not for people: what is rare in a face, its size and proportions included, is no
 * evidence against it; only too little evidence that there is a face at all is. */
#ifndef FIND_GATE_H
#define FIND_GATE_H
#include <stdbool.h>
#include "libsurface.h"
#include "status.h"

/* Share of the face that is covered, and of the points that are elsewhere, from which they are
 * reported. */
#define SCAN_OCCLUDED_SOME  0.05
#define SCAN_ELSEWHERE_SOME 0.05

struct shape_fit;  /* shape.h */
struct shape_work; /* shape.h */

/* gate_judge(w, fit, enrolment, out): what shape_fit() found, from out->support to
 * out->forehead, with the least that is wanted (shape.h has how it is measured).
 * Returns ST_OK; ST_ENOTFACE; ST_EQUALITY: a face, but too little of it, too much covered, or too
 * noisy. */
enum status gate_judge(const struct shape_work *w, const struct shape_fit *fit,
                       bool enrolment, struct surface_found *out);

#endif
