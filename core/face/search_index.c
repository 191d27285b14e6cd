#include <math.h>
#include <string.h>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include "search.h"

#define D     SEARCH_MODES
#define BLOCK SEARCH_BLOCK
#define CLAMP 2047 /* of a value: 32 deviations; D squares of it fit into 32 bits */
#define CHUNK 256  /* blocks that are allocated together */

/* Numbers of rows after which a block may be left; the last one is never reached. */
static const uint32_t looks[] = {8, 16, 24, 32, 48, 64, 80, D + 1};

struct chunk {
    struct search_block block[CHUNK];
    uint16_t used[CHUNK]; /* a bit each descriptor */
    uint8_t class[CHUNK];
    uint32_t next[CHUNK]; /* another block of the class that has room */
};

struct surface_index {
    uint32_t nblock, nchunk, cap; /* cap: of chunk */
    struct chunk **chunk;
    uint32_t room
        [SEARCH_CLASSES]; /* first block of the class with room, SURFACE_NOWHERE: none */
    uint32_t used[SEARCH_CLASSES]; /* number of descriptors */
};

/* ---- the sums */

/* Squares of the clamped values.  Row by row from the last: the sums only grow. */
bool search_cost_plain(const struct search_block *b, const struct search_rows *rows,
                       int32_t limit, int32_t cost[BLOCK])
{
    const uint32_t *look = looks;

    memset(cost, 0, BLOCK * sizeof *cost);
    for (uint32_t done = 1; done <= D; done++) {
        const struct search_row *r = &rows->row[D - done];
        bool all = true;

        for (uint32_t i = 0; i < BLOCK; i++) {
            int32_t v = -r->offset;

            for (uint32_t k = (D - done) / 2; k < D / 2; k++)
                for (uint32_t odd = 0; odd < 2; odd++)
                    v += r->factor[2 * k + odd] *
                         b->x[k][i / (BLOCK / 2)][i % (BLOCK / 2)][odd];
            v >>= r->shift;
            v = v > CLAMP ? CLAMP : v < -CLAMP ? -CLAMP : v;
            cost[i] += v * v;
            all = all && cost[i] > limit;
        }
        if (done == *look) {
            look++;
            if (all)
                return false;
        }
    }
    return true;
}

#ifdef __SSE2__

struct sums { /* of 16 descriptors */
    __m128i of[4];
};

/* A pair of modes of 16 descriptors as 16 bits each. */
static inline void widen(const int8_t (*from)[BLOCK / 2][2], __m128i to[4])
{
    for (int half = 0; half < 2; half++) {
        __m128i v;

        memcpy(&v, from[half], sizeof v);
        to[2 * half] = _mm_srai_epi16(_mm_unpacklo_epi8(v, v), 8);
        to[2 * half + 1] = _mm_srai_epi16(_mm_unpackhi_epi8(v, v), 8);
    }
}

/* The sums of a row, from its pair `first` on. */
static inline struct sums row_sums(const struct search_row *r, uint32_t first,
                                   __m128i x[D / 2][4])
{
    struct sums s;

    for (int q = 0; q < 4; q++)
        s.of[q] = _mm_set1_epi32(-r->offset);
    for (uint32_t k = first; k < D / 2; k++) {
        int32_t two;
        __m128i f;

        memcpy(&two, &r->factor[2 * k], sizeof two);
        f = _mm_set1_epi32(two);
        for (int q = 0; q < 4; q++)
            s.of[q] = _mm_add_epi32(s.of[q], _mm_madd_epi16(f, x[k][q]));
    }
    return s;
}

/* cost += the squares of the clamped values v >> shift. */
static inline void add_squares(const struct sums *v, int32_t shift, struct sums *cost)
{
    const __m128i most = _mm_set1_epi16(CLAMP), least = _mm_set1_epi16(-CLAMP);
    const __m128i by = _mm_cvtsi32_si128(shift), zero = _mm_setzero_si128();

    for (int h = 0; h < 2; h++) {
        __m128i w = _mm_packs_epi32(_mm_sra_epi32(v->of[2 * h], by),
                                    _mm_sra_epi32(v->of[2 * h + 1], by));
        __m128i low, high;

        w = _mm_max_epi16(_mm_min_epi16(w, most), least);
        low = _mm_unpacklo_epi16(w, zero);
        high = _mm_unpackhi_epi16(w, zero);
        cost->of[2 * h] = _mm_add_epi32(cost->of[2 * h], _mm_madd_epi16(low, low));
        cost->of[2 * h + 1] =
            _mm_add_epi32(cost->of[2 * h + 1], _mm_madd_epi16(high, high));
    }
}

