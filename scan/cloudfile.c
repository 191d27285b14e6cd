#include "cloudfile.h"

#include <string.h>

#include "cloudobj.h"
#include "cloudply.h"
#include "cloudtext.h"
#include "cloudxyz.h"
#include "mem.h"

static void skip_bom(struct cloudtext *t)
{
    if (t->end - t->p >= 3 && memcmp(t->p, "\xEF\xBB\xBF", 3) == 0)
        t->p += 3;
}

/* By the first line that is not a comment. */
static enum status recognise(const struct cloudtext *text, enum cloudfile_format *format)
{
    struct cloudtext t = *text;

    if (cloudply_is(&t)) {
        *format = CLOUDFILE_PLY;
        return ST_OK;
    }
    skip_bom(&t);
    for (;;) {
        cloudtext_blank(&t);
        if (t.p == t.end)
            return cloudtext_fail(&t, ST_EINVAL, "there are no points in it");
        if (!cloudtext_eol(&t) && !cloudtext_comment(&t))
            break;
        cloudtext_skip(&t);
    }
    if (cloudobj_is(&t))
        *format = CLOUDFILE_OBJ;
    else if (cloudxyz_is(&t))
        *format = CLOUDFILE_XYZ;
    else
        return cloudtext_fail(&t, ST_EINVAL, "neither a PLY nor an OBJ nor an XYZ file");
    return ST_OK;
}

static enum status text_parse(struct cloudtext *t, enum cloudfile_format format,
                              size_t max_points, struct dvec3 **out, size_t *n)
{
    struct cloudtext_points list = {NULL, 0, max_points};
    size_t bytes, room;
    enum status st;

    skip_bom(t);
    if ((st = cloudtext_plain(t)) != ST_OK)
        return st;
    bytes = (size_t)(t->end - t->p);
    room = cloudtext_lines(t);
    room = room < bytes / 6 + 1 ? room : bytes / 6 + 1;
    room = room < max_points ? room : max_points;
    if ((list.at = mem_array(room, sizeof *list.at)) == NULL)
        return ST_ENOMEM;
    st = format == CLOUDFILE_OBJ ? cloudobj_parse(t, &list) : cloudxyz_parse(t, &list);
    if (st == ST_OK && list.n == 0)
        st = cloudtext_fail(t, ST_EINVAL, "there are no points in it");
    if (st != ST_OK) {
        mem_free(list.at);
        return st;
    }
    *out = list.at;
    *n = list.n;
    return ST_OK;
}

enum status cloudfile_parse(const void *bytes, size_t len, enum cloudfile_format format,
                            size_t max_points, struct dvec3 **out, size_t *n,
                            struct clouderror *err)
{
    struct cloudtext t;
    enum status st;

    *out = NULL;
    *n = 0;
    t.start = t.p = bytes;
    t.end = t.start + len;
    t.line = 1;
    t.continued = false;
    t.err = err;
    if (len == 0)
        return cloudtext_fail(&t, ST_EINVAL, "there are no points in it");
    if (format == CLOUDFILE_ANY && (st = recognise(&t, &format)) != ST_OK)
        return st;
    if (format == CLOUDFILE_PLY)
        return cloudply_parse(&t, max_points, out, n);
    return text_parse(&t, format, max_points, out, n);
}
