/* surfacectl explain: why a scan matches a subject or a template, or not. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "cloudpoints.h"
#include "ctl_command.h"
#include "ctl_face.h"
#include "ctl_model.h"
#include "describe.h"
#include "mem.h"
#include "page.h"
#include "select.h"

static const char *page; /* --page */

#define BEYOND_MM 1.0 /* the share of the gaps beyond this is reported */

struct explanation {
    struct ctl_nearest best;
    struct store_template stored; /* of which tmpl is */
    struct surface_face *tmpl, *probe;
    struct cloudpoints pts; /* of the probe */
    size_t compared;        /* points that have a gap; these are of their amounts */
    double median_mm, most_mm, beyond;
};

/* How far the probe's points lie off the template, as measured. */
static enum status measure_gaps(struct explanation *x)
{
    const double *t = x->best.minimal.align_transform;
    double *v = mem_array(x->pts.n, sizeof *v);
    size_t n = 0, beyond = 0;
    enum status st =
        v != NULL ? status_from(surface_gaps(x->tmpl, (const double(*)[3])x->pts.at,
                                             x->pts.n, t, v))
                  : ST_ENOMEM;

    for (size_t i = 0; st == ST_OK && i < x->pts.n; i++)
        if (!isnan(v[i])) {
            v[n] = fabs(v[i]);
            beyond += v[n++] > BEYOND_MM;
        }
    x->compared = n;
    x->median_mm = x->most_mm = x->beyond = (double)NAN;
    if (st == ST_OK && n > 0) {
        select_sort(v, n);
        x->median_mm = v[n / 2];
        x->most_mm = v[n * 95 / 100];
        x->beyond = (double)beyond / (double)n;
    }
    mem_free(v);
    return st;
}

static enum status ctl_explain_compare(struct ctl *c, struct explanation *x)
{
    struct sample_found found;
    enum status st = ctl_face_parse(c, c->args[1], &x->pts);

    if (st != ST_OK || (st = ctl_face_build(c, c->args[1], &x->pts, false, c->work,
                                            &x->probe, &found)) != ST_OK)
        return st;
    st = ctl_face_nearest(c, &(struct templates_of){.subject = c->args[0]}, x->probe,
                          &x->best);
    if (st == ST_ENOTFOUND && ident_id_valid(c->args[0]))
        st = ctl_face_nearest(c, &(struct templates_of){.template_id = c->args[0]},
                              x->probe, &x->best);
    if (st == ST_OK)
        st = store_template_load(c->store, x->best.tmpl.id, &x->stored, c->work, &x->tmpl,
                                 &c->e);
    if (st == ST_OK)
        st = store_event(c->store, "explain", c->actor, x->stored.subject, x->stored.id,
                         templates_decision(x->best.nearest.result.decision), &c->e);
    if (st != ST_OK)
        return st;
    st = measure_gaps(x);
    return st == ST_OK ? st : errinfo_set(&c->e, st, "comparing: %s", status_message(st));
}

/* Why the decision is what it is, in a sentence. */
static const char *reason(const struct surface_comparison *r)
{
    return r->decision == SURFACE_MATCH ? "the score reaches the threshold"
           : r->decision == SURFACE_NO_MATCH
               ? "the score is below the threshold"
               : "the scans have too little in common, or are too noisy, for a decision";
}

static void print_quality(const char *who, const struct surface_face *f)
{
    const struct surface_quality q = surface_face_quality(f);

    (void)printf("%-12s %u points, quality %.2f (coverage %.2f, a point every %.2f mm, "
                 "noise %.3f mm)",
                 who, surface_face_points(f, NULL), q.score, q.coverage, q.density_mm,
                 q.noise_mm);
    ctl_face_reasons(stdout, f);
}

static void print_text(const struct ctl *c, const struct explanation *x)
{
    const struct surface_comparison *r = &x->best.nearest.result;

    (void)printf("subject      %s\ntemplate     %s, with the highest score of %u\n",
                 x->stored.subject, x->stored.id, x->best.nearest.compared);
    (void)printf("probe        %s\n", c->args[1]);
    (void)printf("decision     %s: %s\n", templates_decision(r->decision), reason(r));
    ctl_face_score(stdout, r);
    ctl_face_minimal(stdout, &x->best.minimal);
    (void)printf("expected     %.2f for two such scans of one person\n", r->expected);
    (void)printf("common       %.0f %% of the template's face\n", 100 * r->overlap);
    ctl_face_alignment(stdout, &x->best.minimal);
    ctl_face_regions(stdout, &x->best.parts);
    print_quality("template", x->tmpl);
    print_quality("probe", x->probe);
    (void)printf(
        "gap          at %zu of %zu points: median %.3f mm, 95 %% below %.3f mm, "
        "%.1f %% beyond %g mm\n",
        x->compared, x->pts.n, x->median_mm, x->most_mm, 100 * x->beyond, BEYOND_MM);
}

