#include "sample.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "advice.h"
#include "cloudpoints.h"
#include "digest.h"
#include "errinfo.h"
#include "mem.h"

/* To the end of the message, as far as there is room. */
__attribute__((format(printf, 2, 3))) static void append(struct errinfo *e,
                                                         const char *fmt, ...)
{
    const size_t len = strlen(e->msg);
    va_list ap;

    va_start(ap, fmt);
    (void)vsnprintf(e->msg + len, sizeof e->msg - len, fmt, ap);
    va_end(ap);
}

/* By how much the evidence for a face is too little. */
static void tell_evidence(const struct surface_found *f, struct errinfo *e)
{
    const struct {
        const char *what;
        double is, wanted;
    } row[] = {{"support", f->support, f->support_wanted},
               {"evidence", f->evidence, f->evidence_wanted}};
    const char *begin = " (";

    for (size_t i = 0; f->support_wanted > 0 && i < sizeof row / sizeof *row; i++) {
        if (row[i].is >= row[i].wanted)
            continue;
        append(e, "%s%s %.2f, at least %.2f wanted", begin, row[i].what, row[i].is,
               row[i].wanted);
        begin = "; ";
    }
    if (begin[0] == ';')
        append(e, ")");
}

/* What of a face is there, and too poor. */
static void tell_quality(const struct surface_found *f, struct errinfo *e)
{
    const struct surface_quality *q = &f->quality;
    const bool sparse = f->seen < f->seen_wanted && q->density_mm > SURFACE_SPARSE_MM;
    const char *comma = "";

    if (sparse) {
        append(e, "a point every %.1f mm is too few to see the face by", q->density_mm);
        comma = ", ";
    }
    if (f->occluded > SURFACE_OCCLUDED_MOST) { /* less is a warning, and not the reason */
        append(e, "too much of the face is covered");
        comma = ", ";
    }
    if (f->seen < f->seen_wanted) {
        append(e, "%s%.0f %% of the face seen, at least %.0f %% wanted", comma,
               100 * f->seen, 100 * f->seen_wanted);
        comma = ", ";
    }
    if (f->residual_mm > f->residual_most) {
        append(e,
               "%sthe surface deviates from the shape of a face by %.1f mm, at most "
               "%.1f mm allowed",
               comma, f->residual_mm, f->residual_most);
        comma = ", ";
    }
    if ((f->warnings >> SURFACE_TURNED & 1) != 0) {
        append(e, "%sthe face is turned away from the scanner", comma);
        comma = ", ";
    }
    if (q->density_mm > 0 && !sparse &&
        (comma[0] == '\0' || surface_quality_reasons(q, NULL) != 0))
        append(e,
               "%snoise %.1f mm, %.0f %% of the outline measured, a point every %.1f mm",
               comma, q->noise_mm, 100 * q->coverage, q->density_mm);
    else if (comma[0] == '\0')
        append(e, "too little of a face was measured");
}

/* What was measured. */
static void sample_tell_found(enum status st, const struct surface_found *f, size_t n,
                              struct errinfo *e)
{
    const double *x = f->extent;

    switch (st) {
    case ST_ETOOFEW:
        append(e, "%zu points, fewer than %d at different places", n, SURFACE_MIN_POINTS);
        break;
    case ST_ENOTFINITE:
        append(e, "point %zu of %zu is not three finite numbers", f->bad + 1, n);
        break;
    case ST_ERANGE:
        append(e, "point %zu of %zu has a coordinate beyond %.0f mm", f->bad + 1, n,
               SURFACE_FARTHEST_MM);
        break;
    case ST_EDEGENERATE:
        append(e, "the %zu points lie on one line or at one place", n);
        break;
    case ST_EUNITS:
        if (f->fits_mm > 0) {
            append(e, "a face in none of the units; at about %.7g mm a %s it would be",
                   advice_round(f->fits_mm), f->unit_found ? "unit" : "depth value");
            break;
        }
        append(e,
               "the extent is %.4g x %.4g x %.4g in the units %s; a face has %d to %d mm",
               x[0], x[1], x[2], f->unit_found ? "detected, mm" : "given",
               SURFACE_EXTENT_MIN_MM, SURFACE_EXTENT_MAX_MM);
        break;
    case ST_ENOFACE:
        append(e, "no face was found among %zu points, %.4g x %.4g x %.4g in extent", n,
               x[0], x[1], x[2]);
        break;
    case ST_ESEVERAL:
        append(e, "an enrolment needs exactly one face");
        break;
    case ST_EMIRRORED:
        append(e, "its normals or the order of its points are those of a mirror image");
        break;
    case ST_ENOTFACE:
        append(e, "the surface does not have the shape of a face");
        tell_evidence(f, e);
        break;
    case ST_EQUALITY:
        tell_quality(f, e);
        break;
    default:
        append(e, "%s", status_message(st));
    }
}

