/* ctl_explain.h -- the parts of surfacectl explain, among themselves.
 *   ctl_explain.c        the command: compare, then write everything
 *   ctl_explain_gap.c    the gap in numbers, and its colour
 *   ctl_explain_map.c    the gap as a picture's pixels
 *   ctl_explain_plot.c   gap.png and histogram.png
 *   ctl_explain_cloud.c  gap.ply
 *   ctl_explain_text.c   explain.txt and JSON */
#ifndef DB_SURFACECTL_EXPLAIN_H
#define DB_SURFACECTL_EXPLAIN_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include "errinfo.h"
#include "face.h"

struct ctl_out;

#define EXPLAIN_SCALE_MM  3.0 /* where colours and bars end, on either side of 0 */
#define EXPLAIN_BEYOND_MM 1.0 /* the share of the gap beyond this is told */
#define EXPLAIN_BINS      60 /* over the scale; what lies beyond is in the first and last */
#define EXPLAIN_QUANTILES 6

extern const double ctl_explain_levels[EXPLAIN_QUANTILES]; /* 0.5 ... 1 */

struct explain_gap {
    size_t compared;  /* points with a gap */
    double median_mm; /* of the signed gap; this and all that follows NAN without any */
    double quantile_mm[EXPLAIN_QUANTILES]; /* of |gap|, at the levels */
    double beyond;                         /* share of them beyond EXPLAIN_BEYOND_MM */
    size_t bin[EXPLAIN_BINS];              /* how many of them, by the signed gap */
};

struct explanation {
    const char *a, *b;                 /* as the command line names them */
    const char *engine;                /* face_engine() */
    const char *subject, *template_id; /* NULL: a is a scan */
    unsigned compared; /* templates of a, of which that one was the nearest; 1: a scan */
    struct face tmpl, probe;
    struct face_result result;
    struct dvec3 *pts; /* [n] the probe's points moved onto the template, mm, as sent */
    double *gap; /* [n] signed (probe minus template), mm; NAN: nothing to compare */
    size_t n;
    struct explain_gap sum;
};

/* ctl_explain_gap(x): set x->gap and move x->pts by x->result's transform, and set
 * x->sum.  x->pts and x->n are given; x->gap is released by mem_free().
 * Returns ST_OK, ST_ENOMEM. */
enum status ctl_explain_gap(struct explanation *x);

/* ctl_explain_color(gap_mm, rgb): blue behind the template, red in front of it, a
 * light grey where they meet, full at EXPLAIN_SCALE_MM; a darker grey for NAN. */
void ctl_explain_color(double gap_mm, uint8_t rgb[3]);

struct explain_map {   /* seen from the front */
    uint32_t w, h;     /* pixels; the first row is the lowest */
    double x_mm, y_mm; /* the middle of the first pixel, in the template's coordinates */
    double pixel_mm;
    uint8_t (
        *rgba)[4]; /* [h * w] alpha 0 where the probe has no surface; by mem_free() */
};

/* ctl_explain_map(x, out): the probe's surface where it lies on the template, in the
 * colours of the gap, lit from above so that the face can be seen.
 * Returns ST_OK, ST_ENOMEM. */
enum status ctl_explain_map(const struct explanation *x, struct explain_map *out);

/* Writers: each writes one file of x (and its argument) to `to`; a write error shows in
 * `to`'s own state and need not be returned. */
enum status ctl_explain_cloud(FILE *to, const struct explanation *x, struct errinfo *e);
enum status ctl_explain_picture(FILE *to, const struct explanation *x, struct errinfo *e);
enum status ctl_explain_histogram(FILE *to, const struct explanation *x,
                                  struct errinfo *e);
enum status ctl_explain_text(FILE *to, const struct explanation *x, struct errinfo *e);
enum status ctl_explain_json(FILE *to, const struct explanation *x, struct errinfo *e);

/* The same as explain.json, into o. */
void ctl_explain_out(struct ctl_out *o, const struct explanation *x);

typedef enum status explain_writer(FILE *to, const struct explanation *x,
                                   struct errinfo *e);

#endif
