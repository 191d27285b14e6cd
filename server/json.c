#include "json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cjson/cJSON.h>

#include "asymmetry.h"
#include "errmap.h"
#include "face.h"
#include "frame.h"
#include "mem.h"
#include "quality.h"
#include "store.h"

/* The text of object, which is deleted; NULL when anything was missing for it. */
static char *print(cJSON *object, bool complete)
{
    char *text = complete ? cJSON_PrintUnformatted(object) : NULL;

    cJSON_Delete(object);
    return text;
}

static bool add_string(cJSON *o, const char *name, const char *value)
{
    return (value == NULL ? cJSON_AddNullToObject(o, name)
                          : cJSON_AddStringToObject(o, name, value)) != NULL;
}

/* null for "" */
static bool add_text(cJSON *o, const char *name, const char *value)
{
    return add_string(o, name, value[0] != '\0' ? value : NULL);
}

static bool add_number(cJSON *o, const char *name, double value)
{
    return cJSON_AddNumberToObject(o, name, value) != NULL;
}

static bool add_item(cJSON *list, cJSON *item)
{
    if (item != NULL && cJSON_AddItemToArray(list, item))
        return true;
    cJSON_Delete(item);
    return false;
}

static bool add_flag(cJSON *o, const char *name, bool value)
{
    return cJSON_AddBoolToObject(o, name, value) != NULL;
}

/* null where there is none */
static bool add_finite(cJSON *o, const char *name, double value)
{
    return isfinite(value) ? add_number(o, name, value)
                           : cJSON_AddNullToObject(o, name) != NULL;
}

static bool add_reasons(cJSON *o, unsigned reasons)
{
    cJSON *x = cJSON_AddArrayToObject(o, "reasons");

    for (int i = 0; i < QUALITY_REASONS; i++) {
        cJSON *word;

        if (!(reasons & (1U << i)))
            continue;
        word = cJSON_CreateString(quality_reason_name((enum quality_reason)i));
        if (!cJSON_AddItemToArray(x, word)) {
            cJSON_Delete(word);
            return false;
        }
    }
    return x != NULL;
}

static bool add_quality(cJSON *o, const struct quality *q, const struct frame *frame)
{
    cJSON *x = cJSON_AddObjectToObject(o, "quality");

    return add_number(x, "score", q->score) && add_number(x, "coverage", q->coverage) &&
           add_number(x, "density_mm", q->density_mm) &&
           add_number(x, "noise_mm", q->noise_mm) &&
           add_reasons(x, quality_reasons(q, frame));
}

static bool add_transform(cJSON *o, const double transform[16])
{
    cJSON *x = cJSON_CreateDoubleArray(transform, 16);

    if (x != NULL && cJSON_AddItemToObject(o, "transform", x))
        return true;
    cJSON_Delete(x);
    return false;
}

static const char *const stop[] = {
    [ALIGN_CONVERGED] = "converged", [ALIGN_STEPS] = "steps", [ALIGN_APART] = "apart"};

static bool add_alignment(cJSON *o, const struct align_result *a)
{
    cJSON *x = cJSON_AddObjectToObject(o, "alignment");

    return add_transform(x, a->transform) && add_number(x, "starts", a->starts) &&
           add_number(x, "evaluations", a->evaluations) &&
           add_string(x, "stop", stop[a->stop]) &&
           add_finite(x, "turn_deg", a->turn_deg) &&
           add_finite(x, "shift_mm", a->shift_mm) &&
           add_finite(x, "cost_mm", a->cost_mm) && add_finite(x, "rival_mm", a->rival_mm);
}

static bool add_regions(cJSON *o, const double region_mm[GRID_REGIONS])
{
    cJSON *x = cJSON_AddObjectToObject(o, "regions");
    bool good = x != NULL;

    for (int i = 0; i < GRID_REGIONS && good; i++)
        good = add_finite(x, grid_region_name((enum grid_region)i), region_mm[i]);
    return good;
}

static bool add_plain(cJSON *o, const struct disparity *m)
{
    cJSON *x = cJSON_AddObjectToObject(o, "plain");

    return add_number(x, "volume_mm3", m->volume_mm3) &&
           add_number(x, "overlap_mm2", m->area_mm2) &&
           add_number(x, "bridged_mm2", m->bridged_mm2);
}

/* What tells more of the template than whether it is the same face. */
static bool add_measure(cJSON *o, const struct face_result *r)
{
    return add_plain(o, &r->disparity) && add_alignment(o, &r->align) &&
           add_number(o, "weight_overlap", r->weight_overlap) &&
           add_number(o, "change_mm", r->change_mm) && add_regions(o, r->region_mm);
}

