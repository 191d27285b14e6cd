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
 * number from 0. */
static bool read_obj_corner(const struct cloudlist *list, const char *word, size_t len,
                            uint64_t *out)
{
    const char *slash = len > 0 ? memchr(word, '/', len) : NULL;
    const bool negative = len > 0 && *word == '-';
    uint64_t k;

    if (slash != NULL)
        len = (size_t)(slash - word);
    if (!cloudtext_count(word + negative, len - negative, &k) || k == 0 ||
        k > list->out.read)
        return false;
    *out = negative ? list->out.read - k : k - 1;
    return true;
}

/* A polygon as a fan of triangles.  ST_EINVAL, without a message: not a face. */
static enum status face(struct cloudtext *t, struct cloudlist *list)
{
    uint64_t c[3];
    size_t len;
    enum status st = ST_OK;

    for (unsigned n = 0; st == ST_OK; n++) {
        const char *word = cloudtext_word(t, &len);

        if (len == 0)
            return n >= 3 ? ST_OK : ST_EINVAL;
        if (!read_obj_corner(list, word, len, &c[n < 3 ? n : 2]))
            return ST_EINVAL;
        if (n >= 2) {
            st = cloudlist_face(list, c);
            c[1] = c[2];
        }
    }
    return st;
}

/* A line whose first word is read. */
static enum status line(struct cloudtext *t, struct cloudlist *list, const char *word,
                        size_t len, bool *faces)
{
    enum status st;

    if (cloudtext_is(word, len, "v"))
        return vertex(t, list);
    if (*faces && cloudtext_is(word, len, "f")) {
        if ((st = face(t, list)) != ST_EINVAL)
            return st;
        cloudlist_forget(list);
        *faces = false;
        return ST_OK;
    }
    if (len == 0 || cloudtext_is_letter(word[0]))
        return ST_OK;
    t->p = word;
    return cloudtext_fail(t, ST_EINVAL, "not a line of an OBJ file");
}

enum status read_obj_parse(struct cloudtext *t, const struct cloudfile_options *o,
                           struct cloudlist *list)
{
    (void)o;
    bool faces = true;

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
        if ((st = line(t, list, word, len, &faces)) != ST_OK)
            return st;
        cloudtext_skip(t);
    }
    return ST_OK;
}
