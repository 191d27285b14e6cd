#include "parse.h"

#include <string.h>

#include "cloudfile.h"
#include "errinfo.h"
#include "json.h"
#include "request.h"
#include "utc.h"

/* ---- clouds */

enum status parse_clouds(const char *text, size_t len, const struct cloudfile_options *o,
                         struct cloudpoints *a, struct cloudpoints *b, struct errinfo *e)
{
    static const char *const known[] = {"a", "b", NULL};
    struct json_value *doc;
    enum status st = cloudfile_read_document(text, len, o->max_points, 2, &doc, e);

    *a = *b = (struct cloudpoints){0};
    if (st == ST_OK)
        st = json_expect(doc, "the body", known, e);
    if (st == ST_OK)
        st = cloudfile_read_json(json_member(doc, "a"), "a", "a.", o, a, e);
    if (st == ST_OK)
        st = cloudfile_read_json(json_member(doc, "b"), "b", "b.", o, b, e);
    if (st != ST_OK)
        cloudpoints_free(a);
    json_free(doc);
    return st;
}

/* ---- subjects */

/* The body as an object of these members. */
static enum status read_object(const char *text, size_t len, const char *const known[],
                               struct json_value **out, struct errinfo *e)
{
    enum status st = json_read(text, len, 2 * JSON_MEMBERS, out, e);

    if (st == ST_ELIMIT) /* of values: not the limit of points that this code tells */
        return errinfo_set(e, ST_EINVAL, "the body has more than %d values",
                           2 * JSON_MEMBERS);
    return st == ST_OK ? json_expect(*out, "the body", known, e) : st;
}

/* The text of a member, of up to size - 1 bytes, "" for null; NULL: there is no such
 * member, or *st says what is wrong. */
static const char *take_text(const struct json_value *object, const char *key, char *out,
                             size_t size, enum status *st, struct errinfo *e)
{
    const struct json_value *v = json_member(object, key);

    if (*st != ST_OK || v == NULL)
        return NULL;
    out[0] = '\0';
    if (json_is_null(v) || json_copy_text(v, out, size))
        return out;
    *st = json_get_text(v) == NULL
              ? errinfo_set(e, ST_EINVAL, "%s must be a string or null", key)
              : errinfo_set(e, ST_EINVAL, "%s is longer than %zu bytes", key, size - 1);
    return NULL;
}

static const bool *take_flag(const struct json_value *object, const char *key, bool *out,
                             enum status *st, struct errinfo *e)
{
    const struct json_value *v = json_member(object, key);

    if (*st != ST_OK || v == NULL)
        return NULL;
    if (json_get_flag(v, out))
        return out;
    *st = errinfo_set(e, ST_EINVAL, "%s must be true or false", key);
    return NULL;
}

/* A flag that is true unless it is given. */
static const bool *take_identify(const struct json_value *object, bool *out,
                                 enum status *st, struct errinfo *e)
{
    *out = true;
    return *st == ST_OK && json_is_null(json_member(object, "identify"))
               ? out
               : take_flag(object, "identify", out, st, e);
}

/* The list of an array of labels, "" for null; NULL: there is no such member, or *st says what is wrong. */
static const char *take_groups(const struct json_value *object, char out[GROUPS_SIZE],
                               enum status *st, struct errinfo *e)
{
    const struct json_value *v = json_member(object, "groups");

    out[0] = '\0';
    if (*st != ST_OK || v == NULL)
        return NULL;
    if (!json_is_null(v) && !json_is_array(v))
        *st = errinfo_set(e, ST_EINVAL, "groups is not an array");
    for (v = json_first(v); *st == ST_OK && v != NULL; v = json_next(v)) {
        const char *label = json_get_text(v);

        *st = label != NULL ? groups_add(out, label, e)
                            : errinfo_set(e, ST_EINVAL, "groups has what is no text");
    }
    return *st == ST_OK ? out : NULL;
}

enum status parse_change(const char *text, size_t len, struct parse_change *out,
                         struct errinfo *e)
{
    static const char *const known[] = {"consent",  "purpose", "expires_at", "hold",
                                        "disabled", "groups",  "identify",   NULL};
    struct store_subject_change *what = &out->what;
    struct json_value *doc;
    enum status st = read_object(text, len, known, &doc, e);

