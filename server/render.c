#include "render.h"

#include <math.h>
#include <stdio.h>

#include "asymmetry.h"
#include "errmap.h"
#include "face.h"
#include "frame.h"
#include "json.h"
#include "quality.h"
#include "verdict.h"

/* null for "" */
static void text_or_null(struct json *j, const char *key, const char *value)
{
    json_text(j, key, value[0] != '\0' ? value : NULL);
}

static void quality(struct json *j, const struct quality *q, const struct frame *frame)
{
    const unsigned reasons = quality_reasons(q, frame);

    json_object(j, "quality");
    json_number(j, "score", q->score);
    json_number(j, "coverage", q->coverage);
    json_number(j, "density_mm", q->density_mm);
    json_number(j, "noise_mm", q->noise_mm);
    json_array(j, "reasons");
    for (int i = 0; i < QUALITY_REASONS; i++)
        if (reasons & (1U << i))
            json_text(j, NULL, quality_reason_name((enum quality_reason)i));
    json_close(j);
    json_close(j);
}

static const char *const stop[] = {
    [ALIGN_CONVERGED] = "converged", [ALIGN_STEPS] = "steps", [ALIGN_APART] = "apart"};

static void alignment(struct json *j, const struct align_result *a)
{
    json_object(j, "alignment");
    json_transform(j, "transform", a->transform);
    json_number(j, "starts", a->starts);
    json_number(j, "evaluations", a->evaluations);
    json_text(j, "stop", stop[a->stop]);
    json_number(j, "turn_deg", a->turn_deg);
    json_number(j, "shift_mm", a->shift_mm);
    json_number(j, "cost_mm", a->cost_mm);
    json_number(j, "rival_mm", a->rival_mm);
    json_close(j);
}

/* What tells more of the template than whether it is the same face. */
static void measure(struct json *j, const struct face_result *r)
{
    json_object(j, "plain");
    json_extent(j, "volume_mm3", r->disparity.volume_mm3);
    json_extent(j, "overlap_mm2", r->disparity.area_mm2);
    json_extent(j, "bridged_mm2", r->disparity.bridged_mm2);
    json_close(j);
    alignment(j, &r->align);
    json_number(j, "weight_overlap", r->weight_overlap);
    json_number(j, "change_mm", r->change_mm);
    json_object(j, "regions");
    for (int i = 0; i < GRID_REGIONS; i++)
        json_number(j, grid_region_name((enum grid_region)i), r->region_mm[i]);
    json_close(j);
}

char *render_verdict(const struct render_verdict *v)
{
    const struct face_result *r = v->result;
    struct json *j = json_new();

    json_text(j, "decision", verdict_decision(r->decision));
    json_number(j, "disparity_mm", r->score_mm);
    json_number(j, "threshold_mm", r->threshold_mm);
    json_rate(j, "fmr_at_score", r->fmr_at_score);
    json_number(j, "plain_mm", r->disparity.plain_mm);
    json_number(j, "overlap", r->disparity.overlap);
    json_text(j, "subject", v->subject);
    json_text(j, "template_id", v->template_id);
    json_number(j, "templates_compared", v->templates_compared);
    quality(j, &v->probe->quality, &v->probe->frame);
    json_text(j, "engine", v->engine);
    if (v->measure)
        measure(j, r);
    if (v->gap_mm != NULL) {
        json_array(j, "heatmap");
        for (size_t i = 0; i < v->n; i++)
            json_number(j, NULL, v->gap_mm[i]);
        json_close(j);
    }
    json_object(j, "timing_ms");
    json_number(j, "parse", v->parse_ms);
    json_number(j, "prepare", v->prepare_ms);
    json_number(j, "align", v->align_ms);
    json_number(j, "measure", v->measure_ms);
    json_number(j, "total", v->total_ms);
    return json_compact(j);
}

char *render_asymmetry(const struct render_asymmetry *v)
{
    const struct asymmetry *a = v->result;
    struct json *j = json_new();

    json_flag(j, "conclusive", asymmetry_conclusive(a));
    json_number(j, "disparity_mm", a->final.plain_mm);
    json_number(j, "first_mm", a->initial.plain_mm);
    json_extent(j, "volume_mm3", a->final.volume_mm3);
    json_extent(j, "overlap_mm2", a->final.area_mm2);
    json_number(j, "overlap", a->final.overlap);
    json_object(j, "plane");
    json_direction(j, "normal", a->normal);
    json_number(j, "offset_mm", a->offset_mm);
    json_number(j, "moved_deg", a->moved_deg);
    json_number(j, "moved_mm", a->moved_mm);
    json_number(j, "evaluations", a->evaluations);
    json_text(j, "stop", stop[a->stop]);
    json_number(j, "turn_deg", a->turn_deg);
    json_number(j, "shift_mm", a->shift_mm);
    json_close(j);
    quality(j, &v->face->quality, &v->face->frame);
    json_text(j, "engine", v->engine);
    json_object(j, "timing_ms");
    json_number(j, "parse", v->parse_ms);
    json_number(j, "prepare", v->prepare_ms);
    json_number(j, "measure", v->measure_ms);
    json_number(j, "total", v->total_ms);
    return json_compact(j);
}

