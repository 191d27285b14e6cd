#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "frame.h"
#include "grid.h"
#include "quality.h"
#include "verdict.h"
#include "ctl.h"
#include "ctl_face.h"

int ctl_face_exit(enum face_decision d)
{
    return d == FACE_MATCH ? EXIT_FINE : d == FACE_NO_MATCH ? EXIT_NO : EXIT_INCONCLUSIVE;
}

/* Models as nearest.h takes them: loaded from the store into one face. */
struct shelf {
    struct store *store;
    struct face face;
};

static enum status hold(void *arg, const char *id, struct face_work *w,
                        const struct face **out, struct errinfo *e)
{
    struct shelf *s = arg;
    struct store_template t;

    *out = &s->face;
    return store_template_load(s->store, id, &t, w, &s->face, e);
}

static void release(void *arg, const struct face *f)
{
    (void)arg;
    (void)f;
}

static void pass_over(void *arg, const struct errinfo *e)
{
    (void)arg;
    (void)fprintf(stderr, "surfacectl: passed over: %s\n", e->msg);
}

static struct nearest_context context(struct shelf *shelf, struct store *s,
                                      struct face_work *w)
{
    *shelf = (struct shelf){.store = s};
    return (struct nearest_context){.store = s,
                                    .work = w,
                                    .clock_ms = ctl_clock_ms,
                                    .hold = hold,
                                    .release = release,
                                    .pass_over = pass_over,
                                    .arg = shelf};
}

/* Templates t[0..n-1] are subject's. */
static enum status nearest(struct ctl *c, struct store *s, const char *subject,
                           const struct store_template *t, size_t n,
                           const struct face *probe, struct face_work *w,
                           struct ctl_nearest *best)
{
    struct shelf shelf;
    struct nearest_context with = context(&shelf, s, w);
    enum status st = store_subject_get(s, subject, &best->subject, &c->e);

    if (st == ST_OK && admit_subject(&best->subject, &c->e) != ADMIT_YES)
        st = ST_EDENIED;
    if (st == ST_OK)
        st = nearest_find(&with, t, n, probe, &best->nearest, &c->e);
    if (st == ST_OK)
        best->tmpl = t[best->nearest.index];
    face_free(&shelf.face);
    return st;
}

enum status ctl_face_nearest(struct ctl *c, struct store *s, const char *subject,
                             const struct face *probe, struct face_work *w,
                             struct ctl_nearest *best)
{
    struct store_template *t = NULL;
    size_t n = 0;
    enum status st = store_template_list(s, subject, &t, &n, &c->e);

    if (st == ST_OK)
        st = nearest(c, s, subject, t, n, probe, w, best);
    free(t);
    return st;
}

enum status ctl_face_template(struct ctl *c, struct store *s, const char *id,
                              const struct face *probe, struct face_work *w,
                              struct ctl_nearest *best)
{
    struct store_template t;
    const enum status st = store_template_get(s, id, &t, &c->e);

    return st == ST_OK ? nearest(c, s, t.subject, &t, 1, probe, w, best) : st;
}

enum status ctl_face_enroll(struct ctl *c, struct store *s, const struct enrolment *x,
                            const char *path, struct face_work *w,
                            struct enrolment_outcome *out)
{
    struct shelf shelf;
    struct nearest_context with = context(&shelf, s, w);
    const enum status st = enrolment_add(&with, x, out, &c->e);

    if (st == ST_EMISMATCH) {
        const struct errinfo e = c->e;

        (void)errinfo_set(&c->e, st, "%.100s: %s", path, e.msg);
    }
    face_free(&shelf.face);
    return st;
}

void ctl_face_regions(FILE *to, const struct face_result *r)
{
    (void)fprintf(to, "regions          score  of the weight\n");
    for (int i = 0; i < GRID_REGIONS; i++) {
        (void)fprintf(to, "  %-10s ", grid_region_name((enum grid_region)i));
        if (isnan(r->region_mm[i]))
            (void)fprintf(to, "%12s", "not covered");
        else
            (void)fprintf(to, "%9.3f mm", r->region_mm[i]);
        (void)fprintf(to, " %8.1f %%\n", 100 * r->region_weight[i]);
    }
}

void ctl_face_alignment(FILE *to, const struct align_result *a)
{
    (void)fprintf(to, "alignment    ");
    if (isfinite(a->turn_deg) && isfinite(a->shift_mm))
        (void)fprintf(to, "known to %.2f degrees and %.2f mm (one standard deviation)",
                      a->turn_deg, a->shift_mm);
    else
        (void)fprintf(to, "its uncertainty is not known");
    if (isfinite(a->rival_mm))
        (void)fprintf(to, "; mean gap %.2f mm, %.2f mm at the next best", a->cost_mm,
                      a->rival_mm);
    (void)fprintf(to, "\n");
}

void ctl_face_reasons(FILE *to, const struct face *f)
{
    const unsigned reasons = quality_reasons(&f->quality, &f->frame);
    const char *between = " (";

    for (int i = 0; i < QUALITY_REASONS; i++)
        if (reasons & (1U << i)) {
            (void)fprintf(to, "%s%s", between,
                          quality_reason_name((enum quality_reason)i));
            between = ", ";
        }
    (void)fprintf(to, "%s\n", reasons != 0 ? ")" : "");
}
