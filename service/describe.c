#include "describe.h"

#include <ctype.h>
#include <math.h>

#include "cloudunit.h"
#include "cloudformat.h"
#include "json.h"
#include "sample.h"
#include "session.h"
#include "show.h"
#include "store.h"
#include "dry_run.h"
#include "templates.h"

void describe_quality(struct json *j, const char *key, const struct surface_quality *q,
                      const struct surface_face *face)
{
    const uint32_t reasons = surface_quality_reasons(q, face);

    json_object(j, key);
    json_number(j, "score", q->score);
    json_number(j, "coverage", q->coverage);
    json_number(j, "density_mm", q->density_mm);
    json_number(j, "noise_mm", q->noise_mm);
    json_array(j, "reasons");
    for (int i = 0; i < SURFACE_REASONS; i++)
        if (reasons & (1U << i))
            json_text(j, NULL, surface_reason_name((enum surface_reason)i));
    json_close(j);
    json_close(j);
}

/* "ply" */
static void format(struct json *j, enum cloudformat f)
{
    const char *name = cloudformat_name(f);
    char word[8];
    size_t n = 0;

    for (; n < sizeof word - 1 && name[n] != '\0'; n++)
        word[n] = (char)tolower((unsigned char)name[n]);
    word[n] = '\0';
    json_text(j, "format", word);
}

void describe_scan(struct json *j, const char *key, const struct sample_found *s)
{
    const struct surface_found *f = &s->scan;

    json_object(j, key);
    format(j, s->format);
    json_number(j, "points_read", (double)s->points_read);
    json_number(j, "points_dropped", (double)s->points_dropped);
    json_number(j, "points_used", (double)f->points_used);
    json_text_or_null(j, "units", cloudunit_name(f->unit_mm));
    if (f->unit_mm > 0 && f->view[15] == 1)
        json_similarity(j, "view", f->view, f->unit_mm);
    else
        json_text(j, "view", NULL);
    json_number(j, "yaw_deg", f->yaw_deg);
    json_number(j, "occluded", f->occluded);
    json_array(j, "warnings");
    for (int i = 0; i < SURFACE_WARNINGS; i++)
        if ((f->warnings >> i & 1) != 0)
            json_text(j, NULL, surface_warning_name((enum surface_warning)i));
    json_close(j);
    json_close(j);
}

void describe_subject(struct json *j, const struct store_subject *s)
{
    json_text(j, "subject", s->id);
    json_text(j, "created", s->created);
    json_text_or_null(j, "consent", s->reference);
    json_text_or_null(j, "purpose", s->purpose);
    json_text_or_null(j, "expires_at", s->expires);
    json_text_or_null(j, "last_seen", s->seen);
    json_flag(j, "hold", s->hold);
    json_flag(j, "disabled", s->disabled);
    json_flag(j, "identify", s->identify);
    describe_groups(j, s->groups);
}

void describe_subject_row(struct json *j, const struct store_subject *s)
{
    describe_subject(j, s);
    json_number(j, "templates", s->templates);
    json_number(j, "quality", s->quality);
}

void describe_attempts(struct json *j, const struct store_worst *a)
{
    json_object(j, "attempts");
    json_number(j, "failures", a->failures);
    json_text_or_null(j, "locked_until", a->until);
    json_close(j);
}

void describe_scopes(struct json *j, unsigned scopes)
{
    char name[STORE_SCOPES_MAX];

    json_array(j, "scopes");
    for (unsigned bit = 1; bit <= STORE_SCOPE_ALL; bit <<= 1)
        if (scopes & bit) {
            rows_scopes_write(bit, name);
            json_text(j, NULL, name);
        }
    json_close(j);
}

void describe_groups(struct json *j, const char *list)
{
    char label[GROUPS_LABEL + 1];

    json_array(j, "groups");
    while ((list = groups_next(list, label)) != NULL)
        json_text(j, NULL, label);
    json_close(j);
}

void describe_token(struct json *j, const struct store_token *t, const char *secret)
{
    json_text(j, "id", t->id);
    json_text(j, "name", t->name);
    describe_scopes(j, t->scopes);
    describe_groups(j, t->groups);
    json_text(j, "created", t->created);
    json_text_or_null(j, "expires_at", t->expires);
    json_text_or_null(j, "last_used", t->used);
    json_text_or_null(j, "old_secret_until", t->old_until);
    json_text_or_null(j, "revoked_at", t->revoked);
    json_text(j, "state", describe_token_state(t));
    if (secret != NULL)
        json_text(j, "secret", secret);
}

