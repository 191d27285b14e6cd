/* surfacectl explain: why a scan matches a subject or a template, or not. */
#include <stdio.h>
#include <stdlib.h>

#include "ctl_command.h"
#include "ctl_face.h"
#include "ctl_model.h"
#include "describe.h"
#include "page.h"
#include "show.h"

static const char *page; /* --page */

struct explanation {
    struct templates templates;
    struct templates_nearest best;
    struct surface_disparity minimal; /* against the template that decides, weighed */
    struct surface_parts parts;
    const struct store_template
        *stored; /* template that decides; belongs to templates, like tmpl */
    const struct surface_face *tmpl;
    struct surface_face *probe;
};

/* The argument names a subject, or else a template. */
static enum status read_templates(struct ctl *c, struct templates_context *with,
                                  struct templates *out)
{
    const char *id = c->args[0];
    enum status st =
        templates_read(with, &(struct templates_of){.subject = id}, out, &c->e);

    if (st != ST_ENOTFOUND || !ident_id_valid(id))
        return st;
    templates_free(out);
    return templates_read(with, &(struct templates_of){.template_id = id}, out, &c->e);
}

static enum status ctl_explain_compare(struct ctl *c, struct templates_context *with,
                                       struct explanation *x)
{
    struct sample_found found;
    enum status st = ctl_face_read(c, c->args[1], false, c->work, &x->probe, &found);

    if (st != ST_OK)
        return st;
    st = read_templates(c, with, &x->templates);
    if (st == ST_OK)
        st = templates_nearest(&x->templates, false, x->probe, &x->best, &c->e);
    ctl_face_passed_over(&x->templates);
    if (st == ST_OK)
        st = templates_minimal(&x->templates, x->probe, &x->best, &x->minimal, &x->parts,
                               &c->e);
    if (st != ST_OK)
        return st;
    x->stored = &x->templates.of.t[x->best.index];
    x->tmpl = x->templates.face[x->best.index];
    return store_event(c->store, "explain", c->actor, x->stored->subject, x->stored->id,
                       templates_decision(x->best.result.decision), &c->e);
}

/* Returns the reason of the decision. */
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
    const struct surface_comparison *r = &x->best.result;

    (void)printf("subject      %s\ntemplate     %s, with the highest score of %u\n",
                 x->stored->subject, x->stored->id, x->best.compared);
    (void)printf("probe        %s\n", c->args[1]);
    (void)printf("decision     %s: %s\n", templates_decision(r->decision), reason(r));
    ctl_face_score(stdout, r);
    ctl_face_minimal(stdout, &x->minimal);
    (void)printf("expected     %.2f for two such scans of one person\n", r->expected);
    (void)printf("common       %.0f %% of the template's face\n", 100 * r->overlap);
    ctl_face_alignment(stdout, &x->minimal);
    ctl_face_regions(stdout, &x->parts);
    print_quality("template", x->tmpl);
    print_quality("probe", x->probe);
}

static void comparison(struct json *j, const struct ctl *c, const struct explanation *x)
{
    describe_comparison(
        j, &(struct describe_comparison){.result = &x->best.result,
                                         .minimal = &x->minimal,
                                         .probe = x->probe,
                                         .engine = c->engine,
                                         .subject = x->stored->subject,
                                         .template_id = x->stored->id,
                                         .templates_compared = x->best.compared,
                                         .parts = &x->parts});
}

static enum status ctl_explain_write_page(struct ctl *c, const struct explanation *x)
{
    struct json *j = json_new();
    struct show show;
    char about[64];
    enum status st;

    (void)snprintf(about, sizeof about, "template %.8s, enrolled", x->stored->id);
    json_object(j, "extras");
    comparison(j, c, x);
    json_object(j, "calibration");
    show_calibration(j, surface_work_calibration(c->work));
    json_close(j);
    page_side(j, "a", x->stored->subject, about, x->stored->created,
              surface_face_quality(x->tmpl).score);
    page_file(j, "b", c->args[1], surface_face_quality(x->probe).score);
    page_made(j);
    json_close(j);
    st = show_comparison(x->tmpl, x->probe, x->minimal.align_transform, &x->parts, j,
                         &show);
    st = st == ST_OK ? ctl_write(c, page, page_write, &show)
                     : errinfo_set(&c->e, st, "%s: %s", page, status_message(st));
    free(show.glb);
    return st;
}

static void ctl_explain_report(struct ctl *c, const struct explanation *x)
{
    const struct surface_comparison *r = &x->best.result;
    const struct surface_quality quality = surface_face_quality(x->tmpl);

    json_text(c->out, "probe", c->args[1]);
    comparison(c->out, c, x);
    describe_quality(c->out, "template_quality", &quality, x->tmpl);
    json_text(c->out, "reason", reason(r));
    json_object(c->out, "cells");
    describe_cells(c->out, &x->parts);
    json_close(c->out);
}

static enum status ctl_explain_run(struct ctl *c)
{
    struct templates_context with = ctl_face_context(c, c->work);
    struct explanation x = {.tmpl = NULL};
    enum status st = page != NULL ? ctl_may_write(c, page, c->nargs) : ST_OK;

    if (st == ST_OK)
        st = ctl_explain_compare(c, &with, &x);
    if (st == ST_OK && page != NULL)
        st = ctl_explain_write_page(c, &x);
    if (st == ST_OK) {
        if (c->json)
            ctl_explain_report(c, &x);
        else
            print_text(c, &x);
        c->code = ctl_face_exit(x.best.result.decision);
    }
    templates_free(&x.templates);
    surface_face_free(x.probe);
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
        "For the template with the highest score: the score of each region and the qualities;\n"
        "with --json and --page also what each cell of the face adds to the score. The audit log\n"
        "records it.",
    .example = "surfacectl --db faces.db explain alice probe.ply --page why.html"};
