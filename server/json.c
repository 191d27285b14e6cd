#include "json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cjson/cJSON.h>

#include "asymmetry.h"
#include "errinfo.h"
#include "errmap.h"
#include "face.h"
#include "frame.h"
#include "mem.h"
#include "quality.h"
#include "store.h"

/* An object with more members is refused, so that looking for keys given twice stays cheap. */
#define MAX_MEMBERS 32

/* ---- reading */

/* Offset of the first byte that is not UTF-8 (no surrogates, no overlong forms), or len. */
static size_t utf8_end(const unsigned char *s, size_t len)
{
    size_t i = 0;

    while (i < len) {
        unsigned c = s[i], lo = 0x80, hi = 0xbf;
        size_t more;

        if (c < 0x80) {
            i++;
            continue;
        }
        if (c >= 0xc2 && c <= 0xdf)
            more = 1;
        else if ((c & 0xf0) == 0xe0)
            more = 2;
        else if (c >= 0xf0 && c <= 0xf4)
            more = 3;
        else
            return i;
        if (c == 0xe0)
            lo = 0xa0;
        else if (c == 0xed)
            hi = 0x9f;
        else if (c == 0xf0)
            lo = 0x90;
        else if (c == 0xf4)
            hi = 0x8f;
        if (len - i <= more || s[i + 1] < lo || s[i + 1] > hi)
            return i;
        for (size_t k = 2; k <= more; k++)
            if ((s[i + k] & 0xc0) != 0x80)
                return i;
        i += more + 1;
    }
    return len;
}

/* Is there a "\u0000"?  The parser would make it the end of its text. */
static bool has_nul(const char *text, size_t len)
{
    const char *end = text + len, *at = text;

    while ((at = memchr(at, '\\', (size_t)(end - at))) != NULL && end - at > 1) {
        if (end - at >= 6 && memcmp(at + 1, "u0000", 5) == 0)
            return true;
        at += 2; /* what follows is escaped, be it a backslash */
    }
    return false;
}

/* The document as a tree.  max_values bounds the tree before it is built: each value but
 * the first follows a comma or a bracket of its own. */
static enum status read_document(const char *text, size_t len, size_t max_values,
                                 cJSON **out, struct errinfo *e)
{
    size_t commas = 0, where;
    const char *end = NULL;

    *out = NULL;
    if (len == 0)
        return errinfo_set(e, ST_EINVAL, "the body is empty");
    where = utf8_end((const unsigned char *)text, len);
    if (where < len)
        return errinfo_set(e, ST_EINVAL, "not UTF-8 at byte %zu", where);
    if (has_nul(text, len))
        return errinfo_set(e, ST_EINVAL, "\\u0000 cannot be in a text");
    for (size_t i = 0; i < len; i++)
        commas += text[i] == ',';
    if (commas > max_values)
        return errinfo_set(e, ST_ELIMIT, "more values than the limit of points can have");
    if (memchr(text, 0, len) == NULL) /* the parser would take it for the end */
        *out = cJSON_ParseWithLengthOpts(text, len + 1, &end, true);
    else
        end = memchr(text, 0, len);
    if (*out != NULL)
        return ST_OK;
    where = end == NULL ? 0 : (size_t)(end - text);
    return errinfo_set(e, ST_EINVAL,
                       where >= len ? "not valid JSON: it ends too early"
                                    : "not valid JSON at byte %zu",
                       where);
}

static enum status check_members(const cJSON *object, const char *name, struct errinfo *e)
{
    const cJSON *a, *b;
    unsigned n = 0;

    if (!cJSON_IsObject(object))
        return errinfo_set(e, ST_EINVAL, "%s is not an object", name);
    for (a = object->child; a != NULL; a = a->next) {
        if (++n > MAX_MEMBERS)
            return errinfo_set(e, ST_EINVAL, "%s has more than %d members", name,
                               MAX_MEMBERS);
        for (b = object->child; b != a; b = b->next)
            if (strcmp(a->string, b->string) == 0)
                return errinfo_set(e, ST_EINVAL,
                                   "member %u of %s has the name of an "
                                   "earlier one",
                                   n, name);
    }
    return ST_OK;
}

static enum status read_point(const cJSON *item, struct dvec3 *out)
{
    const cJSON *x, *y, *z;

    if (!cJSON_IsArray(item) || (x = item->child) == NULL || (y = x->next) == NULL ||
        (z = y->next) == NULL || z->next != NULL || !cJSON_IsNumber(x) ||
        !cJSON_IsNumber(y) || !cJSON_IsNumber(z))
        return ST_EINVAL;
    out->x = x->valuedouble;
    out->y = y->valuedouble;
    out->z = z->valuedouble;
    return isfinite(out->x) && isfinite(out->y) && isfinite(out->z) ? ST_OK
                                                                    : ST_ENOTFINITE;
}

bool json_units(const char *name, double *mm)
{
    if (strcmp(name, "mm") == 0)
        *mm = 1.0;
    else if (strcmp(name, "cm") == 0)
        *mm = 10.0;
    else if (strcmp(name, "m") == 0)
        *mm = 1000.0;
    else
        return false;
    return true;
}