const char *describe_token_state(const struct store_token *t)
{
    return t->revoked[0] != '\0' ? "revoked" : t->expired ? "expired" : "valid";
}

void describe_template(struct json *j, const struct store_template *t,
                       const struct surface_face *face, bool how)
{
    json_text(j, "template_id", t->id);
    json_text(j, "subject", t->subject);
    json_text(j, "label", t->label);
    json_text(j, "created", t->created);
    json_number(j, "points", t->points);
    json_number(j, "triangles", t->triangles);
    json_text(j, "digest", t->digest);
    describe_quality(j, "quality", &t->quality, face);
    json_text(j, "engine", t->engine);
    if (!how)
        return;
    json_flag(j, "manager", t->manager);
    json_score(j, "first_score", t->first_score);
}

static void alignment(struct json *j, const struct surface_disparity *a)
{
    json_object(j, "alignment");
    json_transform(j, "transform", a->align_transform);
    json_number(j, "starts", a->starts);
    json_number(j, "evaluations", a->evaluations);
    json_text(j, "stop", a->stop);
    json_number(j, "turn_deg", a->turn_deg);
    json_number(j, "shift_mm", a->shift_mm);
    json_number(j, "cost_mm", a->cost_mm);
    json_number(j, "rival_mm", a->rival_mm);
    json_close(j);
}

/* What tells more of the template than whether it is the same face. */
static void describe_measure(struct json *j, const struct describe_comparison *c)
{
    const struct surface_disparity *m = c->minimal;

    json_score(j, "expected", c->result->expected);
    json_object(j, "minimal");
    json_extent(j, "volume_mm3", m->volume_mm3);
    json_extent(j, "overlap_mm2", m->area_mm2);
    json_number(j, "weighted_mm", m->weighted_mm);
    json_transform(j, "transform", m->transform);
    json_close(j);
    alignment(j, m);
    json_object(j, "regions");
    for (int i = 0; i < SURFACE_REGIONS; i++)
        json_score(j, surface_region_name((enum surface_region)i), c->parts->region[i]);
    json_close(j);
}

void describe_cells(struct json *j, const struct surface_parts *p)
{
    json_number(j, "mm", SURFACE_CELL_MM);
    json_number(j, "nx", SURFACE_CELLS_X);
    json_number(j, "ny", SURFACE_CELLS_Y);
    json_number(j, "left", SURFACE_CELLS_LEFT);
    json_number(j, "bottom", SURFACE_CELLS_BOTTOM);
    json_array(j, "part");
    for (uint32_t i = 0; i < SURFACE_CELLS; i++)
        json_number(j, NULL, (double)p->part[i]);
    json_close(j);
}

/* told: what took how long after the probe's face was made; scored: with score and align. */
static void times(struct json *j, const struct describe_times *t, bool told, bool scored)
{
    if (t == NULL)
        return;
    json_object(j, "timing_ms");
    json_number(j, "parse", t->parse);
    json_number(j, "prepare", t->prepare);
    if (scored) {
        json_number(j, "score", t->score);
        json_number(j, "align", t->align);
    }
    if (told) {
        json_number(j, "minimal", t->minimal);
        json_number(j, "total", t->total);
    }
    json_close(j);
}

static void ids(struct json *j, const struct describe_comparison *c)
{
    json_text(j, "subject", c->subject);
    json_text(j, "template_id", c->template_id);
}

static void scans(struct json *j, const struct describe_comparison *c)
{
    if (c->other != NULL) {
        json_object(j, "scan");
        describe_scan(j, "a", c->other);
        describe_scan(j, "b", c->scan);
        json_close(j);
    } else if (c->scan != NULL) {
        describe_scan(j, "scan", c->scan);
    }
}

static void quality_of(struct json *j, const char *key, const struct surface_face *f)
{
    const struct surface_quality quality = surface_face_quality(f);

    describe_quality(j, key, &quality, f);
}

