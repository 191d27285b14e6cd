#include "parse.h"

#include <string.h>

#include "errinfo.h"
#include "json.h"
#include "mem.h"

/* ---- clouds */

bool parse_units(const char *name, double *mm)
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

static enum status take_units(const struct json_value *units, const char *prefix,
                              struct parse_cloud *out, struct errinfo *e)
{
    const char *name = json_get_text(units);

    if (units == NULL)
        return ST_OK;
    if (name == NULL || !parse_units(name, &out->mm))
        return errinfo_set(e, ST_EINVAL, "%sunits is not \"mm\", \"cm\" or \"m\"",
                           prefix);
    out->has_units = true;
    return ST_OK;
}

static enum status take_points(const struct json_value *points, const char *prefix,
                               size_t max_points, struct parse_cloud *out,
                               struct errinfo *e)
{
    const size_t n = json_count(points);
    enum status st;

    if (n > max_points)
        return errinfo_set(e, ST_ELIMIT, "%spoints has %zu points; the limit is %zu",
                           prefix, n, max_points);
    if ((out->pts = mem_array(n, sizeof *out->pts)) == NULL)
        return errinfo_set(e, ST_ENOMEM, "no memory for %zu points", n);
    if ((st = json_get_points(points, out->pts, &out->n)) != ST_OK)
        (void)errinfo_set(e, st, "%spoints[%zu] is not three finite numbers", prefix,
                          out->n);
    return st;
}

static void drop_cloud(struct parse_cloud *c)
{
    mem_free(c->pts);
    *c = (struct parse_cloud){.mm = 1.0};
}

/* One cloud; prefix is "" or "a." for messages, name that of the object. */
static enum status take_cloud(const struct json_value *object, const char *name,
                              const char *prefix, size_t max_points,
                              struct parse_cloud *out, struct errinfo *e)
{
    static const char *const known[] = {"points", "units", NULL};
    const struct json_value *points = json_member(object, "points");
    enum status st = json_expect(object, name, known, e);

    *out = (struct parse_cloud){.mm = 1.0};
    if (st == ST_OK &&
        (st = take_units(json_member(object, "units"), prefix, out, e)) == ST_OK) {
        if (points == NULL)
            st = errinfo_set(e, ST_EINVAL, "%spoints is missing", prefix);
        else if (!json_is_array(points))
            st = errinfo_set(e, ST_EINVAL, "%spoints is not an array", prefix);
        else
            st = take_points(points, prefix, max_points, out, e);
    }
    if (st != ST_OK)
        drop_cloud(out);
    return st;
}

/* The body as a document with room for so many clouds: four values a point, and a few for
 * other members. */
static enum status read_clouds(const char *text, size_t len, size_t max_points,
                               size_t clouds, struct json_value **out, struct errinfo *e)
{
    const enum status st =
        json_read_points(text, len, clouds * (4 * max_points + 64), out, e);

    return st == ST_ELIMIT
               ? errinfo_set(e, ST_ELIMIT, "more values than %zu points can have",
                             clouds * max_points)
               : st;
}

enum status parse_cloud(const char *text, size_t len, size_t max_points,
                        struct parse_cloud *out, struct errinfo *e)
{
    struct json_value *doc;
    enum status st = read_clouds(text, len, max_points, 1, &doc, e);

    *out = (struct parse_cloud){.mm = 1.0};
    if (st == ST_OK)
        st = take_cloud(doc, "the body", "", max_points, out, e);
    json_free(doc);
    return st;
}

enum status parse_clouds(const char *text, size_t len, size_t max_points,
                         struct parse_cloud *a, struct parse_cloud *b, struct errinfo *e)
{
    static const char *const known[] = {"a", "b", NULL};
    struct json_value *doc;
    enum status st = read_clouds(text, len, max_points, 2, &doc, e);

    *a = *b = (struct parse_cloud){.mm = 1.0};
    if (st == ST_OK)
        st = json_expect(doc, "the body", known, e);
    if (st == ST_OK)
        st = take_cloud(json_member(doc, "a"), "a", "a.", max_points, a, e);
    if (st == ST_OK)
        st = take_cloud(json_member(doc, "b"), "b", "b.", max_points, b, e);
    if (st != ST_OK)
        drop_cloud(a);
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
              ? errinfo_set(e, ST_EINVAL, "%s is neither a text nor null", key)
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
    *st = errinfo_set(e, ST_EINVAL, "%s is neither true nor false", key);
    return NULL;
}

enum status parse_change(const char *text, size_t len, struct parse_change *out,
                         struct errinfo *e)
{
    static const char *const known[] = {"consent", "purpose",  "expires_at",
                                        "hold",    "disabled", NULL};
    struct store_subject_change *what = &out->what;
    struct json_value *doc;
    enum status st = read_object(text, len, known, &doc, e);

    memset(out, 0, sizeof *out);
    what->reference = take_text(doc, "consent", out->consent, PARSE_TEXT_MAX, &st, e);
    what->purpose = take_text(doc, "purpose", out->purpose, PARSE_TEXT_MAX, &st, e);
    what->expires = take_text(doc, "expires_at", out->expires, PARSE_TEXT_MAX, &st, e);
    what->hold = take_flag(doc, "hold", &out->hold, &st, e);
    what->disabled = take_flag(doc, "disabled", &out->disabled, &st, e);
    json_free(doc);
    return st;
}

enum status parse_newcomer(const char *text, size_t len, struct store_subject *out,
                           struct errinfo *e)
{
    static const char *const known[] = {"subject", "consent", "purpose", "expires_at",
                                        NULL};
    struct json_value *doc;
    enum status st = read_object(text, len, known, &doc, e);

    memset(out, 0, sizeof *out);
    (void)take_text(doc, "subject", out->id, sizeof out->id, &st, e);
    (void)take_text(doc, "consent", out->reference, sizeof out->reference, &st, e);
    (void)take_text(doc, "purpose", out->purpose, sizeof out->purpose, &st, e);
    (void)take_text(doc, "expires_at", out->expires, sizeof out->expires, &st, e);
    json_free(doc);
    return st;
}
