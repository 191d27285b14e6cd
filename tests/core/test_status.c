/* Every code has a message of its own; any other value is "unknown". */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

#include "status.h"

static void test_messages_distinct(void **state)
{
    (void)state;
    for (int i = 0; i < ST_COUNT; i++) {
        const char *text = status_message((enum status)i);

        assert_non_null(text);
        assert_string_not_equal(text, "unknown status");
        for (int j = 0; j < i; j++)
            assert_string_not_equal(text, status_message((enum status)j));
    }
}

static void test_unknown(void **state)
{
    (void)state;
    assert_string_equal(status_message(ST_COUNT), "unknown status");
    assert_string_equal(status_message((enum status)(-1)), "unknown status");
    assert_string_equal(status_message((enum status)9999), "unknown status");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_messages_distinct),
        cmocka_unit_test(test_unknown),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
