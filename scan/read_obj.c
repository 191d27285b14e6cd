#include "read.h"

#include <string.h>

#include "cloudlist.h"
#include "cloudtext.h"

bool read_obj_is(const struct cloudtext *t)
{
    static const char *const words[] = {"v", "vn", "vt", "vp",     "o",
                                        "g", "s",  "f",  "mtllib", "usemtl"};
    struct cloudtext at = *t;
    size_t len;
    const char *word = cloudtext_word(&at, &len);

    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (cloudtext_is(word, len, words[i]))
            return true;
    return false;
}

static enum status vertex(struct cloudtext *t, struct cloudlist *list)
{
    double value[8];
    unsigned n = 0;
    enum status st;

    for (cloudtext_blank(t); n < 3 || !cloudtext_eol(t); cloudtext_blank(t)) {
        if (n == 8)
            return cloudtext_fail(t, ST_EINVAL, "more than 8 numbers for a vertex");
        if ((st = cloudtext_number(t, &value[n++])) != ST_OK)
            return st;
        if (!cloudtext_eol(t) && (*t->p == ',' || *t->p == ';'))
            return cloudtext_fail(t, ST_EINVAL,
                                  "numbers of an OBJ file are set apart by blanks");
    }
    return cloudlist_add(list, (struct dvec3){value[0], value[1], value[2]});
}

/* The vertex that a corner of a face names, "7/1/2" or, counted from the last, "-1": its
 * number from 0, which may be that of no vertex. */
static bool read_obj_corner(const struct cloudlist *list, const char *word, size_t len,
                            uint64_t *out)
{
    const char *slash = memchr(word, '/', len);
    const bool negative = *word == '-';
    uint64_t k;

    if (slash != NULL)
        len = (size_t)(slash - word);
    if (!cloudtext_count(word + negative, len - negative, &k) || k == 0)
        return false;
    *out = negative ? list->out.read - k : k - 1;
    return true;
}

/* A polygon.  If it is none, the faces are forgotten. */
static enum status face(struct cloudtext *t, struct cloudlist *list)
{
    struct cloudlist_fan fan = {.n = 0};
    enum status st = ST_OK;
    uint64_t k;
    size_t len;
    const char *word;

    while (st == ST_OK && (word = cloudtext_word(t, &len), len != 0)) {
        if (!read_obj_corner(list, word, len, &k)) {
            cloudlist_forget(list);
            return ST_OK;
        }
        st = cloudlist_corner(list, &fan, k);
    }
    if (fan.n < 3)
        cloudlist_forget(list);
    return st;
}

/* A line whose first word is read. */
static enum status line(struct cloudtext *t, struct cloudlist *list, const char *word,
                        size_t len)
{
    if (cloudtext_is(word, len, "v"))
        return vertex(t, list);
    if (cloudtext_is(word, len, "f"))
        return face(t, list);
    if (len == 0 || cloudtext_is_letter(word[0]))
        return ST_OK;
    t->p = word;
    return cloudtext_fail(t, ST_EINVAL, "not a line of an OBJ file");
}

enum status read_obj_parse(struct cloudtext *t, const struct cloudfile_options *o,
                           struct cloudlist *list)
{
    (void)o;

    t->continued = true;
    while (t->p < t->end) {
        const char *word;
        size_t len;
        enum status st;

        word = cloudtext_word(t, &len);
        if (len != 0 && word[0] == '#') {
            t->continued = false; /* a comment ends with its line whatever is in it */
            cloudtext_skip(t);
            t->continued = true;
            continue;
        }
        if ((st = line(t, list, word, len)) != ST_OK)
            return st;
        cloudtext_skip(t);
    }
    return ST_OK;
}