    memset(out, 0, sizeof *out);
    what->reference = take_text(doc, "consent", out->consent, PARSE_TEXT_MAX, &st, e);
    what->purpose = take_text(doc, "purpose", out->purpose, PARSE_TEXT_MAX, &st, e);
    what->expires = take_text(doc, "expires_at", out->expires, PARSE_TEXT_MAX, &st, e);
    what->hold = take_flag(doc, "hold", &out->hold, &st, e);
    what->disabled = take_flag(doc, "disabled", &out->disabled, &st, e);
    what->groups = take_groups(doc, out->groups, &st, e);
    what->identify = take_identify(doc, &out->identify, &st, e);
    json_free(doc);
    return st;
}

enum status parse_newcomer(const char *text, size_t len, struct store_subject *out,
                           struct errinfo *e)
{
    static const char *const known[] = {"subject", "consent",  "purpose", "expires_at",
                                        "groups",  "identify", NULL};
    struct json_value *doc;
    enum status st = read_object(text, len, known, &doc, e);

    memset(out, 0, sizeof *out);
    (void)take_text(doc, "subject", out->id, sizeof out->id, &st, e);
    if (st == ST_OK && !ident_subject_valid(out->id))
        st = errinfo_set(e, ST_EINVAL, "%s", REQUEST_SUBJECT_ID);
    (void)take_text(doc, "consent", out->reference, sizeof out->reference, &st, e);
    (void)take_text(doc, "purpose", out->purpose, sizeof out->purpose, &st, e);
    (void)take_text(doc, "expires_at", out->expires, sizeof out->expires, &st, e);
    (void)take_groups(doc, out->groups, &st, e);
    (void)take_identify(doc, &out->identify, &st, e);
    json_free(doc);
    return st;
}

/* ---- tokens */

static enum status take_scopes(const struct json_value *list, unsigned *out,
                               struct errinfo *e)
{
    *out = 0;
    if (!json_is_array(list))
        return errinfo_set(e, ST_EINVAL, "scopes is not an array");
    for (const struct json_value *v = json_first(list); v != NULL; v = json_next(v)) {
        const char *word = json_get_text(v);
        unsigned one;

        if (word == NULL || strchr(word, ',') != NULL || !rows_scopes_read(word, &one))
            return errinfo_set(e, ST_EINVAL, "scopes has %.40s, which is none",
                               word != NULL ? word : "what is no text");
        *out |= one;
    }
    return *out != 0 ? ST_OK : errinfo_set(e, ST_EINVAL, "scopes is empty");
}

static enum status take_end(const char *end, int64_t *ms, struct errinfo *e)
{
    int64_t now;

    (void)utc_now(&now);
    *ms = end == NULL ? now + STORE_TOKEN_LIFE_S * 1000 : STORE_NEVER;
    if (end == NULL || end[0] == '\0')
        return ST_OK;
    if (!utc_read_end(end, ms))
        return errinfo_set(e, ST_EINVAL,
                           "expires_at must be a time such as 2027-01-31T14:30:00Z, or a "
                           "day, 2027-01-31, at whose end (UTC) it ends");
    return *ms > now ? ST_OK
                     : errinfo_set(e, ST_EINVAL, "expires_at %.40s is in the past", end);
}

enum status parse_token(const char *text, size_t len, struct parse_token *out,
                        struct errinfo *e)
{
    static const char *const known[] = {"name", "scopes", "groups", "expires_at", NULL};
    char end[PARSE_TEXT_MAX];
    struct json_value *doc;
    enum status st = read_object(text, len, known, &doc, e);
    const char *name, *until;

    memset(out, 0, sizeof *out);
    name = take_text(doc, "name", out->name, sizeof out->name, &st, e);
    until = take_text(doc, "expires_at", end, sizeof end, &st, e);
    if (st == ST_OK && name == NULL)
        st = errinfo_set(e, ST_EINVAL, "name is missing");
    if (st == ST_OK)
        st = take_scopes(json_member(doc, "scopes"), &out->scopes, e);
    (void)take_groups(doc, out->groups, &st, e);
    if (st == ST_OK)
        st = take_end(until, &out->end_ms, e);
    json_free(doc);
    return st;
}

enum status parse_rotation(const char *text, size_t len, int64_t *grace_s,
                           struct errinfo *e)
{
    static const char *const known[] = {"grace_s", NULL};
    const struct json_value *v;
    struct json_value *doc;
    uint64_t s = 0;
    enum status st = read_object(text, len, known, &doc, e);

    if (st == ST_OK && (v = json_member(doc, "grace_s")) != NULL &&
        !json_get_count(v, &s))
        st = errinfo_set(e, ST_EINVAL, "grace_s is not a number of seconds");
    *grace_s = (int64_t)s;
    json_free(doc);
    return st;
}