static struct describe_comparison comparison(const struct ctl *c,
                                             const struct explanation *x)
{
    return (struct describe_comparison){.result = &x->best.nearest.result,
                                        .minimal = &x->best.minimal,
                                        .probe = x->probe,
                                        .engine = c->engine,
                                        .subject = x->stored.subject,
                                        .template_id = x->stored.id,
                                        .templates_compared = x->best.nearest.compared,
                                        .parts = &x->best.parts};
}

static enum status ctl_explain_write_page(struct ctl *c, const struct explanation *x)
{
    const struct describe_comparison of = comparison(c, x);
    struct json *j = json_new();
    char about[64];

    (void)snprintf(about, sizeof about, "template %.8s, enrolled", x->stored.id);
    json_object(j, "extras");
    page_side(j, "a", x->stored.subject, about, x->stored.created,
              surface_face_quality(x->tmpl).score);
    return ctl_face_page(c, page, x->tmpl, &of, j);
}

static void ctl_explain_report(struct ctl *c, const struct explanation *x)
{
    const struct surface_comparison *r = &x->best.nearest.result;
    const struct surface_quality quality = surface_face_quality(x->tmpl);
    const struct describe_comparison of = comparison(c, x);

    json_text(c->out, "probe", c->args[1]);
    describe_comparison(c->out, &of);
    describe_quality(c->out, "template_quality", &quality, x->tmpl);
    json_text(c->out, "reason", reason(r));
    json_score(c->out, "expected", r->expected);
    json_object(c->out, "gap");
    json_number(c->out, "points", (double)x->pts.n);
    json_number(c->out, "compared", (double)x->compared);
    json_number(c->out, "median_mm", x->median_mm);
    json_number(c->out, "most_mm", x->most_mm);
    json_number(c->out, "limit_mm", BEYOND_MM);
    json_number(c->out, "share_beyond", x->beyond);
    json_close(c->out);
    json_object(c->out, "cells");
    describe_cells(c->out, &x->best.parts);
    json_close(c->out);
}

static enum status ctl_explain_run(struct ctl *c)
{
    struct explanation x = {.compared = 0};
    enum status st = page != NULL ? ctl_may_write(c, page, c->nargs) : ST_OK;

    if (st == ST_OK)
        st = ctl_explain_compare(c, &x);
    if (st == ST_OK && page != NULL)
        st = ctl_explain_write_page(c, &x);
    if (st == ST_OK) {
        if (c->json)
            ctl_explain_report(c, &x);
        else
            print_text(c, &x);
        c->code = ctl_face_exit(x.best.nearest.result.decision);
    }
    surface_face_free(x.tmpl);
    surface_face_free(x.probe);
    cloudpoints_free(&x.pts);
    return st;
}

const struct ctl_command ctl_explain = {
    .name = "explain",
    .args = "SUBJECT|TEMPLATE FILE",
    .takes = {2, 2},
    .database = CTL_WRITES_DATABASE,
    .shared = CTL_SCANS | CTL_MODEL | CTL_FORCE,
    .options = {CTL_OPTION(
        "page", "FILE", command_text, &page,
        "write a page for a browser (HTML): both faces, and what decided")},
    .exits = {"match", "no match", CTL_INCONCLUSIVE},
    .run = ctl_explain_run,
    .summary = "say why a scan matches a subject, or not",
    .help =
        "Compares FILE with the subject's templates, or with the template named, and prints for\n"
        "the one with the highest score: the score of each region, the qualities and the gap;\n"
        "with --json also what each cell of the face adds to the score. The audit log records\n"
        "it. --page writes one file that shows it in any browser, without a network; it is\n"
        "biometric data: only its owner can read it. surfacectl compare has it of two files.",
    .example = "surfacectl --db faces.db explain alice probe.ply --page why.html"};
