#include <string.h>

#include "errinfo.h"
#include "groups.h"
#include "unit.h"

#define LONG "0123456789abcdefghijklmnopqrstuvwxyz.-_0123456789abcdefghijklmno" /* 64 */

static const char *list_of(const char *text)
{
    static char out[GROUPS_SIZE];
    static struct errinfo e;

    return groups_read(text, out, &e) == ST_OK ? out : e.msg;
}

TEST(test_read)
{
    static const char *const bad[] = {"A",    "a b",      ",",   "a,", ",a",
                                      "a,,b", "\xc3\xa4", "a/b", " a"};

    assert_string_equal(list_of(""), "");
    assert_string_equal(list_of("b"), "b");
    assert_string_equal(list_of("b,a,b,ab,a.b"), "a,a.b,ab,b");
    assert_string_equal(list_of(LONG), LONG);
    assert_string_equal(list_of("h,g,f,e,d,c,b,a"), "a,b,c,d,e,f,g,h");
    assert_string_equal(list_of("h,g,f,e,d,c,b,a,a"), "a,b,c,d,e,f,g,h");
    assert_string_equal(list_of("h,g,f,e,d,c,b,a,i"), "more than 8 groups");
    assert_non_null(strstr(list_of(LONG "x"), "a group is 1 to 64 characters"));
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char out[GROUPS_SIZE];

        assert_int_equal(groups_read(bad[i], out, NULL), ST_EINVAL);
        assert_false(groups_valid(bad[i]));
    }
}

/* Eight of the longest labels fill a list. */
TEST(test_longest)
{
    char text[GROUPS_SIZE + 2], out[GROUPS_SIZE] = "", label[GROUPS_LABEL + 1] = LONG;

    for (char c = 'a'; c <= 'h'; c++) {
        label[63] = c;
        assert_int_equal(groups_add(out, label, NULL), ST_OK);
    }
    assert_int_equal(strlen(out), GROUPS_SIZE - 1);
    assert_true(groups_valid(out));
    (void)snprintf(text, sizeof text, "%s,", out);
    assert_false(groups_valid(text));
    assert_int_equal(groups_add(out, "x", NULL), ST_EINVAL);
    assert_int_equal(groups_add(out, label, NULL), ST_OK);
    assert_int_equal(strlen(out), GROUPS_SIZE - 1);
}

TEST(test_valid)
{
    assert_true(groups_valid(""));
    assert_true(groups_valid("a,b"));
    assert_false(groups_valid("b,a"));
    assert_false(groups_valid("a,a"));
    assert_true(groups_label("door-3"));
    assert_false(groups_label(""));
    assert_false(groups_label("a,b"));
}

/* A token that is not bound sees and gives everything, a bound one nothing beyond its groups. */
TEST(test_bound)
{
    static const struct {
        const char *bound, *list;
        bool meet, within;
        const char *common;
    } row[] = {
        {"", "", true, true, ""},         {"", "a,b", true, true, "a,b"},
        {"a", "", false, false, ""},      {"a", "a", true, true, "a"},
        {"a", "ab", false, false, ""},    {"ab", "a,b", false, false, ""},
        {"a,c", "a,b", true, false, "a"}, {"a,b,c", "a,c", true, true, "a,c"},
        {"b", "a,c", false, false, ""},
    };

    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        char out[GROUPS_SIZE];

        assert_int_equal(groups_meet(row[i].bound, row[i].list), row[i].meet);
        assert_int_equal(groups_within(row[i].bound, row[i].list), row[i].within);
        groups_common(row[i].bound, row[i].list, out);
        assert_string_equal(out, row[i].common);
    }
}

/* The groups of others stay. */
TEST(test_replace)
{
    static const struct {
        const char *bound, *list, *with, *out;
    } row[] = {
        {"", "a,b", "c", "c"},      {"", "a,b", "", ""},
        {"a,b", "a,x", "b", "b,x"}, {"a", "a,x,y", "a", "a,x,y"},
        {"a,b", "a,b", "a", "a"},
    };
    char out[GROUPS_SIZE];

    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        assert_int_equal(
            groups_replace(row[i].bound, row[i].list, row[i].with, out, NULL), ST_OK);
        assert_string_equal(out, row[i].out);
    }
    assert_int_equal(groups_replace("a,b", "a,1,2,3,4,5,6,7", "a,b", out, NULL),
                     ST_EINVAL);
}
