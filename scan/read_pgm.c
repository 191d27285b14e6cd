#include "read.h"

#include <stdint.h>
#include <string.h>

#include "clouddepth.h"
#include "cloudfile.h"
#include "cloudlist.h"
#include "cloudtext.h"

bool read_pgm_is(const struct cloudtext *t)
{
    return t->end - t->p >= 3 && t->p[0] == 'P' && (t->p[1] == '2' || t->p[1] == '5') &&
           memchr(" \t\r\n#", t->p[2], 5) != NULL;
}

/* The next number, behind blanks, lines and comments. */
static enum status read_number(struct cloudtext *t, uint64_t most, uint64_t *out)
{
    const char *word;
    size_t len;

    while (cloudtext_find(t) && *t->p == '#')
        cloudtext_skip(t);
    word = cloudtext_word(t, &len);
    if (cloudtext_count(word, len, out) && *out <= most)
        return ST_OK;
    t->p = word;
    return cloudtext_fail(t, ST_EINVAL, "a number from 0 to %llu is expected here",
                          (unsigned long long)most);
}

static enum status read_text(struct cloudtext *t, const struct clouddepth_camera *camera,
                             const uint64_t head[3], struct cloudlist *list)
{
    const uint64_t n = head[0] * head[1];
    struct clouddepth depth;
    enum status st =
        clouddepth_begin(&depth, camera, (uint32_t)head[0], (uint32_t)head[1], list);
    uint64_t value;

    for (uint64_t i = 0; i < n && st == ST_OK; i++)
        if ((st = read_number(t, head[2], &value)) == ST_OK)
            st = clouddepth_add(&depth, (double)value);
    if (st == ST_OK && cloudtext_find(t))
        return cloudtext_fail(t, ST_EINVAL, "more pixels than the PGM header says");
    return st;
}

/* Width, height and the largest value. */
static enum status read_head(struct cloudtext *t, uint64_t head[3])
{
    enum status st = ST_OK;

    if (!read_pgm_is(t))
        return cloudtext_fail(t, ST_EINVAL, "a PGM file begins with P5 or P2");
    t->p += 2;
    for (int i = 0; i < 3 && st == ST_OK; i++)
        st = read_number(t, CLOUDDEPTH_SIDE_MAX, &head[i]);
    return st;
}

uint64_t read_pgm_count(struct cloudtext t)
{
    uint64_t head[3];

    return read_head(&t, head) == ST_OK ? head[0] * head[1] : 0;
}

enum status read_pgm_parse(struct cloudtext *t, const struct cloudfile_options *o,
                           struct cloudlist *list)
{
    const bool text = read_pgm_is(t) && t->p[1] == '2';
    uint64_t head[3];
    enum status st;

    if ((st = read_head(t, head)) != ST_OK)
        return st;
    if (head[2] < 256)
        return cloudtext_fail(t, ST_EVERSION,
                              "a PGM picture of 8 bits: a depth image has 16 bits");
    if (text)
        return read_text(t, &o->camera, head, list);
    t->p += t->p < t->end; /* one blank or line end, and then whatever is there */
    return clouddepth_values(t, &o->camera, (uint32_t)head[0], (uint32_t)head[1], true,
                             list);
}
