/* explain.h -- why a comparison was decided as it was: figures at each place of the face.
 * Three fields, each at any point of the probe's surface:
 *   gap    as measured, probe minus template along the scanner's z; it does not decide
 *   cell   the gap of the cell there, each face in its own frame: of it the score is taken
 *   part   what the cell adds to the score, whose sum is the score: above 0 it speaks for one
 *          person, below 0 for two */
#ifndef CTL_EXPLAIN_H
#define CTL_EXPLAIN_H
#include <stddef.h>
#include "face.h"
#include "minimal.h"

enum explain_kind { EXPLAIN_GAP, EXPLAIN_CELL, EXPLAIN_PART, EXPLAIN_KINDS };

#define EXPLAIN_GAP_MM    3.0 /* where colours and bars of gaps end, on either side of 0 */
#define EXPLAIN_PART_END  0.3 /* and those of the parts */
#define EXPLAIN_BEYOND_MM 1.0 /* the share of a gap beyond this is in the numbers */
#define EXPLAIN_BINS      60 /* over the scale; what lies beyond is in the first and last */
#define EXPLAIN_QUANTILES 6

extern const double explain_levels[EXPLAIN_QUANTILES]; /* 0.5 ... 1 */

/* How the gap is spread over the probe's points, or over the cells. */
struct explain_spread {
    size_t n;         /* points or cells; all others NAN or 0 without any */
    double beyond;    /* share of |x| above EXPLAIN_BEYOND_MM, 0..1 */
    double median_mm; /* of the signed x */
    double mean_mm;   /* of |x| */
    double quantile_mm[EXPLAIN_QUANTILES]; /* of |x|, at the levels */
    double bin[EXPLAIN_BINS];              /* shares of the signed x, over the scale */
};

struct explanation {
    const char *a, *b;                 /* as the command line names them */
    const char *engine;                /* face_engine() */
    const char *subject, *template_id; /* NULL: a is a scan */
    /* templates of a, of which that one had the highest score; 1: a scan */
    unsigned compared;
    struct face tmpl, probe;
    struct face_result result;
    struct minimal minimal;
    struct face_field field; /* what decided, per cell */
    struct dvec3 *pts; /* [n] the probe's points moved onto the template, mm, as sent */
    double *value
        [EXPLAIN_KINDS]; /* [n] at them; NAN: nothing to compare, or it does not count */
    size_t n;
    struct explain_spread gap, cell;
};

/* explain_fields(x, w): the fields of the comparison that x has the faces and the result of:
 * sets x->field, x->value, x->gap and x->cell, and moves x->pts onto the template.
 * x->value is released by explain_free().  Returns ST_OK, ST_ENOMEM. */
enum status explain_fields(struct explanation *x, struct face_work *w);

/* explain_at(x, pts, n, value): the three fields (NAN: none) at points of the probe's
 * surface, which are moved onto the template; x->field must be set.  Returns ST_OK,
 * ST_ENOMEM. */
enum status explain_at(const struct explanation *x, struct dvec3 *pts, size_t n,
                       double *const value[EXPLAIN_KINDS]);

/* explain_end(kind): where its scale ends: mm, or score for the part. */
double explain_end(enum explain_kind kind);

void explain_free(struct explanation *x); /* pts, value and the faces */

#endif
