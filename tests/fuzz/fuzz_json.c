/* Clouds as JSON.  The first byte selects whether one cloud is read or two.  Points that are
 * read in one pass are the same as those of a document with a value for each number. */
#include "fuzz.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "cloudfile.h"
#include "errinfo.h"
#include "json.h"
#include "parse.h"
#include "mem.h"

#define LIMIT 2000

static void check(struct cloudpoints *c, enum status st)
{
    if (st != ST_OK) {
        if (c->at != NULL || c->n != 0)
            abort();
        return;
    }
    if (c->n > LIMIT || !(c->unit_mm >= 0))
        abort();
    for (size_t i = 0; i < c->n; i++)
        if (!isfinite(c->at[i].x) || !isfinite(c->at[i].y) || !isfinite(c->at[i].z))
            abort();
    cloudpoints_free(c);
}

/* Both have the same points; below the members of an object too. */
static void same(const struct json_value *a, const struct json_value *b)
{
    const size_t n = json_count(a);
    struct dvec3 *pa = mem_array(n, sizeof *pa), *pb = mem_array(n, sizeof *pb);
    size_t na, nb;

    if (pa == NULL || pb == NULL || json_count(b) != n ||
        json_is_array(a) != json_is_array(b) ||
        json_get_points(a, pa, &na) != json_get_points(b, pb, &nb) || na != nb ||
        memcmp(pa, pb, na * sizeof *pa) != 0)
        abort();
    mem_free(pa);
    mem_free(pb);
    if (!json_is_array(a))
        for (a = json_first(a), b = json_first(b); a != NULL;
             a = json_next(a), b = json_next(b))
            same(a, b);
}

/* The library refuses a number of 64 characters. */
static bool long_number(const char *text, size_t len)
{
    size_t run = 0;

    for (size_t i = 0; i < len && run < 64; i++)
        run = strchr("0123456789+-.eE", text[i]) != NULL ? run + 1 : 0;
    return run >= 64;
}

static void differ(const char *text, size_t len)
{
    struct json_value *values, *points;
    struct errinfo ev = {ST_OK, ""}, ep = {ST_OK, ""};
    const enum status sv = json_read(text, len, 4 * LIMIT, &values, &ev);
    const enum status sp = json_read_points(text, len, 4 * LIMIT, &points, &ep);

    if (sv == ST_OK && sp == ST_OK)
        same(values, points);
    else if (sp != ST_ELIMIT && (sv == ST_OK || !long_number(text, len)) &&
             (sv != sp || strcmp(ev.msg, ep.msg) != 0))
        abort();
    json_free(values);
    json_free(points);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct cloudpoints a = {0}, b = {0};
    const struct cloudfile_options o = {
        .format = CLOUDFORMAT_JSON, .max_points = LIMIT, .max_bytes = 1 << 20};
    struct errinfo e = {ST_OK, ""};
    enum status st;
    char *text;

    if (size == 0)
        return 0;
    if ((text = malloc(size)) == NULL)
        abort();
    memcpy(text, data + 1, size - 1);
    text[size - 1] = 0;
    if (data[0] % 2 == 0) {
        st = cloudfile_read(text, size - 1, &o, &a, &e);
        check(&a, st);
    } else {
        st = parse_clouds(text, size - 1, &o, &a, &b, &e);
        check(&a, st);
        check(&b, st);
    }
    if (st != ST_OK && e.msg[0] == 0)
        abort();
    differ(text, size - 1);
    free(text);
    return 0;
}
