/* gate.h -- decides whether a scan shows a face, and whether it shows enough of it to be a template.
 * Only the mean face's cells are judged, by the fit of a face's shape (shape.h).  The gate keeps
 * things out, not people: a face is never refused for being unusual, in size and proportions
 * either; a scan is refused that has too little evidence of a face. */
#ifndef CORE_GATE_H
#define CORE_GATE_H
#include <stdbool.h>
#include "surface_scan.h"
#include "status.h"

/* The share of the face that is covered, and the share of points elsewhere, that are reported. */
#define SCAN_OCCLUDED_SOME  0.05
#define SCAN_ELSEWHERE_SOME 0.05

struct shape_fit;  /* shape.h */
struct shape_work; /* shape.h */

/* gate_judge(w, fit, enrolment, out): Judges a result of shape_fit().  Sets out->support to
 * out->forehead (measured as in shape.h) and the least value wanted of each.
 * Returns ST_OK; ST_ENOTFACE; ST_EQUALITY: a face, but too little of it, too much covered, or too
 * noisy. */
enum status gate_judge(const struct shape_work *w, const struct shape_fit *fit,
                       bool enrolment, struct surface_found *out);

#endif
