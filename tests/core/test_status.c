/* Every code has a message of its own; any other value is "unknown". */
#include "status.h"
#include "unit.h"

TEST(test_messages_distinct)
{
    for (int i = 0; i < ST_COUNT; i++) {
        const char *text = status_message((enum status)i);

        assert_non_null(text);
        assert_string_not_equal(text, "unknown status");
        for (int j = 0; j < i; j++)
            assert_string_not_equal(text, status_message((enum status)j));
    }
}

TEST(test_unknown)
{
    assert_string_equal(status_message(ST_COUNT), "unknown status");
    assert_string_equal(status_message((enum status)(-1)), "unknown status");
    assert_string_equal(status_message((enum status)9999), "unknown status");
}
