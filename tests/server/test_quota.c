/* How much a sender and all together may have the daemon hold. */
#include <malloc.h>

#include "quota.h"
#include "unit.h"

static const struct quota_limits limits = {.all = {100, 1000}, .one = {50, 300}};

static struct quota_share share(struct quota *q, uint64_t sender)
{
    return (struct quota_share){.q = q, .sender = sender};
}

TEST(test_all)
{
    struct quota *q = quota_new(&limits);
    struct quota_share s[40];
    unsigned held = 0;

    for (unsigned char i = 0; i < 40; i++) {
        s[i] = share(q, 1 + 1024 * (uint64_t)i); /* all in one bucket */
        held += quota_hold(&s[i], QUOTA_IS_LARGE, 250);
    }
    assert_int_equal(held, 4);
    assert_true(quota_hold(&s[39], QUOTA_IS_SMALL, 50));
    assert_true(quota_hold(&s[38], QUOTA_IS_SMALL, 50));
    assert_false(quota_hold(&s[37], QUOTA_IS_SMALL, 1));
    for (int i = 0; i < 40; i++)
        assert_true(quota_owe(&s[i], QUOTA_IS_SMALL, 0));
    assert_int_equal(quota_held(q, QUOTA_IS_LARGE), 0);
    quota_free(q);
}

/* Bytes held without a check count for later checks. */
TEST(test_owed)
{
    struct quota *q = quota_new(&limits);
    struct quota_share a = share(q, 1), b = share(q, 1);

    assert_true(quota_owe(&a, QUOTA_IS_LARGE, 350));
    assert_false(quota_hold(&b, QUOTA_IS_LARGE, 1));
    assert_true(quota_hold(&b, QUOTA_IS_SMALL, 1));
    assert_true(quota_hold(&a, QUOTA_IS_LARGE, 340)); /* less than before */
    assert_true(quota_owe(&a, QUOTA_IS_SMALL, 0));
    assert_true(quota_hold(&b, QUOTA_IS_LARGE, 1));
    assert_true(quota_owe(&b, QUOTA_IS_SMALL, 0));
    quota_free(q);
}

/* A share's own bytes of the same size do not count against it. */
TEST(test_instead)
{
    struct quota *q = quota_new(&limits);
    struct quota_share s[4];

    for (unsigned char i = 0; i < 4; i++) {
        s[i] = share(q, i);
        assert_true(quota_hold(&s[i], QUOTA_IS_LARGE, i < 3 ? 250 : 200));
    }
    assert_true(quota_hold(&s[3], QUOTA_IS_LARGE, 250)); /* all that there is */
    assert_false(quota_hold(&s[3], QUOTA_IS_LARGE, 251));
    assert_true(quota_hold(&s[3], QUOTA_IS_SMALL, 50));
    assert_true(quota_hold(&s[2], QUOTA_IS_LARGE, 300));
    assert_true(quota_hold(&s[1], QUOTA_IS_LARGE, 300));
    assert_false(quota_hold(&s[3], QUOTA_IS_LARGE, 151)); /* 850 are held */
    assert_true(quota_hold(&s[0], QUOTA_IS_LARGE, 300));
    assert_true(quota_hold(&s[3], QUOTA_IS_LARGE, 100));
    assert_true(quota_hold(&s[3], QUOTA_IS_SMALL, 50));
    assert_true(quota_hold(&s[0], QUOTA_IS_LARGE, 10));
    assert_false(quota_hold(&s[3], QUOTA_IS_LARGE, 301)); /* its own limit */
    for (int i = 0; i < 4; i++)
        assert_true(quota_owe(&s[i], QUOTA_IS_SMALL, 0));
    quota_free(q);
}

/* Nothing stays of a sender that holds nothing. */
TEST(test_given_back)
{
    struct quota *q = quota_new(&limits);
    size_t before = 0;

    for (unsigned i = 0; i < 3000; i++) {
        struct quota_share s = share(q, i);

        assert_true(quota_fits(&s, QUOTA_IS_LARGE, 300));
        assert_false(quota_fits(&s, QUOTA_IS_LARGE, 301));
        assert_false(quota_hold(&s, QUOTA_IS_LARGE, 301));
        assert_true(quota_hold(&s, QUOTA_IS_LARGE, 300));
        assert_true(quota_hold(&s, QUOTA_IS_SMALL, 0));
        assert_false(quota_hold(&s, QUOTA_IS_LARGE, 301));
        if (i == 1000)
            before = mallinfo2().uordblks;
    }
    assert_in_range(mallinfo2().uordblks, 0,
                    before + 4096); /* 2,000 holders have 100 KB */
    quota_free(q);
}
