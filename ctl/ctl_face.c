#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "describe.h"
#include "frame.h"
#include "grid.h"
#include "quality.h"
#include "verdict.h"
#include "ctl.h"

static double clock_ms(void)
{
    struct timespec t;

    (void)clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

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
                                    .clock_ms = clock_ms,
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
                            struct face_work *w, struct enrolment_outcome *out)
{
    struct shelf shelf;
    struct nearest_context with = context(&shelf, s, w);
    const enum status st = enrolment_add(&with, x, out, &c->e);

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
        (void)fprintf(to, "how well it is known cannot be told");
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

static void print_result(struct ctl *c, const struct describe_comparison *x)
{
    const struct face_result *r = x->result;

    describe_comparison(ctl_out_document(c->out), x);
    if (c->json)
        return;
    (void)printf("decision     %s\n", verdict_decision(r->decision));
    (void)printf("disparity    %.3f mm (threshold %.3f mm)\n", r->score_mm,
                 r->threshold_mm);
    (void)printf("impostors    a share of %.2g would score this low or lower\n",
                 r->fmr_at_score);
    (void)printf("common       %.0f %% of the template's area, %.0f %% of the weight\n",
                 100 * r->disparity.overlap, 100 * r->weight_overlap);
    (void)printf("change       %.3f mm taken out as change of one face\n", r->change_mm);
    ctl_face_alignment(stdout, &r->align);
    ctl_face_regions(stdout, r);
    (void)printf("plain        %.3f mm (%.1f mm3 over %.1f mm2)\n", r->disparity.plain_mm,
                 r->disparity.volume_mm3, r->disparity.area_mm2);
    (void)printf("scan         %u points, quality %.2f", x->probe->surface.mesh.nv,
                 x->probe->quality.score);
    ctl_face_reasons(stdout, x->probe);
    (void)printf("time         %.1f ms\n", x->times->total);
}

int ctl_face_verify(struct ctl *c)
{
    const char *subject = c->args[0];
    struct face_work *w = face_work_new(c->model);
    struct face probe = {0};
    struct store *s = NULL;
    struct ctl_nearest best;
    double start = 0;
    enum status st;

    if (w == NULL)
        st = errinfo_set(&c->e, ST_ENOMEM, "out of memory");
    else
        st = ctl_model_store(c, STORE_WRITE, &s);
    start = clock_ms();
    if (st == ST_OK)
        st = ctl_scan_read(c, c->args[1], w, &probe);
    if (st == ST_OK)
        st = ctl_face_nearest(c, s, subject, &probe, w, &best);
    if (st == ST_OK)
        st = store_event(s, "verify", CTL_ACTOR, subject, best.tmpl.id,
                         verdict_decision(best.nearest.result.decision), &c->e);
    if (st == ST_OK) {
        store_subject_seen(s, &best.subject);
        print_result(c, &(struct describe_comparison){
                            .result = &best.nearest.result,
                            .probe = &probe,
                            .engine = c->engine,
                            .subject = subject,
                            .template_id = best.tmpl.id,
                            .templates_compared = best.nearest.compared,
                            .measure = true,
                            .times = &(struct describe_times){
                                NAN, NAN, best.nearest.align_ms, best.nearest.measure_ms,
                                clock_ms() - start}});
        if (!c->json)
            (void)printf("template     %s (the nearest of %u of %s, enrolled %s)\n",
                         best.tmpl.id, best.nearest.compared, subject, best.tmpl.created);
    }
    store_close(s);
    face_free(&probe);
    face_work_free(w);
    return st == ST_OK ? ctl_face_exit(best.nearest.result.decision) : ctl_fail(c, st);
}

int ctl_face_compare(struct ctl *c)
{
    const double start = clock_ms();
    struct face_work *w = face_work_new(c->model);
    struct face a = {0}, b = {0};
    struct face_result r;
    enum status st;

    if (w == NULL)
        st = errinfo_set(&c->e, ST_ENOMEM, "out of memory");
    else if ((st = ctl_scan_read(c, c->args[0], w, &a)) == ST_OK &&
             (st = ctl_scan_read(c, c->args[1], w, &b)) == ST_OK &&
             (st = face_compare(&a, &b, 0.0, clock_ms, w, &r)) != ST_OK)
        (void)errinfo_set(&c->e, st, "comparing: %s", status_message(st));
    if (st == ST_OK)
        print_result(c, &(struct describe_comparison){
                            .result = &r,
                            .probe = &b,
                            .engine = c->engine,
                            .templates_compared = 1,
                            .measure = true,
                            .times = &(struct describe_times){
                                NAN, NAN, r.align_ms, r.measure_ms, clock_ms() - start}});
    face_free(&a);
    face_free(&b);
    face_work_free(w);
    return st == ST_OK ? ctl_face_exit(r.decision) : ctl_fail(c, st);
}