static inline bool all_above(const struct sums *s, int32_t limit)
{
    const __m128i than = _mm_set1_epi32(limit);
    __m128i above = _mm_cmpgt_epi32(s->of[0], than);

    for (int q = 1; q < 4; q++)
        above = _mm_and_si128(above, _mm_cmpgt_epi32(s->of[q], than));
    return _mm_movemask_epi8(above) == 0xffff;
}

bool search_cost(const struct search_block *b, const struct search_rows *rows,
                 int32_t limit, int32_t cost[BLOCK])
{
    const uint32_t *look = looks;
    __m128i x[D / 2][4];
    struct sums sum;

    memset(&sum, 0, sizeof sum);
    for (uint32_t done = 1; done <= D; done++) {
        const struct search_row *r = &rows->row[D - done];
        const uint32_t first = (D - done) / 2;
        struct sums v;

        if (done % 2 == 1)
            widen(b->x[first], x[first]);
        v = row_sums(r, first, x);
        add_squares(&v, r->shift, &sum);
        if (done == *look) {
            look++;
            if (all_above(&sum, limit))
                return false;
        }
    }
    memcpy(cost, &sum, sizeof sum);
    return true;
}

#else

bool search_cost(const struct search_block *b, const struct search_rows *rows,
                 int32_t limit, int32_t cost[BLOCK])
{
    return search_cost_plain(b, rows, limit, cost);
}

#endif

/* ---- the index */

struct surface_index *surface_index_new(void)
{
    struct surface_index *x = mem_array(1, sizeof *x);

    if (x == NULL)
        return NULL;
    *x = (struct surface_index){0};
    for (int c = 0; c < SEARCH_CLASSES; c++)
        x->room[c] = SURFACE_NOWHERE;
    return x;
}

void surface_index_free(struct surface_index *x)
{
    if (x == NULL)
        return;
    for (uint32_t i = 0; i < x->nchunk; i++)
        mem_free(x->chunk[i]);
    mem_free(x->chunk);
    mem_free(x);
}

static struct chunk *chunk_of(const struct surface_index *x, uint32_t block)
{
    return x->chunk[block / CHUNK];
}

static bool add_chunk(struct surface_index *x)
{
    const uint32_t more = x->cap == 0 ? 16 : 2 * x->cap;
    struct chunk *c;

    if (x->nchunk == x->cap) {
        struct chunk **grown =
            mem_grow(x->chunk, x->nchunk * sizeof *grown, more * sizeof *grown);

        if (grown == NULL)
            return false;
        x->chunk = grown;
        x->cap = more;
    }
    if ((c = mem_array(1, sizeof *c)) == NULL)
        return false;
    memset(c, 0, sizeof *c);
    x->chunk[x->nchunk++] = c;
    return true;
}

/* The mode that a place has: the one that tells most comes last. */
static int8_t *place(struct chunk *c, uint32_t block, uint32_t lane, uint32_t mode)
{
    const uint32_t at = D - 1 - mode;

    return &c->block[block % CHUNK]
                .x[at / 2][lane / (BLOCK / 2)][lane % (BLOCK / 2)][at % 2];
}

uint32_t surface_index_add(struct surface_index *x,
                           const unsigned char d[SURFACE_DESCRIPTOR])
{
    const uint32_t class = d[0];
    uint32_t b, lane;
    struct chunk *c;

    if (class >= SEARCH_CLASSES)
        return SURFACE_NOWHERE;
    if ((b = x->room[class]) == SURFACE_NOWHERE) {
        if (x->nblock >= SURFACE_NOWHERE / BLOCK ||
            (x->nblock == x->nchunk * CHUNK && !add_chunk(x)))
            return SURFACE_NOWHERE;
        b = x->nblock++;
        chunk_of(x, b)->class[b % CHUNK] = (uint8_t) class;
        chunk_of(x, b)->next[b % CHUNK] = SURFACE_NOWHERE;
        x->room[class] = b;
    }
    c = chunk_of(x, b);
    lane = (uint32_t)__builtin_ctz(~(uint32_t)c->used[b % CHUNK]);
    c->used[b % CHUNK] |= (uint16_t)(1U << lane);
    x->used[class]++;
    if (c->used[b % CHUNK] == UINT16_MAX)
        x->room[class] = c->next[b % CHUNK];
    for (uint32_t i = 0; i < D; i++)
        *place(c, b, lane, i) = (int8_t)d[1 + i];
    return b * BLOCK + lane;
}

