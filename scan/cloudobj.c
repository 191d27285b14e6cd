#include "cloudobj.h"

#include "cloudtext.h"
#include "vec.h"

bool cloudobj_is(const struct cloudtext *t)
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

static enum status vertex(struct cloudtext *t, struct cloudtext_points *list)
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
    return cloudtext_point(t, list, (struct dvec3){value[0], value[1], value[2]});
}

enum status cloudobj_parse(struct cloudtext *t, struct cloudtext_points *list)
{
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
        if (cloudtext_is(word, len, "v")) {
            if ((st = vertex(t, list)) != ST_OK)
                return st;
        } else if (len != 0 && !cloudtext_is_letter(word[0])) {
            t->p = word;
            return cloudtext_fail(t, ST_EINVAL, "not a line of an OBJ file");
        }
        cloudtext_skip(t);
    }
    return ST_OK;
}
