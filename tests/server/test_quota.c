/* How much a token, an address and all together may have the daemon hold. */
#include <malloc.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h>

#include "quota.h"
#include "rows_types.h"

static const struct quota_limits limits = {.all = {100, 1000}, .one = {50, 300}};
static unsigned char home[THROTTLE_ADDRESS] = {127, 0, 0, 1},
                     away[THROTTLE_ADDRESS] = {9};

static struct quota_share share(struct quota *q, const char *token,
                                const unsigned char *address)
{
    return (struct quota_share){.q = q, .token = token, .address = address};
}

static void test_one(void **state)
{
    struct quota *q = quota_new(&limits);
    struct quota_share a = share(q, "a", home), b = share(q, "b", away),
                       same = share(q, "a", away), near = share(q, "c", home);

    (void)state;
    assert_true(quota_hold(&a, QUOTA_IS_LARGE, 200));
    assert_false(quota_hold(&a, QUOTA_IS_LARGE, 301));
    assert_false(quota_fits(&a, QUOTA_IS_LARGE, 301));
    assert_true(quota_fits(&a, QUOTA_IS_LARGE, 300));
    assert_false(quota_fits(&same, QUOTA_IS_LARGE, 101));
    assert_true(quota_fits(&same, QUOTA_IS_LARGE, 100));
    assert_int_equal(quota_held(q, QUOTA_IS_LARGE), 200);
    assert_int_equal(a.bytes, 200); /* as before */
    assert_true(quota_hold(&a, QUOTA_IS_LARGE, 300));
    assert_false(quota_hold(&same, QUOTA_IS_LARGE, 1)); /* the token's are held */
    assert_false(quota_hold(&near, QUOTA_IS_LARGE, 1)); /* the address's are */
    assert_true(quota_hold(&b, QUOTA_IS_LARGE, 300));
    assert_true(quota_hold(&near, QUOTA_IS_SMALL, 50));  /* with room of its own */
    assert_true(quota_hold(&a, QUOTA_IS_LARGE, 100));    /* less */
    assert_true(quota_hold(&near, QUOTA_IS_LARGE, 200)); /* instead of the small */
    assert_int_equal(quota_held(q, QUOTA_IS_SMALL), 0);
    assert_int_equal(quota_held(q, QUOTA_IS_LARGE), 600);
    assert_true(quota_hold(&a, QUOTA_IS_LARGE, 0));
    assert_true(quota_hold(&b, QUOTA_IS_LARGE, 0));
    assert_true(quota_hold(&near, QUOTA_IS_LARGE, 0));
    assert_int_equal(quota_held(q, QUOTA_IS_LARGE), 0);
    quota_free(q);
}

static void test_all(void **state)
{
    struct quota *q = quota_new(&limits);
    struct quota_share s[40];
    unsigned char address[40][THROTTLE_ADDRESS] = {{0}};
    unsigned held = 0;

    (void)state;
    for (unsigned char i = 0; i < 40; i++) {
        address[i][THROTTLE_ADDRESS - 1] = i;
        s[i] = share(q, "", address[i]); /* without tokens */
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

/* What is held without asking keeps out what asks. */
static void test_owed(void **state)
{
    struct quota *q = quota_new(&limits);
    struct quota_share a = share(q, "a", home), b = share(q, "a", home);

    (void)state;
    assert_true(quota_owe(&a, QUOTA_IS_LARGE, 5000));
    assert_false(quota_hold(&b, QUOTA_IS_LARGE, 1));
    assert_true(quota_hold(&b, QUOTA_IS_SMALL, 1));
    assert_true(quota_hold(&a, QUOTA_IS_LARGE, 4000)); /* less than before */
    assert_true(quota_owe(&a, QUOTA_IS_SMALL, 0));
    assert_true(quota_hold(&b, QUOTA_IS_LARGE, 1));
    assert_true(quota_owe(&b, QUOTA_IS_SMALL, 0));
    quota_free(q);
}

/* What a share has already does not count against what it asks for, but only of the same size. */
static void test_instead(void **state)
{
    struct quota *q = quota_new(&limits);
    struct quota_share s[4];
    unsigned char address[4][THROTTLE_ADDRESS] = {{0}};

    (void)state;
    for (unsigned char i = 0; i < 4; i++) {
        address[i][0] = i;
        s[i] = share(q, "", address[i]);
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

/* Nothing stays of a token or an address that holds nothing. */
static void test_given_back(void **state)
{
    struct quota *q = quota_new(&limits);
    unsigned char address[THROTTLE_ADDRESS] = {0};
    size_t before = 0;

    (void)state;
    for (unsigned i = 0; i < 3000; i++) {
        char token[STORE_ID_LEN + 1];
        struct quota_share s;

        (void)snprintf(token, sizeof token, "%u", i);
        memcpy(address, &i, sizeof i);
        s = share(q, token, address);
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_one),        cmocka_unit_test(test_all),
        cmocka_unit_test(test_owed),       cmocka_unit_test(test_instead),
        cmocka_unit_test(test_given_back),
    };

    return cmocka_run_group_tests_name("quota", tests, NULL, NULL);
}
