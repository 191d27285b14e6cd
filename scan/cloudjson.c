#include "cloudjson.h"

#include <string.h>

#include "cloudlist.h"
#include "cloudunit.h"
#include "errinfo.h"
#include "json.h"
#include "mem.h"

static enum status take_units(const struct json_value *units, const char *prefix,
                              struct cloudlist *list)
{
    const char *name = json_get_text(units);

    if (units == NULL)
        return ST_OK;
    if (name == NULL || !cloudunit_or_auto(name, &list->out.unit_mm))
        return errinfo_set(list->e, ST_EINVAL, "%sunits is not auto, " CLOUDUNIT_NAMES,
                           prefix);
    return ST_OK;
}

static enum status take_axes(const struct json_value *axes, const char *prefix,
                             struct cloudlist *list)
{
    const char *name = json_get_text(axes);

    if (axes == NULL)
        return ST_OK;
    list->out.as_scanned = name != NULL && strcmp(name, "scanner") == 0;
    if (name == NULL || (!list->out.as_scanned && strcmp(name, "auto") != 0))
        return errinfo_set(list->e, ST_EINVAL, "%saxes is neither auto nor scanner",
                           prefix);
    return ST_OK;
}

static enum status take_points(const struct json_value *points, const char *prefix,
                               struct cloudlist *list)
{
    const size_t n = json_count(points);
    struct dvec3 *at;
    size_t got;
    enum status st;

    if (n > list->max)
        return errinfo_set(list->e, ST_ELIMIT,
                           "%spoints has %zu points; the limit is %zu", prefix, n,
                           list->max);
    if ((at = mem_array(n, sizeof *at)) == NULL)
        return errinfo_set(list->e, ST_ENOMEM, "no memory for %zu points", n);
    if ((st = json_get_points(points, at, &got)) != ST_OK)
        (void)errinfo_set(list->e, st, "%spoints[%zu] is not three finite numbers",
                          prefix, got);
    else
        st = cloudlist_room(list, n);
    for (size_t i = 0; i < n && st == ST_OK; i++)
        st = cloudlist_add(list, at[i]);
    mem_free(at);
    return st;
}

enum status cloudjson_take(const struct json_value *object, const char *name,
                           const char *prefix, struct cloudlist *list)
{
    static const char *const known[] = {"points", "units", "axes", NULL};
    const struct json_value *points = json_member(object, "points");
    enum status st = json_expect(object, name, known, list->e);

    if (st == ST_OK)
        st = take_units(json_member(object, "units"), prefix, list);
    if (st == ST_OK)
        st = take_axes(json_member(object, "axes"), prefix, list);
    if (st != ST_OK)
        return st;
    if (points == NULL)
        return errinfo_set(list->e, ST_EINVAL, "%spoints is missing", prefix);
    if (!json_is_array(points))
        return errinfo_set(list->e, ST_EINVAL, "%spoints is not an array", prefix);
    return take_points(points, prefix, list);
}

enum status cloudjson_document(const char *text, size_t len, size_t max_points,
                               size_t clouds, struct json_value **out, struct errinfo *e)
{
    /* Four values a point, and a few for other members. */
    const enum status st =
        json_read_points(text, len, clouds * (4 * max_points + 64), out, e);

    return st == ST_ELIMIT
               ? errinfo_set(e, ST_ELIMIT, "more values than %zu points can have",
                             clouds * max_points)
               : st;
}
