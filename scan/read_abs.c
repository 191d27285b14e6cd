#include "read.h"

#include <math.h>
#include <stddef.h>
#include <stdint.h>

#include "cloudlist.h"
#include "cloudtext.h"

#define LISTS 4 /* a flag, x, y and z of each pixel */

/* A count and what it is of: "480 rows". */
static bool take_size(struct cloudtext *t, const char *what, uint64_t *out)
{
    size_t len;
    const char *word = cloudtext_word(t, &len);

    if (!cloudtext_count(word, len, out))
        return false;
    word = cloudtext_word(t, &len);
    return cloudtext_is(word, len, what);
}

static enum status read_size(struct cloudtext *t, const char *what, uint64_t *out)
{
    if (!take_size(t, what, out))
        return cloudtext_fail(t, ST_EINVAL, "a line like \"480 %s\" is expected here",
                              what);
    cloudtext_skip(t);
    return ST_OK;
}

static enum status read_abs_read_header(struct cloudtext *t, uint64_t *width,
                                        uint64_t *height)
{
    static const char *const words[] = {"pixels", "(flag", "X", "Y", "Z):"};
    enum status st;

    if ((st = read_size(t, "rows", height)) != ST_OK ||
        (st = read_size(t, "columns", width)) != ST_OK)
        return st;
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        size_t len;
        const char *word = cloudtext_word(t, &len);

        if (!cloudtext_is(word, len, words[i]))
            return cloudtext_fail(
                t, ST_EVERSION,
                "\"pixels (flag X Y Z):\" is expected here, other values are not read");
    }
    cloudtext_skip(t);
    return ST_OK;
}

/* The lists follow each other: where each of them, of n values, begins. */
static enum status find_lists(struct cloudtext *t, uint64_t n,
                              struct cloudtext list[LISTS])
{
    static const char *const name[LISTS] = {"flags", "X", "Y", "Z"};
    size_t len;

    for (int k = 0; k < LISTS; k++) {
        list[k] = *t;
        for (uint64_t i = 0; i < n; i++) {
            if (!cloudtext_find(t))
                return cloudtext_fail(
                    t, ST_EINVAL,
                    "the header promises %llu values, the list %s ends after %llu",
                    (unsigned long long)n, name[k], (unsigned long long)i);
            (void)cloudtext_word(t, &len);
        }
    }
    return cloudtext_find(t)
               ? cloudtext_fail(t, ST_EINVAL, "more values than the header promises")
               : ST_OK;
}

/* The next value of a list; of a point without one it may be anything. */
static enum status take_value(struct cloudtext *t, bool wanted, double *out)
{
    size_t len;

    (void)cloudtext_find(t);
    if (wanted)
        return cloudtext_number(t, out);
    (void)cloudtext_word(t, &len);
    *out = (double)NAN;
    return ST_OK;
}

static enum status read_pixel(struct cloudtext from[LISTS], struct cloudlist *list)
{
    double flag, v[3];
    enum status st = take_value(&from[0], true, &flag);

    for (int k = 0; k < 3 && st == ST_OK; k++)
        st = take_value(&from[k + 1], flag != 0, &v[k]);
    return st == ST_OK ? cloudlist_add(list, (struct dvec3){v[0], v[1], v[2]}) : st;
}

bool read_abs_is(const struct cloudtext *t)
{
    struct cloudtext at = *t;
    uint64_t rows;

    return take_size(&at, "rows", &rows);
}

enum status read_abs_parse(struct cloudtext *t, const struct cloudfile_options *o,
                           struct cloudlist *list)
{
    (void)o;
    struct cloudtext from[LISTS];
    uint64_t width, height;
    enum status st = cloudtext_plain(t);

    if (st != ST_OK || (st = read_abs_read_header(t, &width, &height)) != ST_OK)
        return st;
    if (width > UINT32_MAX || height > UINT32_MAX)
        return cloudtext_fail(t, ST_EINVAL, "rows and columns are too large");
    if ((st = find_lists(t, width * height, from)) != ST_OK)
        return st;
    list->out.width = (uint32_t)width;
    list->out.height = (uint32_t)height;
    for (uint64_t i = 0; i < width * height && st == ST_OK; i++)
        st = read_pixel(from, list);
    return st;
}
