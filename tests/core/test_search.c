/* The first stage of identification: its score is the exact one of a template of its class, its sums are
 * those of plain integers, and a scan leaves nothing out; nothing of a descriptor stays when it is removed. */
/* link: -Wl,--wrap=aligned_alloc */
#include <limits.h>
#include <math.h>
#include <string.h>

#include "brute.h"
#include "encode.h"
#include "ratio.h"
#include "search.h"
#include "unit.h"

#define D    SEARCH_MODES
#define MANY 700

static struct draw rng;
static struct scratch scratch;
static struct encode_basis encode;
static struct search_basis basis;
static struct encoding probe;
static struct search_probe by;

/* A template of a class, of random identity: the class's A, and b of the coefficients m. */
static void make(int class, const double m[D], struct encoding *e)
{
    float *a = e->a;

    memset(e, 0, sizeof *e);
    e->n = basis.n;
    for (uint32_t i = 0; i < D; i++)
        for (uint32_t k = 0; k <= i; k++)
            *a++ = (float)(basis.precision[class][i][k] - (i == k));
    for (uint32_t i = 0; i < D; i++) {
        double sum = 0;

        for (uint32_t k = 0; k < D; k++)
            sum += basis.precision[class][i][k] * m[k];
        e->b[i] = (float)sum;
    }
}

static void draw_modes(double spread, double m[D])
{
    for (uint32_t i = 0; i < D; i++)
        m[i] = spread * draw_normal(&rng);
}

BEFORE_ALL(set_up)
{
    double m[D];

    rng = draw_stream(brute_seed("test_search"), 0, 0);
    encode_prepare(&model_default, &encode);
    assert_int_equal(search_prepare(&encode, &scratch, &basis), ST_OK);
    draw_modes(0.9, m);
    make(5, m, &probe);
    assert_int_equal(
        search_probe(&basis, &probe, model_default.kinship, UINT_MAX, &scratch, &by),
        ST_OK);
}

AFTER_ALL(tear_down)
{
    scratch_free(&scratch);
}

static void dequantise(const unsigned char d[SURFACE_DESCRIPTOR], double m[D])
{
    for (uint32_t i = 0; i < D; i++)
        m[i] = basis.step[i] * (int8_t)d[1 + i];
}

/* The cost of a descriptor by an index of its own. */
static double score_of(const unsigned char d[SURFACE_DESCRIPTOR])
{
    struct surface_index *x = surface_index_new();
    struct search_hit hit;

    assert_non_null(x);
    assert_int_equal(surface_index_add(x, d), 0);
    assert_int_equal(search_scan(x, &by, NULL, -1e6, 1, &hit), 1);
    surface_index_free(x);
    return search_score(&by, hit.cost);
}

TEST(test_descriptor)
{
    for (int class = 0; class < SEARCH_CLASSES; class ++) {
        unsigned char d[SURFACE_DESCRIPTOR];
        struct encoding e;
        double m[D], got[D];

        draw_modes(0.9, m);
        make(class, m, &e);
        assert_int_equal(search_describe(&basis, &e, &scratch, d), ST_OK);
        assert_int_equal(d[0], class);
        dequantise(d, got);
        for (uint32_t i = 0; i < D; i++)
            if (fabs(m[i]) < 126 * basis.step[i])
                assert_true(fabs(got[i] - m[i]) <= 0.51 * basis.step[i]);
    }
}

/* Two ways to one score: by the integers of the probe, and by ratio_score(). */
TEST(test_score)
{
    for (int round = 0; round < 64; round++) {
        const int class = round % SEARCH_CLASSES;
        unsigned char d[SURFACE_DESCRIPTOR];
        struct ratio_probe *r;
        struct encoding e;
        double m[D], exact, expected;

        draw_modes(round < 8 ? 0.0 : 0.9, m);
        if (round >= 32) /* somebody like the probe */
            for (uint32_t i = 0; i < D; i++)
                m[i] = 0.3 * m[i] + (double)probe.b[i] / basis.precision[5][i][i];
        make(class, m, &e);
        assert_int_equal(search_describe(&basis, &e, &scratch, d), ST_OK);
        d[0] = (unsigned char)class;
        dequantise(d, m);
        make(class, m, &e);
        r = ratio_probe(&probe, model_default.kinship, &scratch);
        assert_non_null(r);
        exact = ratio_score(r, &e, &expected);
        if (exact > -40) /* below, values are clamped */
            assert_true(fabs(score_of(d) - exact) < 0.4);
        else
            assert_true(score_of(d) < -30);
    }
}