/* One cloud; prefix is "" or "a." for messages, name that of the object. */
static enum status read_cloud(const cJSON *object, const char *name, const char *prefix,
                              size_t max_points, struct json_cloud *out,
                              struct errinfo *e)
{
    const cJSON *points, *units, *item;
    enum status st = check_members(object, name, e);
    size_t n = 0;

    *out = (struct json_cloud){.mm = 1.0};
    if (st != ST_OK)
        return st;
    points = cJSON_GetObjectItemCaseSensitive(object, "points");
    units = cJSON_GetObjectItemCaseSensitive(object, "units");
    if (units != NULL) {
        if (!cJSON_IsString(units) || !json_units(units->valuestring, &out->mm))
            return errinfo_set(e, ST_EINVAL, "%sunits is not \"mm\", \"cm\" or \"m\"",
                               prefix);
        out->has_units = true;
    }
    if (points == NULL)
        return errinfo_set(e, ST_EINVAL, "%spoints is missing", prefix);
    if (!cJSON_IsArray(points))
        return errinfo_set(e, ST_EINVAL, "%spoints is not an array", prefix);
    cJSON_ArrayForEach(item, points) n++;
    if (n > max_points)
        return errinfo_set(e, ST_ELIMIT, "%spoints has %zu points; the limit is %zu",
                           prefix, n, max_points);
    out->pts = mem_array(n, sizeof *out->pts);
    if (out->pts == NULL)
        return errinfo_set(e, ST_ENOMEM, "no memory for %zu points", n);
    cJSON_ArrayForEach(item, points)
    {
        st = read_point(item, &out->pts[out->n]);
        if (st != ST_OK) {
            (void)errinfo_set(e, st, "%spoints[%zu] is not three finite numbers", prefix,
                              out->n);
            mem_free(out->pts);
            *out = (struct json_cloud){.mm = 1.0};
            return st;
        }
        out->n++;
    }
    return ST_OK;
}

/* Commas that n clouds of max_points need, and a few for other members. */
static size_t enough_values(size_t max_points, size_t clouds)
{
    return clouds * (3 * max_points + 64);
}

enum status json_cloud_read(const char *text, size_t len, size_t max_points,
                            struct json_cloud *out, struct errinfo *e)
{
    cJSON *doc;
    enum status st = read_document(text, len, enough_values(max_points, 1), &doc, e);

    *out = (struct json_cloud){.mm = 1.0};
    if (st == ST_OK)
        st = read_cloud(doc, "the body", "", max_points, out, e);
    cJSON_Delete(doc);
    return st;
}

enum status json_clouds_read(const char *text, size_t len, size_t max_points,
                             struct json_cloud *a, struct json_cloud *b,
                             struct errinfo *e)
{
    cJSON *doc;
    enum status st = read_document(text, len, enough_values(max_points, 2), &doc, e);

    *a = *b = (struct json_cloud){.mm = 1.0};
    if (st == ST_OK)
        st = check_members(doc, "the body", e);
    if (st == ST_OK)
        st = read_cloud(cJSON_GetObjectItemCaseSensitive(doc, "a"), "a", "a.", max_points,
                        a, e);
    if (st == ST_OK)
        st = read_cloud(cJSON_GetObjectItemCaseSensitive(doc, "b"), "b", "b.", max_points,
                        b, e);
    if (st != ST_OK) {
        mem_free(a->pts);
        *a = (struct json_cloud){.mm = 1.0};
    }
    cJSON_Delete(doc);
    return st;
}

static enum status take_text(const cJSON *item, char out[JSON_TEXT_MAX],
                             const char **what, struct errinfo *e)
{
    if (!cJSON_IsNull(item) && !cJSON_IsString(item))
        return errinfo_set(e, ST_EINVAL, "%s is neither a text nor null", item->string);
    if (cJSON_IsString(item)) {
        if (strlen(item->valuestring) >= JSON_TEXT_MAX)
            return errinfo_set(e, ST_EINVAL, "%s is too long", item->string);
        memcpy(out, item->valuestring, strlen(item->valuestring) + 1);
    }
    *what = out;
    return ST_OK;
}

static enum status take_flag(const cJSON *item, bool *out, const bool **what,
                             struct errinfo *e)
{
    if (!cJSON_IsBool(item))
        return errinfo_set(e, ST_EINVAL, "%s is neither true nor false", item->string);
    *out = cJSON_IsTrue(item);
    *what = out;
    return ST_OK;
}

static enum status read_change(const cJSON *doc, struct json_change *out,
                               struct errinfo *e)
{
    struct store_subject_change *what = &out->what;
    enum status st = check_members(doc, "the body", e);
    const cJSON *item;

