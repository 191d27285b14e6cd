#include "read.h"

#include <math.h>
#include <stddef.h>
#include <stdint.h>

#include "cloudlist.h"
#include "cloudtext.h"
#include "cloudvalue.h"

/* All little-endian: rows and columns (2 bytes each), the z that stands for no value (8), the
 * length of an image's name (2), the name, the number of doubles (4), and five blocks of them:
 * x, y, z, and where the point is in the image. */
#define HEAD   18 /* bytes, without the name */
#define BLOCKS 5

static double value_at(const struct cloudtext *t, size_t at, enum cloudvalue type)
{
    return cloudvalue_load((const unsigned char *)t->p + at, type,
                           cloudvalue_swap(false));
}

/* How many points the header promises, if its numbers agree; and how long it is. */
static uint64_t count_of(const struct cloudtext *t, size_t *head)
{
    const size_t len = (size_t)(t->end - t->p);
    uint64_t n;

    if (len < HEAD)
        return 0;
    *head = HEAD + (size_t)value_at(t, 12, CLOUDVALUE_U16);
    if (len < *head)
        return 0;
    n = (uint64_t)(value_at(t, 0, CLOUDVALUE_U16) * value_at(t, 2, CLOUDVALUE_U16));
    return (double)(BLOCKS * n) == value_at(t, *head - 4, CLOUDVALUE_U32) ? n : 0;
}

bool read_bnt_is(const struct cloudtext *t)
{
    size_t head;

    return count_of(t, &head) > 0;
}

enum status read_bnt_parse(struct cloudtext *t, const struct cloudfile_options *o,
                           struct cloudlist *list)
{
    (void)o;
    size_t head;
    const uint64_t n = count_of(t, &head), left = (uint64_t)(t->end - t->p);
    double zmin;
    enum status st = ST_OK;

    t->line = 0;
    if (n == 0)
        return cloudtext_fail(t, ST_EINVAL,
                              "a BNT file begins with rows, columns and, behind a name, "
                              "5 times their product");
    zmin = value_at(t, 4, CLOUDVALUE_F64);
    if (left != head + 8 * BLOCKS * n)
        return cloudtext_fail(
            t, ST_EINVAL, "%llu points take %llu bytes, the BNT file has %llu",
            (unsigned long long)n, (unsigned long long)(head + 8 * BLOCKS * n),
            (unsigned long long)left);
    t->p += head;
    for (size_t i = 0; i < n && st == ST_OK; i++) {
        struct dvec3 p = {value_at(t, 8 * i, CLOUDVALUE_F64),
                          value_at(t, 8 * (i + n), CLOUDVALUE_F64),
                          value_at(t, 8 * (i + 2 * n), CLOUDVALUE_F64)};

        if (p.z == zmin)
            p.z = (double)NAN;
        st = cloudlist_add(list, p);
    }
    return st;
}
