#include "json.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <cjson/cJSON.h>

#include "errinfo.h"
#include "mem.h"
#include "store.h"

/* An object with more members is refused, so that looking for keys given twice stays cheap. */
#define MAX_MEMBERS 32

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

/* Nothing else may be in it than these two: a member that is misspelt must not be ignored. */
static enum status check_known(const cJSON *object, const char *name, const char *one,
                               const char *other, struct errinfo *e)
{
    enum status st = check_members(object, name, e);

    for (const cJSON *a = st == ST_OK ? object->child : NULL; a != NULL && st == ST_OK;
         a = a->next)
        if (strcmp(a->string, one) != 0 && strcmp(a->string, other) != 0)
            st = errinfo_set(e, ST_EINVAL, "%s has %s and %s, not %.64s", name, one,
                             other, a->string);
    return st;
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
    enum status st = check_known(object, name, "points", "units", e);
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
        st = check_known(doc, "the body", "a", "b", e);
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