void surface_index_remove(struct surface_index *x, uint32_t slot)
{
    const uint32_t b = slot / BLOCK, lane = slot % BLOCK;
    struct chunk *c = chunk_of(x, b);
    uint16_t *used = &c->used[b % CHUNK];

    if (*used == UINT16_MAX) {
        c->next[b % CHUNK] = x->room[c->class[b % CHUNK]];
        x->room[c->class[b % CHUNK]] = b;
    }
    *used &= (uint16_t) ~(1U << lane);
    x->used[c->class[b % CHUNK]]--;
    for (uint32_t i = 0; i < D; i++)
        *place(c, b, lane, i) = 0;
}

size_t surface_index_bytes(const struct surface_index *x)
{
    return sizeof *x + x->cap * sizeof *x->chunk + x->nchunk * sizeof **x->chunk;
}

unsigned search_classes(const struct surface_index *x)
{
    unsigned classes = 0;

    for (unsigned c = 0; c < SEARCH_CLASSES; c++)
        classes |= (x->used[c] > 0 ? 1U : 0U) << c;
    return classes;
}

/* ---- the best, as a heap whose first is the worst of them */

static bool is_worse(struct search_hit a, struct search_hit b)
{
    return a.cost != b.cost ? a.cost > b.cost : a.slot > b.slot;
}

static void sink(struct search_hit *h, size_t n, size_t i, struct search_hit what)
{
    for (size_t child; (child = 2 * i + 1) < n; i = child) {
        if (child + 1 < n && is_worse(h[child + 1], h[child]))
            child++;
        if (!is_worse(h[child], what))
            break;
        h[i] = h[child];
    }
    h[i] = what;
}

static size_t push(struct search_hit *h, size_t n, size_t most, struct search_hit what)
{
    size_t i = n;

    if (n == most) {
        if (is_worse(h[0], what))
            sink(h, n, 0, what);
        return n;
    }
    for (; i > 0 && is_worse(what, h[(i - 1) / 2]); i = (i - 1) / 2)
        h[i] = h[(i - 1) / 2];
    h[i] = what;
    return n + 1;
}

static void sort_hits(struct search_hit *h, size_t n)
{
    while (n > 1) {
        const struct search_hit last = h[--n];

        h[n] = h[0];
        sink(h, n, 0, last);
    }
}

size_t search_scan(const struct surface_index *x, const struct search_probe *p,
                   const uint16_t *allowed, double floor, size_t most,
                   struct search_hit *hit)
{
    const double least = (p->best - floor) * 2 * SEARCH_UNIT * SEARCH_UNIT;
    const int32_t end = least < 0 ? -1 : (int32_t)fmin(least, 2e9);
    size_t n = 0;

    for (uint32_t b = 0; b < x->nblock; b++) {
        const struct chunk *c = chunk_of(x, b);
        const struct search_rows *rows = &p->class[c->class[b % CHUNK]];
        uint32_t lanes = c->used[b % CHUNK] & (allowed != NULL ? allowed[b] : UINT16_MAX);
        int32_t cost[BLOCK], limit;

        if (lanes == 0)
            continue;
        limit = (n == most && hit[0].cost < end ? hit[0].cost : end) - rows->base;
        if (limit < 0 || !search_cost(&c->block[b % CHUNK], rows, limit, cost))
            continue;
        for (; lanes != 0; lanes &= lanes - 1) {
            const uint32_t lane = (uint32_t)__builtin_ctz(lanes);

            if (cost[lane] <= limit)
                n = push(hit, n, most,
                         (struct search_hit){cost[lane] + rows->base, b * BLOCK + lane});
        }
    }
    sort_hits(hit, n);
    return n;
}