char *render_problem(const struct errmap *m, const char *detail, const char *request_id,
                     const struct face_result *mismatch)
{
    struct json *j = json_new();
    char type[96];

    (void)snprintf(type, sizeof type, "urn:surfaced:problem:%s", m->code);
    json_text(j, "type", type);
    json_text(j, "title", m->title);
    json_number(j, "status", m->http);
    json_text(j, "detail", detail);
    json_text(j, "code", m->code);
    json_text(j, "request_id", request_id);
    if (mismatch != NULL) {
        json_text(j, "decision", verdict_decision(mismatch->decision));
        json_number(j, "disparity_mm", mismatch->score_mm);
        json_number(j, "threshold_mm", mismatch->threshold_mm);
    }
    return json_compact(j);
}

static void members_of_template(struct json *j, const struct store_template *t,
                                const struct frame *frame)
{
    json_text(j, "template_id", t->id);
    json_text(j, "subject", t->subject);
    json_text(j, "label", t->label);
    json_text(j, "created", t->created);
    json_number(j, "points", t->points);
    json_number(j, "triangles", t->triangles);
    json_text(j, "digest", t->digest);
    quality(j, &t->quality, frame);
    json_text(j, "engine", t->engine);
}

char *render_template(const struct store_template *t, const struct frame *frame)
{
    struct json *j = json_new();

    members_of_template(j, t, frame);
    return json_compact(j);
}

char *render_subject(const struct store_subject *s, const struct store_template *t,
                     size_t n)
{
    struct json *j = json_new();

    json_text(j, "subject", s->id);
    json_text(j, "created", s->created);
    text_or_null(j, "consent", s->reference);
    text_or_null(j, "purpose", s->purpose);
    text_or_null(j, "expires_at", s->expires);
    text_or_null(j, "last_seen", s->seen);
    json_flag(j, "hold", s->hold);
    json_flag(j, "disabled", s->disabled);
    json_array(j, "templates");
    for (size_t i = 0; i < n; i++) {
        json_object(j, NULL);
        members_of_template(j, &t[i], NULL);
        json_close(j);
    }
    return json_compact(j);
}

char *render_subjects(const struct store_subject *s, size_t n, bool more)
{
    struct json *j = json_new();
    char cursor[24] = "";

    json_array(j, "subjects");
    for (size_t i = 0; i < n; i++) {
        json_object(j, NULL);
        json_text(j, "subject", s[i].id);
        json_text(j, "created", s[i].created);
        json_number(j, "templates", s[i].templates);
        json_close(j);
    }
    json_close(j);
    if (more && n > 0)
        (void)snprintf(cursor, sizeof cursor, "%lld", (long long)s[n - 1].key);
    text_or_null(j, "next_cursor", cursor);
    return json_compact(j);
}

char *render_erased(const struct store_receipt *r)
{
    struct json *j = json_new();

    json_text(j, "subject", r->subject);
    json_number(j, "templates_removed", r->templates);
    json_array(j, "template_ids");
    for (uint32_t i = 0; i < r->templates; i++)
        json_text(j, NULL, r->template_id[i]);
    json_close(j);
    json_text(j, "erased_at", r->at);
    json_text(j, "digest", r->digest);
    json_object(j, "audit");
    json_number(j, "seq", (double)r->seq);
    json_text(j, "hash", r->hash);
    json_close(j);
    json_text(j, "signature", r->signature);
    json_text(j, "public_key", r->public_key);
    return json_compact(j);
}

char *render_state(const char *state)
{
    struct json *j = json_new();

    json_text(j, "status", state);
    return json_compact(j);
}

char *render_ready(const struct store_calibration *k)
{
    const struct decision *d = &k->decision;
    struct json *j = json_new();

    json_text(j, "status", "ready");
    json_object(j, "calibration");
    json_number(j, "version", (double)k->version);
    json_text(j, "source", k->shipped ? "shipped" : "database");
    json_text(j, "ignored", k->ignored ? k->engine : NULL);
    json_number(j, "threshold_mm", d->threshold_mm);
    json_rate(j, "fmr", decision_fmr(d, d->threshold_mm));
    return json_compact(j);
}

char *render_version(const char *version, const char *engine, const char *compiler)
{
    struct json *j = json_new();

    json_text(j, "version", version);
    json_text(j, "engine", engine);
    json_text(j, "compiler", compiler);
    return json_compact(j);
}
