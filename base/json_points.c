#include "json_points.h"

#include <math.h>

#include "mem.h"
#include "number.h"

#define FIRST_ROOM 64

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

bool json_points_number(const char *p)
{
    const char *const first = p + (*p == '-');

    for (p = first; is_digit(*p); p++)
        ;
    return p > first && (*first != '0' || p == first + 1) &&
           (*p != '.' || is_digit(p[1]));
}

static const char *skip_blank(const char *p)
{
    while (*p == ' ' || *p == '\n' || *p == '\r' || *p == '\t')
        p++;
    return p;
}

/* Returns the byte after the point's bracket; NULL: none begins at p. */
static const char *take_point(const char *p, const char *end, struct dvec3 *out)
{
    double xyz[3];

    if (*p++ != '[')
        return NULL;
    for (int i = 0; i < 3; i++) {
        p = skip_blank(p);
        if (!json_points_number(p) || (p = number_read(p, end, &xyz[i])) == NULL ||
            !isfinite(xyz[i]))
            return NULL;
        p = skip_blank(p);
        if (*p++ != (i < 2 ? ',' : ']'))
            return NULL;
    }
    *out = (struct dvec3){xyz[0], xyz[1], xyz[2]};
    return p;
}

/* Adds one; there is room for *room. */
static bool add(struct json_points *points, size_t *room, struct dvec3 point)
{
    if (points->n == *room) {
        const size_t n = *room == 0 ? FIRST_ROOM : 2 * *room;
        struct dvec3 *at = mem_grow(points->at, points->n * sizeof *at, n * sizeof *at);

        if (at == NULL)
            return false;
        points->at = at;
        *room = n;
    }
    points->at[points->n++] = point;
    return true;
}

/* points is empty again; returns st. */
static enum status drop(struct json_points *points, enum status st)
{
    mem_free(points->at);
    *points = (struct json_points){0};
    return st;
}

enum status json_points_read(const char *p, const char *end, size_t max,
                             struct json_points *out, const char **rest)
{
    size_t room = 0;
    struct dvec3 point;
    const char *q;

    *out = (struct json_points){0};
    *rest = p;
    for (bool more = true; more;) {
        p = skip_blank(p);
        if ((q = take_point(p, end, &point)) == NULL)
            break;
        if (out->n == max)
            return drop(out, ST_ELIMIT);
        if (!add(out, &room, point))
            return drop(out, ST_ENOMEM);
        *rest = p;
        p = skip_blank(q);
        if (*p == ']') {
            *rest = p;
            return ST_OK;
        }
        more = *p++ == ',';
    }
    if (out->n <= 1) /* the parser's, or there was none */
        return drop(out, ST_OK);
    out->n--;
    return ST_OK;
}