/* ---- the sums */

static void draw_descriptor(unsigned char d[SURFACE_DESCRIPTOR])
{
    d[0] = (unsigned char)brute_int(&rng, 0, SEARCH_CLASSES - 1);
    for (uint32_t i = 0; i < D; i++) {
        const double v = draw_normal(&rng) * 0.8 / basis.step[i];

        d[1 + i] = (unsigned char)(int8_t)fmax(-127, fmin(127, rint(v)));
    }
}

TEST(test_plain)
{
    struct search_block b;
    int left = 0;

    for (int round = 0; round < 2000; round++) {
        const struct search_rows *rows = &by.class[round % SEARCH_CLASSES];
        const int32_t limit = (int32_t)brute_int(&rng, 0, 20000000);
        int32_t cost[SEARCH_BLOCK], plain[SEARCH_BLOCK];
        bool whole;

        for (size_t i = 0; i < sizeof b; i++)
            ((unsigned char *)&b)[i] =
                (unsigned char)(round % 10 == 0 ? brute_int(&rng, 0, 256 - 1)
                                                : brute_int(&rng, -2, 2));
        whole = search_cost_plain(&b, rows, limit, plain);
        assert_int_equal(search_cost(&b, rows, limit, cost), whole);
        if (whole)
            assert_memory_equal(cost, plain, sizeof cost);
        left += !whole;
    }
    assert_true(left > 100 && left < 1900);
}

/* ---- scans */

static unsigned char all[MANY][SURFACE_DESCRIPTOR];
static uint32_t slot[MANY]; /* SURFACE_NOWHERE: it is not there */

static int by_cost(const void *a, const void *b)
{
    const struct search_hit *x = a, *y = b;

    if (x->cost != y->cost)
        return x->cost < y->cost ? -1 : 1;
    return x->slot < y->slot ? -1 : 1;
}

/* The cost of each alone, sorted. */
static size_t brute_scan(const uint16_t *allowed, double floor, size_t most,
                         struct search_hit *out)
{
    size_t n = 0;

    for (size_t i = 0; i < MANY; i++) {
        struct surface_index *x;

        if (slot[i] == SURFACE_NOWHERE ||
            (allowed != NULL && (allowed[slot[i] / 16] >> slot[i] % 16 & 1) == 0))
            continue;
        x = surface_index_new();
        assert_non_null(x);
        assert_int_equal(surface_index_add(x, all[i]), 0);
        if (search_scan(x, &by, NULL, floor, 1, &out[n]) == 1)
            out[n++].slot = slot[i];
        surface_index_free(x);
    }
    qsort(out, n, sizeof *out, by_cost);
    return n < most ? n : most;
}

static void compare(const struct surface_index *x, const uint16_t *allowed, double floor,
                    size_t most)
{
    static struct search_hit got[MANY], wanted[MANY];
    const size_t n = brute_scan(allowed, floor, most, wanted);

    assert_int_equal(search_scan(x, &by, allowed, floor, most, got), n);
    for (size_t i = 0; i < n; i++) {
        assert_int_equal(got[i].cost, wanted[i].cost);
        assert_int_equal(got[i].slot, wanted[i].slot);
    }
}

TEST(test_scan)
{
    static uint16_t allowed[MANY];
    struct surface_index *x = surface_index_new();
    struct search_hit hit;

    assert_non_null(x);
    assert_int_equal(search_scan(x, &by, NULL, -1e6, 1, &hit), 0);
    for (size_t i = 0; i < MANY; i++) {
        draw_descriptor(all[i]);
        if (i % 5 == 4) /* the same once more: the lower slot comes first */
            memcpy(all[i], all[i - 1], sizeof *all);
        assert_true((slot[i] = surface_index_add(x, all[i])) < 2 * MANY);
        allowed[i] = (uint16_t)brute_int(&rng, 0, 65536 - 1);
    }
    for (size_t round = 0; round < 3; round++) {
        compare(x, NULL, -1e6, 1);
        compare(x, NULL, -1e6, 50);
        compare(x, NULL, -60, MANY);
        compare(x, allowed, -1e6, 33);
        for (size_t i = round; i < MANY; i += 3) { /* others take their slots */
            surface_index_remove(x, slot[i]);
            slot[i] = SURFACE_NOWHERE;
        }
        for (size_t i = 0; i < MANY; i += 7)
            if (slot[i] == SURFACE_NOWHERE)
                assert_true((slot[i] = surface_index_add(x, all[i])) < 2 * MANY);
    }
    assert_true(surface_index_bytes(x) > 1000 * sizeof *all);
    surface_index_free(x);
}

