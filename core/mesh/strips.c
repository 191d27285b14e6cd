#include "strips.h"

#include <stdbool.h>
#include <string.h>

#include "lattice.h"
#include "mem.h"
#include "predicates.h"

/* Points in a square of a strip (strips.h).  Time is flat from 4 to 12. */
#define STRIPS_PER_SQUARE 8

#define DIGIT_BITS 11

struct item {
    int32_t x, y, z;
    uint32_t strip;
};

struct extent {
    int32_t min, max;
};

size_t strips_scratch(size_t n)
{
    return 2 * mem_round(n * sizeof(struct item));
}

/* Stable LSD radix sort by x (or y), from *a; *a and *b swap so that *a is sorted. */
static void sort_by(struct item **a, struct item **b, size_t n, bool by_y,
                    struct extent e)
{
    const uint32_t range = (uint32_t)(e.max - e.min);
    unsigned bits = 0, passes;

    while (bits < 32 && (range >> bits) != 0)
        bits++;
    passes = (bits + DIGIT_BITS - 1) / DIGIT_BITS;
    for (unsigned p = 0, shift = 0; p < passes; p++) {
        const unsigned width = (bits - shift + (passes - p) - 1) / (passes - p);
        const uint32_t mask = (UINT32_C(1) << width) - 1;
        uint32_t at[1u << DIGIT_BITS];
        const struct item *from = *a;
        struct item *to = *b;
        uint32_t sum = 0;

        memset(at, 0, (mask + 1) * sizeof at[0]);
        for (size_t i = 0; i < n; i++)
            at[((uint32_t)((by_y ? from[i].y : from[i].x) - e.min) >> shift) & mask]++;
        for (uint32_t d = 0; d <= mask; d++) {
            uint32_t count = at[d];

            at[d] = sum;
            sum += count;
        }
        for (size_t i = 0; i < n; i++)
            to[at[((uint32_t)((by_y ? from[i].y : from[i].x) - e.min) >> shift) &
                  mask]++] = from[i];
        *b = *a;
        *a = to;
        shift += width;
    }
}

/* Cut items sorted by x into strips of about equal count, between columns. */
static uint32_t cut(struct item *a, size_t n)
{
    uint32_t want = 1, strip = 0;
    size_t size, next;

    while (want < STRIPS_MAX &&
           (uint64_t)(want + 1) * (want + 1) * STRIPS_PER_SQUARE <= n)
        want++;
    size = (n + want - 1) / want;
    next = size;
    for (size_t i = 0; i < n; i++) {
        if (i >= next && a[i].x != a[i - 1].x) {
            strip++;
            next = i + size;
        }
        a[i].strip = strip;
    }
    return strip + 1;
}

/* Points at one place become one; strips shrink accordingly. */
static void unite(struct strips *st, struct ivec2 *xy, int32_t *z)
{
    uint32_t w = 0, begin = st->at[0].first;

    for (uint32_t s = 0; s < st->count; s++) {
        const uint32_t end = st->at[s + 1].first;

        st->at[s].first = w;
        for (uint32_t i = begin, j; i < end; i = j, w++) {
            int64_t sum = z[i], k;

            for (j = i + 1; j < end && xy[j].x == xy[i].x && xy[j].y == xy[i].y; j++)
                sum += z[j];
            k = (int64_t)j - i;
            xy[w] = xy[i];
            z[w] = (int32_t)((sum - (sum < 0 ? k - 1 : 0)) / k); /* rounded down */
        }
        begin = end;
    }
    st->at[st->count].first = w;
}

/* yx_less(a, b): a before b by y, then x. */
static bool yx_less(struct ivec2 a, struct ivec2 b)
{
    return a.y != b.y ? a.y < b.y : a.x < b.x;
}

/* Move the point at `from` to its place among the points [first, last), sorted but for it. */
static void strips_settle(struct ivec2 *xy, int32_t *z, uint32_t from, uint32_t first,
                          uint32_t last)
{
    const struct ivec2 p = xy[from];
    const int32_t height = z[from];
    uint32_t to = from;

    for (; to + 1 < last && yx_less(xy[to + 1], p); to++) {
        xy[to] = xy[to + 1];
        z[to] = z[to + 1];
    }
    for (; to > first && yx_less(p, xy[to - 1]); to--) {
        xy[to] = xy[to - 1];
        z[to] = z[to - 1];
    }
    xy[to] = p;
    z[to] = height;
}

/* A strip left with a single point joins the next one, the last one the one before. */
static void join_singles(struct strips *st, struct ivec2 *xy, int32_t *z)
{
    uint32_t w = 0;

    for (uint32_t s = 0; s < st->count; s++) {
        const uint32_t first = st->at[s].first, end = st->at[s + 1].first;

        if (end - first == 1 && s + 1 < st->count) {
            strips_settle(xy, z, first, first, st->at[s + 2].first);
            st->at[s + 1].first = first;
            continue;
        }
        if (end - first == 1 && w > 0) {
            strips_settle(xy, z, first, st->at[w - 1].first, end);
            continue;
        }
        st->at[w++].first = first;
    }
    st->at[w].first = st->at[st->count].first;
    st->count = w;
}

enum status strips_sort(const struct ivec3 *pts, size_t n, void *block,
                        struct strips *out, struct ivec2 *xy, int32_t *z)
{
    struct item *a = block;
    struct item *b = (struct item *)(void *)((unsigned char *)block +
                                             mem_round(n * sizeof(struct item)));
    struct extent ex = {pts[0].x, pts[0].x}, ey = {pts[0].y, pts[0].y};
    uint32_t fill[STRIPS_MAX];
    bool far = false;

    for (size_t i = 0; i < n; i++) {
        const struct ivec3 p = pts[i];

        ex.min = p.x < ex.min ? p.x : ex.min;
        ex.max = p.x > ex.max ? p.x : ex.max;
        ey.min = p.y < ey.min ? p.y : ey.min;
        ey.max = p.y > ey.max ? p.y : ey.max;
        far |= p.z < -LATTICE_MAX || p.z > LATTICE_MAX;
        a[i] = (struct item){p.x, p.y, p.z, 0};
    }
    if (far || ex.min < -LATTICE_MAX || ex.max > LATTICE_MAX || ey.min < -LATTICE_MAX ||
        ey.max > LATTICE_MAX)
        return ST_ERANGE;

    sort_by(&a, &b, n, false, ex);
    out->count = cut(a, n);
    sort_by(&a, &b, n, true, ey);

    memset(fill, 0, out->count * sizeof fill[0]);
    for (size_t i = 0; i < n; i++)
        fill[a[i].strip]++;
    for (uint32_t s = 0, sum = 0; s < out->count; s++) {
        out->at[s].first = sum;
        sum += fill[s];
        fill[s] = out->at[s].first;
    }
    out->at[out->count].first = (uint32_t)n;
    for (size_t i = 0; i < n; i++) {
        const uint32_t to = fill[a[i].strip]++;

        xy[to] = (struct ivec2){a[i].x, a[i].y};
        z[to] = a[i].z;
    }
    unite(out, xy, z);
    join_singles(out, xy, z);
    for (uint32_t s = 0; s < out->count; s++) {
        struct strip *p = &out->at[s];

        p->lo = p->hi = p->first;
        for (uint32_t i = p->first + 1; i < out->at[s + 1].first; i++) {
            p->lo = lex_less(xy[i], xy[p->lo]) ? i : p->lo;
            p->hi = lex_less(xy[p->hi], xy[i]) ? i : p->hi;
        }
    }
    return out->at[out->count].first >= 2 ? ST_OK : ST_EDEGENERATE;
}