    if (st != ST_OK)
        return st;
    for (item = doc->child; item != NULL && st == ST_OK; item = item->next) {
        if (strcmp(item->string, "consent") == 0)
            st = take_text(item, out->consent, &what->reference, e);
        else if (strcmp(item->string, "purpose") == 0)
            st = take_text(item, out->purpose, &what->purpose, e);
        else if (strcmp(item->string, "expires_at") == 0)
            st = take_text(item, out->expires, &what->expires, e);
        else if (strcmp(item->string, "hold") == 0)
            st = take_flag(item, &out->hold, &what->hold, e);
        else if (strcmp(item->string, "disabled") == 0)
            st = take_flag(item, &out->disabled, &what->disabled, e);
        else
            st = errinfo_set(e, ST_EINVAL,
                             "what can be changed is consent, purpose, expires_at, hold "
                             "and disabled, not %.64s",
                             item->string);
    }
    return st;
}

enum status json_change_read(const char *text, size_t len, struct json_change *out,
                             struct errinfo *e)
{
    cJSON *doc;
    enum status st = read_document(text, len, MAX_MEMBERS, &doc, e);

    memset(out, 0, sizeof *out);
    if (st == ST_ELIMIT) /* of values: here no limit of points */
        st = errinfo_set(e, ST_EINVAL, "the body has more than %d members", MAX_MEMBERS);
    if (st == ST_OK)
        st = read_change(doc, out, e);
    cJSON_Delete(doc);
    return st;
}

_Static_assert(STORE_NOTE_MAX == STORE_SUBJECT_MAX, "one limit for either");

static enum status read_newcomer(const cJSON *doc, struct store_subject *out,
                                 struct errinfo *e)
{
    enum status st = check_members(doc, "the body", e);
    char text[JSON_TEXT_MAX];
    const char *given;
    const cJSON *item;

    for (item = st == ST_OK ? doc->child : NULL; item != NULL && st == ST_OK;
         item = item->next) {
        char *to = strcmp(item->string, "subject") == 0      ? out->id
                   : strcmp(item->string, "consent") == 0    ? out->reference
                   : strcmp(item->string, "purpose") == 0    ? out->purpose
                   : strcmp(item->string, "expires_at") == 0 ? out->expires
                                                             : NULL;
        const size_t most = to == out->expires ? sizeof out->expires - 1 : STORE_NOTE_MAX;

        text[0] = '\0';
        if (to == NULL)
            st = errinfo_set(e, ST_EINVAL,
                             "a new subject has subject, consent, purpose and "
                             "expires_at, not %.64s",
                             item->string);
        else if ((st = take_text(item, text, &given, e)) == ST_OK && strlen(text) > most)
            st = errinfo_set(e, ST_EINVAL, "%s is longer than %zu bytes", item->string,
                             most);
        else if (st == ST_OK)
            memcpy(to, text, strlen(text) + 1);
    }
    return st;
}

enum status json_newcomer_read(const char *text, size_t len, struct store_subject *out,
                               struct errinfo *e)
{
    cJSON *doc;
    enum status st = read_document(text, len, MAX_MEMBERS, &doc, e);

    memset(out, 0, sizeof *out);
    if (st == ST_ELIMIT)
        st = errinfo_set(e, ST_EINVAL, "the body has more than %d members", MAX_MEMBERS);
    if (st == ST_OK)
        st = read_newcomer(doc, out, e);
    cJSON_Delete(doc);
    return st;
}

/* ---- writing */

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

static bool add_quality(cJSON *o, const struct face_quality *q, const struct frame *frame)
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

    return add_number(x, "starts", a->starts) &&
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

    return print(
        o, add_string(o, "decision", decision[r->decision]) &&
               add_number(o, "disparity_mm", r->disparity_mm) &&
               add_number(o, "threshold_mm", r->threshold_mm) &&
               add_number(o, "fmr_at_score", r->fmr_at_score) &&
               add_number(o, "plain_mm", r->measure.plain_mm) &&
               add_number(o, "volume_mm3", r->measure.volume_mm3) &&
               add_number(o, "overlap_mm2", r->measure.area_mm2) &&
               add_number(o, "overlap", r->measure.overlap) &&
               add_number(o, "bridged_mm2", r->measure.bridged_mm2) &&
               add_transform(o, r->align.transform) && add_alignment(o, &r->align) &&
               add_number(o, "weight_overlap", r->weight_overlap) &&
               add_number(o, "change_mm", r->change_mm) && add_regions(o, r->region_mm) &&
               add_string(o, "subject", v->subject) &&
               add_string(o, "template_id", v->template_id) &&
               add_number(o, "templates_compared", v->templates_compared) &&
               add_quality(o, &v->probe->quality, &v->probe->frame) &&
               add_string(o, "engine", v->engine) &&
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
                add_number(o, "disparity_mm", a->measure.plain_mm) &&
                add_number(o, "first_mm", a->first.plain_mm) &&
                add_number(o, "volume_mm3", a->measure.volume_mm3) &&
                add_number(o, "overlap_mm2", a->measure.area_mm2) &&
                add_number(o, "overlap", a->measure.overlap) && add_plane(o, a) &&
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
                          add_number(o, "disparity_mm", mismatch->disparity_mm) &&
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
