/* How much a token, an address and all together may have the daemon hold. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

#include "quota.h"

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
        address[i][0] = i;
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_one),
        cmocka_unit_test(test_all),
        cmocka_unit_test(test_owed),
    };

    return cmocka_run_group_tests_name("quota", tests, NULL, NULL);
}