void *__real_aligned_alloc(size_t, size_t);
void *__wrap_aligned_alloc(size_t align, size_t size);

static unsigned char *newest; /* the block that was allocated last */
static size_t newest_size;

void *__wrap_aligned_alloc(size_t align, size_t size)
{
    newest_size = size;
    newest = __real_aligned_alloc(align, size);
    return newest;
}

static size_t written(void)
{
    size_t n = 0;

    for (size_t i = 0; i < 256 * sizeof(struct search_block); i++)
        n += newest[i] != 0;
    return n;
}

TEST(test_removed)
{
    unsigned char d[SURFACE_DESCRIPTOR];
    struct surface_index *x = surface_index_new();
    uint32_t at[20];

    assert_non_null(x);
    memset(d, 77, sizeof d);
    d[0] = 3;
    for (int i = 0; i < 20; i++)
        assert_true((at[i] = surface_index_add(x, d)) != SURFACE_NOWHERE);
    assert_true(newest_size >= 256 * sizeof(struct search_block));
    assert_int_equal(written(), 20 * SEARCH_MODES);
    for (int i = 19; i >= 0; i -= 3)
        surface_index_remove(x, at[i]);
    assert_int_equal(written(), 13 * SEARCH_MODES);
    surface_index_free(x);
}

/* A probe for the classes in an index alone finds the same. */
TEST(test_classes)
{
    static struct search_probe few;
    struct surface_index *x = surface_index_new();
    struct search_hit wanted[8], got[8];
    unsigned char d[SURFACE_DESCRIPTOR];
    uint32_t last = 0;

    assert_non_null(x);
    assert_int_equal(search_classes(x), 0);
    for (int i = 0; i < 8; i++) {
        draw_descriptor(d);
        d[0] = i == 7 ? 2 : i % 2 == 0 ? 4 : 6;
        last = surface_index_add(x, d);
    }
    assert_int_equal(search_classes(x), 1 << 2 | 1 << 4 | 1 << 6);
    surface_index_remove(x, last);
    assert_int_equal(search_classes(x), 1 << 4 | 1 << 6);
    memset(&few, 0xff, sizeof few);
    assert_int_equal(search_probe(&basis, &probe, model_default.kinship,
                                  search_classes(x), &scratch, &few),
                     ST_OK);
    assert_int_equal(search_scan(x, &by, NULL, -1e6, 8, wanted), 7);
    assert_int_equal(search_scan(x, &few, NULL, -1e6, 8, got), 7);
    for (int i = 0; i < 7; i++) {
        assert_int_equal(got[i].slot, wanted[i].slot);
        assert_true(fabs(search_score(&few, got[i].cost) -
                         search_score(&by, wanted[i].cost)) < 1e-3);
    }
    surface_index_free(x);
}

TEST(test_refused)
{
    unsigned char d[SURFACE_DESCRIPTOR];
    static struct search_probe p;
    struct surface_index *x = surface_index_new();
    struct encoding e = probe;

    e.n = 0;
    assert_int_equal(search_describe(&basis, &e, &scratch, d), ST_EINVAL);
    assert_int_equal(search_probe(&basis, &e, 0.3, UINT_MAX, &scratch, &p), ST_EINVAL);
    e = probe;
    e.a[0] = -10;
    assert_int_equal(search_describe(&basis, &e, &scratch, d), ST_EINVAL);
    assert_int_equal(search_probe(&basis, &e, 0.3, UINT_MAX, &scratch, &p), ST_EINVAL);
    e = probe;
    e.b[3] = (float)NAN;
    assert_int_equal(search_describe(&basis, &e, &scratch, d), ST_EINVAL);
    assert_int_equal(search_probe(&basis, &e, 0.3, UINT_MAX, &scratch, &p), ST_EINVAL);
    d[0] = SEARCH_CLASSES;
    assert_non_null(x);
    assert_int_equal(surface_index_add(x, d), SURFACE_NOWHERE);
    surface_index_free(x);
}