static bool add_heatmap(cJSON *o, const double *gap_mm, size_t n)
{
    cJSON *x = cJSON_AddArrayToObject(o, "heatmap");

    for (size_t i = 0; i < n; i++) {
        cJSON *gap =
            isfinite(gap_mm[i]) ? cJSON_CreateNumber(gap_mm[i]) : cJSON_CreateNull();

        if (!cJSON_AddItemToArray(x, gap)) {
            cJSON_Delete(gap);
            return false;
        }
    }
    return x != NULL;
}

static bool add_timing(cJSON *o, const struct json_verdict *v)
{
    cJSON *x = cJSON_AddObjectToObject(o, "timing_ms");

    return add_number(x, "parse", v->parse_ms) &&
           add_number(x, "prepare", v->prepare_ms) &&
           add_number(x, "align", v->align_ms) &&
           add_number(x, "measure", v->measure_ms) && add_number(x, "total", v->total_ms);
}

static const char *const decision[] = {[FACE_MATCH] = "match",
                                       [FACE_NO_MATCH] = "no_match",
                                       [FACE_INCONCLUSIVE] = "inconclusive"};

char *json_verdict(const struct json_verdict *v)
{
    const struct face_result *r = v->result;
    cJSON *o = cJSON_CreateObject();

    return print(o, add_string(o, "decision", decision[r->decision]) &&
                        add_number(o, "disparity_mm", r->score_mm) &&
                        add_number(o, "threshold_mm", r->threshold_mm) &&
                        add_number(o, "fmr_at_score", r->fmr_at_score) &&
                        add_number(o, "plain_mm", r->disparity.plain_mm) &&
                        add_number(o, "overlap", r->disparity.overlap) &&
                        add_string(o, "subject", v->subject) &&
                        add_string(o, "template_id", v->template_id) &&
                        add_number(o, "templates_compared", v->templates_compared) &&
                        add_quality(o, &v->probe->quality, &v->probe->frame) &&
                        add_string(o, "engine", v->engine) &&
                        (!v->measure || add_measure(o, r)) &&
                        (v->gap_mm == NULL || add_heatmap(o, v->gap_mm, v->n)) &&
                        add_timing(o, v));
}

static bool add_plane(cJSON *o, const struct asymmetry *a)
{
    cJSON *x = cJSON_AddObjectToObject(o, "plane");
    cJSON *normal = cJSON_AddArrayToObject(x, "normal");
    bool good = normal != NULL;

    for (int i = 0; i < 3 && good; i++)
        good = cJSON_AddItemToArray(normal, cJSON_CreateNumber(a->normal[i]));
    return good && add_number(x, "offset_mm", a->offset_mm) &&
           add_number(x, "moved_deg", a->moved_deg) &&
           add_number(x, "moved_mm", a->moved_mm) &&
           add_number(x, "evaluations", a->evaluations) &&
           add_string(x, "stop", stop[a->stop]) &&
           add_finite(x, "turn_deg", a->turn_deg) &&
           add_finite(x, "shift_mm", a->shift_mm);
}

char *json_asymmetry(const struct json_asymmetry *v)
{
    const struct asymmetry *a = v->result;
    cJSON *o = cJSON_CreateObject(), *x;
    bool good = add_flag(o, "conclusive", asymmetry_conclusive(a)) &&
                add_number(o, "disparity_mm", a->final.plain_mm) &&
                add_number(o, "first_mm", a->initial.plain_mm) &&
                add_number(o, "volume_mm3", a->final.volume_mm3) &&
                add_number(o, "overlap_mm2", a->final.area_mm2) &&
                add_number(o, "overlap", a->final.overlap) && add_plane(o, a) &&
                add_quality(o, &v->face->quality, &v->face->frame) &&
                add_string(o, "engine", v->engine);

    x = cJSON_AddObjectToObject(o, "timing_ms");
    return print(o, good && add_number(x, "parse", v->parse_ms) &&
                        add_number(x, "prepare", v->prepare_ms) &&
                        add_number(x, "measure", v->measure_ms) &&
                        add_number(x, "total", v->total_ms));
}

char *json_problem(const struct errmap *m, const char *detail, const char *request_id,
                   const struct face_result *mismatch)
{
    cJSON *o = cJSON_CreateObject();
    char type[96];

    (void)snprintf(type, sizeof type, "urn:surfaced:problem:%s", m->code);
    return print(o, add_string(o, "type", type) && add_string(o, "title", m->title) &&
                        add_number(o, "status", m->http) &&
                        add_string(o, "detail", detail) &&
                        add_string(o, "code", m->code) &&
                        add_string(o, "request_id", request_id) &&
                        (mismatch == NULL ||
                         (add_string(o, "decision", decision[mismatch->decision]) &&
                          add_number(o, "disparity_mm", mismatch->score_mm) &&
                          add_number(o, "threshold_mm", mismatch->threshold_mm))));
}

