/* Allocation: alignment, overflow, and that a failed one changes nothing. */
/* link: -Wl,--wrap=aligned_alloc -Wl,--wrap=free */
#include "fail_alloc.h"
#include "mem.h"
#include "unit.h"

TEST(test_aligned)
{
    for (size_t n = 0; n < 300; n++) {
        unsigned char *p = mem_array(n, 3);

        assert_non_null(p);
        assert_int_equal((uintptr_t)p % 64, 0);
        memset(p, 0xa5, 3 * n);
        mem_free(p);
    }
    mem_free(NULL);
}

TEST(test_overflow)
{
    const size_t half = SIZE_MAX / 2;

    assert_null(mem_array(half + 2, 2));
    assert_null(mem_array(2, half + 2));
    assert_null(mem_array(SIZE_MAX, SIZE_MAX));
    assert_null(mem_array(SIZE_MAX, 1));
    assert_null(mem_array(SIZE_MAX - 63, 1));
    assert_null(mem_array((size_t)1 << 33, (size_t)1 << 33));
}

TEST(test_grow)
{
    unsigned char *p = mem_array(100, 1), *q;

    memset(p, 7, 100);
    q = mem_grow(p, 100, 5000);
    assert_non_null(q);
    for (int i = 0; i < 100; i++)
        assert_int_equal(q[i], 7);
    fail_alloc_at(1);
    assert_null(mem_grow(q, 100, 9000));
    assert_int_equal(q[99], 7);
    fail_alloc_at(0);
    mem_free(q);
    q = mem_grow(NULL, 0, 64);
    assert_non_null(q);
    mem_free(q);
}

/* What is freed is wiped first: here it is looked at just before. */
static const unsigned char *watched;
static bool wiped;

void __real_free(void *p);
void __wrap_free(void *p);
void __wrap_free(void *p)
{
    if (p != NULL && p == watched) {
        wiped = true;
        for (size_t i = 0; i < 10000; i++)
            wiped = wiped && watched[i] == 0;
    }
    __real_free(p);
}

TEST(test_wiped)
{
    struct scratch s = {0};
    unsigned char *p = mem_array(10000, 1);

    watched = memset(p, 7, 10000);
    wiped = false;
    mem_free(p);
    assert_true(wiped);

    watched = memset(p = mem_array(10000, 1), 7, 10000);
    wiped = false;
    p = mem_grow(p, 10000, 20000);
    assert_true(wiped);
    watched = NULL;
    mem_free(p);

    watched =
        memset(scratch_need(&s, 10000), 7, 10000); /* a larger one takes its place */
    wiped = false;
    (void)scratch_need(&s, 20000);
    assert_true(wiped);

    watched = memset(scratch_need(&s, 10000), 7, 10000);
    scratch_wipe(&s, 20000); /* kept */
    for (size_t i = 0; i < 10000; i++)
        assert_int_equal(s.block[i], 0);
    assert_int_equal(s.used, 0);
    (void)scratch_need(&s, 300); /* as far as it was used alone */
    memset(s.block, 7, 1000);
    scratch_wipe(&s, 20000);
    assert_int_equal(s.block[299], 0);
    assert_int_equal(s.block[300], 7);
    (void)scratch_need(&s, 10000);
    wiped = false;
    scratch_wipe(&s, 19999); /* not kept */
    assert_true(wiped);
    assert_null(s.block);
    watched = NULL;
}

TEST(test_scratch)
{
    struct scratch s = {0};
    unsigned char *a = scratch_need(&s, 1000), *b;

    assert_non_null(a);
    assert_int_equal((uintptr_t)a % 64, 0);
    memset(a, 1, 1000);
    fail_alloc_at(0);
    assert_ptr_equal(scratch_need(&s, 1000), a);
    assert_ptr_equal(scratch_need(&s, 1), a);
    assert_ptr_equal(scratch_need(&s, 0), a);
    assert_int_equal(fail_alloc_count(), 0);

    fail_alloc_at(1); /* growing fails: the old block and its bytes stay */
    assert_null(scratch_need(&s, 2000));
    assert_null(scratch_need(&s, SIZE_MAX));
    assert_ptr_equal(s.block, a);
    assert_int_equal(s.size, 1000);
    assert_int_equal(a[999], 1);

    b = scratch_need(&s, 100000);
    assert_non_null(b);
    memset(b, 2, 100000);
    scratch_free(&s);
    assert_null(s.block);
    assert_int_equal(s.size, 0);
    scratch_free(&s);
    assert_non_null(scratch_need(&s, 0)); /* a block even for no bytes */
    scratch_free(&s);
}