static void qualities(struct json *j, const struct describe_comparison *c)
{
    if (c->other_face == NULL) {
        quality_of(j, "quality", c->probe);
        return;
    }
    json_object(j, "quality");
    quality_of(j, "a", c->other_face);
    quality_of(j, "b", c->probe);
    json_close(j);
}

static void numbers(struct json *j, const struct describe_comparison *c)
{
    const double mm = c->minimal->disparity_mm;
    double score, threshold;

    surface_shown(c->result, c->coarse ? 10 : 100, &score, &threshold);
    json_score(j, "score", score);
    json_score(j, "threshold", threshold);
    json_rate(j, "fmr_at_score", c->result->false_match_rate);
    json_number(j, "disparity_mm", c->coarse ? round(mm * 1e3) / 1e3 : mm);
    json_number(j, "overlap", c->result->overlap);
}

static void heatmap(struct json *j, const struct describe_comparison *c)
{
    json_array(j, "heatmap");
    for (size_t i = 0; i < c->n; i++)
        json_number(j, NULL, c->gap_mm[i]);
    json_close(j);
    json_object(j, "cells");
    describe_cells(j, c->parts);
    json_close(j);
}

void describe_comparison(struct json *j, const struct describe_comparison *c)
{
    const bool told = c->minimal != NULL;

    json_text(j, "decision", templates_decision(c->result->decision));
    if (told)
        numbers(j, c);
    ids(j, c);
    if (c->probe == NULL)
        return;
    if (told)
        json_number(j, "templates_compared", c->templates_compared);
    scans(j, c);
    if (c->frames != NULL)
        session_describe(j, c->frames);
    qualities(j, c);
    json_text(j, "engine", c->engine);
    if (c->parts != NULL)
        describe_measure(j, c);
    if (c->gap_mm != NULL)
        heatmap(j, c);
    times(j, c->times, told, told);
}

static void det_point(struct json *j, const char *key, const struct det_point *p)
{
    json_object(j, key);
    json_score(j, "score", p->score);
    json_rate(j, "fmr", p->fmr);
    json_rate(j, "fnmr", p->fnmr);
    json_rate(j, "low", p->low);
    json_rate(j, "high", p->high);
    json_close(j);
}

void describe_det(struct json *j, const char *key, const struct det *d)
{
    if (d == NULL) {
        json_text(j, key, NULL);
        return;
    }
    json_object(j, key);
    json_number(j, "people", d->people);
    json_number(j, "needed", DET_PEOPLE);
    if (d->n > 0) {
        det_point(j, "own", &d->own);
        det_point(j, "shipped", &d->shipped);
    }
    json_array(j, "points");
    for (uint32_t i = 0; i < d->n; i++)
        det_point(j, NULL, &d->point[i]);
    json_close(j);
    json_close(j);
}

void describe_asymmetry(struct json *j, const struct surface_asymmetry *a,
                        const struct surface_face *f, const char *engine,
                        const struct describe_times *t)
{
    const struct surface_quality q = surface_face_quality(f);

    show_asymmetry(j, a);
    describe_quality(j, "quality", &q, f);
    json_text(j, "engine", engine);
    times(j, t, true, false);
}

void describe_dry_run(struct json *j, const struct dry_run *t,
                      const struct surface_face *face, const struct describe_times *times)
{
    const bool usable = t->verification == ST_OK, read = t->found.points_read > 0;

    json_flag(j, "usable", usable);
    json_flag(j, "enrollable", t->enrolment == ST_OK);
    json_text(j, "code", status_refusal(t->why.code));
    json_text_or_null(j, "detail", t->why.msg);
    json_array(j, "advice");
    for (size_t i = 0; i < t->advice.n; i++)
        json_text(j, NULL, t->advice.line[i]);
    json_close(j);
    json_array(j, "notes");
    for (size_t i = 0; i < t->advice.nnote; i++)
        json_text(j, NULL, t->advice.note[i]);
    json_close(j);
    if (read)
        describe_scan(j, "scan", &t->found);
    else
        json_text(j, "scan", NULL);
    if (read && t->found.scan.quality.density_mm > 0)
        describe_quality(j, "quality", &t->found.scan.quality, usable ? face : NULL);
    else
        json_text(j, "quality", NULL);
    json_object(j, "timing_ms");
    json_number(j, "parse", times->parse);
    json_number(j, "prepare", times->prepare);
    json_number(j, "total", times->total);
    json_close(j);
}