/* The advice, as many whole lines of it as there is room for. */
static void tell_advice(const struct advice *a, struct errinfo *e)
{
    for (size_t i = 0; i < a->n; i++)
        if (strlen(e->msg) + 2 + strlen(a->line[i]) < sizeof e->msg)
            append(e, "%s%s", i == 0 ? ": " : "; ", a->line[i]);
}

/* ---- a scan, ready for the library */

struct sample_found sample_begin(const struct cloudpoints *c)
{
    return (struct sample_found){.format = (enum cloudformat)c->format,
                                 .points_read = c->read,
                                 .points_dropped = c->read - c->n,
                                 .scan = {0}};
}

static int is_stopped(const void *stop)
{
    const atomic_bool *is = stop;

    return is != NULL && atomic_load_explicit(is, memory_order_relaxed);
}

enum status sample_not_stopped(const atomic_bool *stop, struct errinfo *e)
{
    return is_stopped(stop) ? errinfo_set(e, ST_EBUSY, "the client has disconnected")
                            : ST_OK;
}

struct store_scan sample_counted(const struct surface_face *face)
{
    const struct surface_quality q = surface_face_quality(face);

    return (struct store_scan){.noise_mm = q.noise_mm, .quality = q.score};
}

struct surface_stop sample_stop(const struct sample_options *o)
{
    return (struct surface_stop){is_stopped, o->stop};
}

struct surface_cloud sample_cloud(const struct cloudpoints *c,
                                  const struct sample_options *o,
                                  const struct surface_stop *stop)
{
    return (struct surface_cloud){
        .points = (const double(*)[3])c->at,
        .normals = (const double(*)[3])c->normal,
        .n = c->n,
        .width = c->width,
        .height = c->height,
        .unit_mm = c->axes_given && c->unit_mm == 0 ? c->usual_mm : c->unit_mm,
        .flags = (c->axes_given ? SURFACE_FRONTAL : 0U) |
                 (c->pinhole ? SURFACE_PINHOLE : 0U) |
                 (o->enrolment ? SURFACE_ENROLMENT : 0U),
        .place = c->index,
        .stop = stop};
}

void sample_tell(const struct cloudpoints *c, struct surface_found *found)
{
    found->unit_found = c->unit_mm == 0;
    if (!found->unit_found)
        found->fits_mm *= c->value_mm;
}

void sample_refuse(const char *name, enum status st, const struct sample_found *found,
                   struct errinfo *e)
{
    struct advice advice;

    advice_give(st, &found->scan, NULL, &advice);
    (void)errinfo_set(e, st, "%.80s: ", name);
    sample_tell_found(st, &found->scan, found->points_read - found->points_dropped, e);
    tell_advice(&advice, e);
}

bool sample_open(struct cloudpoints *c, const struct sample_options *o,
                 const struct surface_stop *stop, struct surface_cloud *cloud,
                 struct sample_found *found)
{
    *found = sample_begin(c);
    digest_scan(c, found->digest);
    *cloud = sample_cloud(c, o, stop);
    if (c->index == NULL)
        c->index = mem_array(c->n + 1, sizeof *c->index);
    cloud->kept = (double(*)[3])c->at;
    cloud->kept_place = c->index;
    return c->index != NULL;
}

void sample_close(struct cloudpoints *c, struct sample_found *found)
{
    sample_tell(c, &found->scan);
    c->n = found->scan.kept;
    mem_free(c->normal);
    c->normal = NULL;
}

enum status sample_build(const char *name, struct cloudpoints *c,
                         const struct sample_options *o, struct surface_work *w,
                         struct surface_face **out, struct sample_found *found,
                         struct errinfo *e)
{
    const struct surface_stop stop = sample_stop(o);
    struct surface_cloud cloud;
    enum status st = ST_ENOMEM;

    if (sample_open(c, o, &stop, &cloud, found))
        st = status_from(surface_build(w, &cloud, out, &found->scan));
    sample_close(c, found);
    if (st != ST_OK)
        sample_refuse(name, st, found, e);
    return st;
}
