#include "cloudxyz.h"

#include <string.h>

#include "cloudformat.h"
#include "cloudheading.h"
#include "cloudlist.h"
#include "cloudtext.h"

/* A file while it is read. */
struct reading {
    struct cloudtext *t;
    struct cloudlist *list;
    struct cloudheading columns;
    bool begun;   /* a line of data or a heading was met */
    bool counted; /* PTS: a line says how many points follow it */
    uint64_t due; /* of them, not read yet */
};

bool cloudxyz_is(const struct cloudtext *t)
{
    return cloudtext_is_letter(*t->p) || memchr("\"+-.0123456789", *t->p, 14) != NULL;
}

/* After a field: pass over what separates it from the next; 0 at the line's end. */
static char separator(const struct reading *r)
{
    struct cloudtext *t = r->t;
    const char *before = t->p;

    if (r->columns.separator == '\t') { /* of which each ends a field, empty or not */
        while (t->p < t->end && *t->p == ' ')
            t->p++;
        return t->p < t->end && *t->p == '\t' ? *t->p++ : 0;
    }
    cloudtext_blank(t);
    if (cloudtext_eol(t))
        return 0;
    if (*t->p == ',' || *t->p == ';')
        return *t->p++;
    return t->p != before ? ' ' : 0;
}

/* Pass over a field that is not needed, whatever is in it. */
static void skip_field(struct reading *r)
{
    struct cloudtext *t = r->t;
    const char until = r->columns.separator;
    bool quoted = false;

    if (until != '\t')
        cloudtext_blank(t);
    for (; !cloudtext_eol(t); t->p++) {
        if (*t->p == '"')
            quoted = !quoted;
        if (!quoted && (*t->p == until || (until == ' ' && *t->p == '\t')))
            return;
    }
}

/* The coordinates of a line, by the columns. */
static enum status read_point(struct reading *r)
{
    const struct cloudheading *c = &r->columns;
    double value[6] = {0};
    char first = 0;
    enum status st;

    for (unsigned i = 0; i <= c->last; i++) {
        const int role = cloudheading_role(c, i);

        if (role < 0)
            skip_field(r);
        else if (c->separator == '\t' && (cloudtext_eol(r->t) || *r->t->p == '\t'))
            return cloudtext_fail(r->t, ST_EINVAL, "a number is expected here");
        else if ((st = cloudtext_number(r->t, &value[role])) != ST_OK)
            return st;
        if (i < c->last) {
            const char by = separator(r);

            if (i == 0)
                first = by;
            else if (by != first && by != 0)
                return cloudtext_fail(r->t, ST_EINVAL,
                                      "mixed separators: is it a decimal comma?");
        }
    }
    st = cloudlist_add(r->list, (struct dvec3){value[0], value[1], value[2]});
    if (st == ST_OK && c->normals)
        st = cloudlist_normal(r->list, (struct dvec3){value[3], value[4], value[5]});
    return st;
}

static enum status check_due(struct reading *r)
{
    if (r->due == 0)
        return ST_OK;
    return cloudtext_fail(r->t, ST_EINVAL,
                          "%llu points fewer than the count of the PTS file says",
                          (unsigned long long)r->due);
}

/* Is a count alone on this line?  Then it is passed over. */
static bool take_count(struct reading *r, uint64_t *out)
{
    struct cloudtext at = *r->t;
    size_t len;
    const char *word = cloudtext_word(&at, &len);

    cloudtext_blank(&at);
    if (!cloudtext_eol(&at) || !cloudtext_count(word, len, out))
        return false;
    r->t->p = at.p;
    return true;
}

/* A line that is neither blank nor a comment. */
static enum status read_line(struct reading *r)
{
    const bool first = !r->begun;
    uint64_t count;
    enum status st;

    r->begun = true;
    if ((first || r->counted) && take_count(r, &count)) {
        if (r->counted && r->list->out.read == 0 && r->due > 0)
            return cloudtext_fail(
                r->t, ST_EVERSION,
                "a PTX file is not read: send PTS, or " CLOUDFORMAT_READ);
        st = check_due(r);
        r->counted = true;
        r->due = count;
        return st;
    }
    if (first && cloudheading_is(r->t))
        return cloudheading_take(&r->columns, r->t, false);
    if (r->counted && r->due-- == 0)
        return cloudtext_fail(r->t, ST_EINVAL,
                              "more points than the count of the PTS file says");
    if (r->list->out.read == 0)
        cloudheading_settle(&r->columns, r->t);
    return read_point(r);
}

enum status cloudxyz_parse(struct cloudtext *t, struct cloudlist *list)
{
    struct reading r = {.t = t, .list = list, .columns = CLOUDHEADING_NONE};

    while (t->p < t->end) {
        enum status st = ST_OK;

        cloudtext_blank(t);
        if (!cloudtext_eol(t)) {
            if (!cloudtext_comment(t))
                st = read_line(&r);
            else if (!r.begun)
                st = cloudheading_take(&r.columns, t, true);
        }
        if (st != ST_OK)
            return st;
        cloudtext_skip(t);
    }
    list->out.unit_mm = r.columns.unit_mm;
    return check_due(&r);
}
