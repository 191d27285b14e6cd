#include "explain_text.h"

#include <math.h>

#include "describe.h"
#include "ctl_face.h"
#include "ctl.h"

/* Why the decision is what it is, in a sentence. */
static const char *reason(const struct face_result *r)
{
    return r->decision == FACE_MATCH      ? "the score is not below the threshold"
           : r->decision == FACE_NO_MATCH ? "the score is below the threshold"
                                          : "the scans have too little in common, or are "
                                            "too noisy, to tell";
}

/* What the comparison found; by region of the face at the end. */
static void print_result(FILE *to, const struct explanation *x)
{
    const struct face_result *r = &x->result;

    (void)fprintf(to, "decision     %s: %s\n", templates_decision(r->decision),
                  reason(r));
    ctl_face_score(to, r);
    ctl_face_minimal(to, &x->minimal);
    (void)fprintf(to, "expected     %.2f of two such scans of one person\n", r->expected);
    (void)fprintf(to, "common       %.0f %% of the template's face\n", 100 * r->overlap);
    ctl_face_alignment(to, &r->align);
    ctl_face_regions(to, r);
}

static void print_quality(FILE *to, const char *who, const struct face *f)
{
    (void)fprintf(to,
                  "%-12s %u points, quality %.2f (coverage %.2f, a point every %.2f mm, "
                  "noise %.3f mm)",
                  who, f->surface.mesh.nv, f->quality.score, f->quality.coverage,
                  f->quality.density_mm, f->quality.noise_mm);
    ctl_face_reasons(to, f);
}

static void print_spread(FILE *to, const struct explain_spread *s)
{
    if (s->n == 0)
        return;
    (void)fprintf(to, "  median     %+.3f mm (probe minus template)\n", s->median_mm);
    (void)fprintf(to, "  mean       %.3f mm (amount)\n", s->mean_mm);
    (void)fprintf(to, "  beyond     %.1f %% by more than %.3g mm\n", 100 * s->beyond,
                  EXPLAIN_BEYOND_MM);
    (void)fprintf(to, "  amount    ");
    for (int k = 0; k < EXPLAIN_QUANTILES; k++)
        (void)fprintf(to, " %.0f %%: %.3f%s", 100 * explain_levels[k], s->quantile_mm[k],
                      k + 1 < EXPLAIN_QUANTILES ? "," : " mm or less\n");
}

enum status explain_text(FILE *to, const void *arg, struct errinfo *e)
{
    const struct explanation *x = arg;
    const struct face_result *r = &x->result;

    (void)e;
    (void)fprintf(to, "template     %s\n", x->a);
    if (x->template_id != NULL)
        (void)fprintf(to, "             %s, with the highest score of %u\n",
                      x->template_id, x->compared);
    (void)fprintf(to, "probe        %s\n", x->b);
    print_result(to, x);
    print_quality(to, "template", &x->tmpl);
    print_quality(to, "probe", &x->probe);
    (void)fprintf(to,
                  "gap          as measured at %zu of %zu points of the probe; it does "
                  "not decide\n",
                  x->gap.n, x->n);
    print_spread(to, &x->gap);
    (void)fprintf(
        to,
        "cells        the gap of %zu cells of %g mm, each face in its own frame; of "
        "it the score is taken\n",
        x->cell.n, GRID_MM);
    print_spread(to, &x->cell);
    (void)fprintf(to, "transform    of the probe onto the template, mm\n");
    for (int i = 0; i < 16; i += 4)
        (void)fprintf(to, "  %12.6f %12.6f %12.6f %12.4f\n", r->align.transform[i],
                      r->align.transform[i + 1], r->align.transform[i + 2],
                      r->align.transform[i + 3]);
    return ST_OK;
}

static void out_spread(struct json *o, const struct explain_spread *s)
{
    json_number(o, "median_mm", s->median_mm);
    json_number(o, "mean_amount_mm", s->mean_mm);
    json_number(o, "limit_mm", EXPLAIN_BEYOND_MM);
    json_number(o, "share_beyond", s->beyond);
    json_array(o, "amount_quantiles");
    for (int k = 0; k < EXPLAIN_QUANTILES; k++) {
        json_object(o, NULL);
        json_number(o, "share", explain_levels[k]);
        json_number(o, "mm", s->quantile_mm[k]);
        json_close(o);
    }
    json_close(o);
}

void explain_text_out(struct json *o, const struct explanation *x)
{
    json_text(o, "template", x->a);
    json_text(o, "probe", x->b);
    describe_comparison(o,
                        &(struct describe_comparison){.result = &x->result,
                                                      .minimal = &x->minimal,
                                                      .probe = &x->probe,
                                                      .engine = x->engine,
                                                      .subject = x->subject,
                                                      .template_id = x->template_id,
                                                      .templates_compared = x->compared,
                                                      .measure = true});
    describe_quality(o, "template_quality", &x->tmpl.quality, &x->tmpl.frame);
    json_text(o, "reason", reason(&x->result));
    json_score(o, "expected", x->result.expected);
    json_object(o, "gap");
    json_number(o, "points", (double)x->n);
    json_number(o, "compared", (double)x->gap.n);
    out_spread(o, &x->gap);
    json_close(o);
    json_object(o, "cells");
    describe_cells(o, &x->field);
    json_number(o, "compared", (double)x->cell.n);
    out_spread(o, &x->cell);
    json_close(o);
}

enum status explain_text_json(FILE *to, const void *x, struct errinfo *e)
{
    struct json *j = json_new();

    explain_text_out(j, x);
    return ctl_print(to, json_pretty(j)) ? ST_OK
                                         : errinfo_set(e, ST_ENOMEM, "out of memory");
}