static bool fill_template(cJSON *o, const struct store_template *t,
                          const struct frame *frame)
{
    return add_string(o, "template_id", t->id) && add_string(o, "subject", t->subject) &&
           add_string(o, "label", t->label) && add_string(o, "created", t->created) &&
           add_number(o, "points", t->points) &&
           add_number(o, "triangles", t->triangles) &&
           add_string(o, "digest", t->digest) && add_quality(o, &t->quality, frame) &&
           add_string(o, "engine", t->engine);
}

char *json_template(const struct store_template *t, const struct frame *frame)
{
    cJSON *o = cJSON_CreateObject();

    return print(o, fill_template(o, t, frame));
}

char *json_subject(const struct store_subject *s, const struct store_template *t,
                   size_t n)
{
    cJSON *o = cJSON_CreateObject(), *list;
    bool ok =
        add_string(o, "subject", s->id) && add_string(o, "created", s->created) &&
        add_text(o, "consent", s->reference) && add_text(o, "purpose", s->purpose) &&
        add_text(o, "expires_at", s->expires) && add_text(o, "last_seen", s->seen) &&
        add_flag(o, "hold", s->hold) && add_flag(o, "disabled", s->disabled);

    list = cJSON_AddArrayToObject(o, "templates");
    for (size_t i = 0; i < n && ok; i++) {
        cJSON *x = cJSON_CreateObject();

        ok = cJSON_AddItemToArray(list, x);
        if (ok)
            ok = fill_template(x, &t[i], NULL);
        else
            cJSON_Delete(x);
    }
    return print(o, ok && list != NULL);
}

char *json_subjects(const struct store_subject *s, size_t n, bool more)
{
    cJSON *o = cJSON_CreateObject();
    cJSON *list = cJSON_AddArrayToObject(o, "subjects");
    char cursor[24];
    bool ok = list != NULL;

    for (size_t i = 0; i < n && ok; i++) {
        cJSON *x = cJSON_CreateObject();

        ok = cJSON_AddItemToArray(list, x);
        if (ok)
            ok = add_string(x, "subject", s[i].id) &&
                 add_string(x, "created", s[i].created) &&
                 add_number(x, "templates", s[i].templates);
        else
            cJSON_Delete(x);
    }
    if (more && n > 0)
        (void)snprintf(cursor, sizeof cursor, "%lld", (long long)s[n - 1].key);
    return print(o, ok && add_string(o, "next_cursor", more && n > 0 ? cursor : NULL));
}

char *json_erased(const struct store_receipt *r)
{
    cJSON *o = cJSON_CreateObject(), *ids, *entry;
    bool ok = add_string(o, "subject", r->subject) &&
              add_number(o, "templates_removed", r->templates);

    ids = cJSON_AddArrayToObject(o, "template_ids");
    for (uint32_t i = 0; ok && i < r->templates; i++)
        ok = add_item(ids, cJSON_CreateString(r->template_id[i]));
    ok = ok && ids != NULL && add_string(o, "erased_at", r->at) &&
         add_string(o, "digest", r->digest);
    entry = cJSON_AddObjectToObject(o, "audit");
    return print(o, ok && add_number(entry, "seq", (double)r->seq) &&
                        add_string(entry, "hash", r->hash) &&
                        add_string(o, "signature", r->signature) &&
                        add_string(o, "public_key", r->public_key));
}

char *json_state(const char *state)
{
    cJSON *o = cJSON_CreateObject();

    return print(o, add_string(o, "status", state));
}

char *json_ready(const struct store_calibration *k)
{
    const struct decision *d = &k->decision;
    cJSON *o = cJSON_CreateObject(), *x;
    bool ok = add_string(o, "status", "ready");

    x = cJSON_AddObjectToObject(o, "calibration");
    return print(o, ok && add_number(x, "version", (double)k->version) &&
                        add_string(x, "source", k->shipped ? "shipped" : "database") &&
                        add_string(x, "ignored", k->ignored ? k->engine : NULL) &&
                        add_number(x, "threshold_mm", d->threshold_mm) &&
                        add_number(x, "fmr", decision_fmr(d, d->threshold_mm)));
}

char *json_version(const char *version, const char *engine, const char *compiler)
{
    cJSON *o = cJSON_CreateObject();

    return print(o, add_string(o, "version", version) &&
                        add_string(o, "engine", engine) &&
                        add_string(o, "compiler", compiler));
}
