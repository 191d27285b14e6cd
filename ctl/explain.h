/* explain.h -- why a comparison was decided as it was: figures at each place of the face.
 * Three fields, each at any point of the probe's surface:
 *   gap    as measured, probe minus template along the scanner's z; it does not decide
 *   rest   what is left of the gap once learned change of one face is taken out (fit.h)
 *   part   what the place adds to the score, with its weight, in thresholds: its mean over
 *          the cells that count is score / threshold, so above 1 is a non-match */
#ifndef CTL_EXPLAIN_H
#define CTL_EXPLAIN_H
#include <stddef.h>
#include "face.h"
#include "minimal.h"

enum explain_kind { EXPLAIN_GAP, EXPLAIN_REST, EXPLAIN_PART, EXPLAIN_KINDS };

#define EXPLAIN_GAP_MM    3.0 /* where the gap's colours and bars end, on either side of 0 */
#define EXPLAIN_TIMES     4.0 /* where the rest's and the part's end, in thresholds */
#define EXPLAIN_BEYOND_MM 1.0 /* the share of the gap beyond this is in the numbers */
#define EXPLAIN_BINS      60 /* over the scale; what lies beyond is in the first and last */
#define EXPLAIN_QUANTILES 6

extern const double explain_levels[EXPLAIN_QUANTILES]; /* 0.5 ... 1 */

/* How a field is spread: the gap over the probe's points, the rest over the cells that
 * count, by their weight. */
struct explain_spread {
    size_t n;         /* points or cells; the rest NAN or 0 without any */
    double end_mm;    /* the bins go from -end_mm to end_mm */
    double limit_mm;  /* 1 mm for the gap, the threshold for the rest */
    double beyond;    /* share of |x| above limit_mm, 0..1 */
    double median_mm; /* of the signed x */
    double mean_mm;   /* of |x| */
    double quantile_mm[EXPLAIN_QUANTILES]; /* of |x|, at the levels */
    double bin[EXPLAIN_BINS];              /* shares of the signed x */
};

struct explanation {
    const char *a, *b;                 /* as the command line names them */
    const char *engine;                /* face_engine() */
    const char *subject, *template_id; /* NULL: a is a scan */
    /* templates of a, of which that one had the smallest score; 1: a scan */
    unsigned compared;
    struct face tmpl, probe;
    struct face_result result;
    struct minimal minimal;
    struct face_field field; /* what decided, per cell */
    size_t cells;            /* of them that count */
    struct dvec3 *pts; /* [n] the probe's points moved onto the template, mm, as sent */
    double *value[EXPLAIN_KINDS]; /* [n] at them; NAN: nothing to compare, or no weight */
    size_t n;
    struct explain_spread gap, rest;
};

/* explain_fields(x, w): the fields of the comparison that x has the faces and the result of:
 * sets x->field, x->value, x->gap and x->rest, and moves x->pts onto the template.
 * x->value is released by explain_free().  Returns ST_OK, ST_ENOMEM. */
enum status explain_fields(struct explanation *x, struct face_work *w);

/* explain_at(x, pts, n, value): the three fields (NAN: none) at points of the probe's
 * surface, which are moved onto the template; x->field must be set.  Returns ST_OK,
 * ST_ENOMEM. */
enum status explain_at(const struct explanation *x, struct dvec3 *pts, size_t n,
                       double *const value[EXPLAIN_KINDS]);

/* explain_end(x, kind): where its scale ends: mm, or thresholds for the part. */
double explain_end(const struct explanation *x, enum explain_kind kind);

void explain_free(struct explanation *x); /* pts, value and the faces */

#endif
