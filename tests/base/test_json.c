/* link: -Wl,--wrap=malloc -Wl,--wrap=calloc */
/* JSON written and read: digits, texts, what is rejected, and failed allocations. */
#include "errinfo.h"
#include "fail_alloc.h"
#include "json.h"
#include "unit.h"

/* ---- writing */

static void wrote(struct json *j, const char *want)
{
    char *text = json_compact(j);

    assert_non_null(text);
    assert_string_equal(text, want);
    free(text);
}

static void check_number(void (*write)(struct json *, const char *, double), double value,
                         const char *want)
{
    struct json *j = json_new();
    char text[64];

    write(j, "n", value);
    (void)snprintf(text, sizeof text, "{\"n\":%s}", want);
    wrote(j, text);
}

TEST(test_digits)
{
    check_number(json_number, 0, "0");
    check_number(json_number, -0.00001, "0");
    check_number(json_number, 0.1, "0.1");
    check_number(json_number, 1.0 / 3, "0.3333");
    check_number(json_number, -2.0 / 3, "-0.6667");
    check_number(json_number, 123456.78905, "123456.7891");
    check_number(json_number, 999999999999999, "999999999999999");
    check_number(json_number, 1e300, "1e+300");
    check_number(json_number, (double)NAN, "null");
    check_number(json_number, (double)INFINITY, "null");
    check_number(json_number, -(double)INFINITY, "null");
    check_number(json_extent, 5841.1234, "5841.1");
    check_number(json_extent, 0.04, "0");
    check_number(json_extent, (double)NAN, "null");
    check_number(json_rate, 0, "0");
    check_number(json_rate, 4.0151e-10, "4.02e-10");
    check_number(json_rate, 0.00012345, "0.000123");
    check_number(json_rate, 1, "1");
    check_number(json_rate, (double)NAN, "null");
}

/* Every value of 4 decimals is printed with those, not with 17 digits. */
TEST(test_shortest)
{
    char want[32];

    for (int k = 1; k < 20000; k++) {
        if (k % 10 == 0)
            continue;
        (void)snprintf(want, sizeof want, "%.4f", k / 1e4);
        check_number(json_number, k / 1e4 + 3e-5, want);
        (void)snprintf(want, sizeof want, "%.4f", -1e5 - k / 1e4);
        check_number(json_number, -1e5 - k / 1e4 - 3e-5, want);
    }
}

TEST(test_vectors)
{
    const double normal[3] = {0.6, -0.8, 1e-9};
    const double transform[16] = {1.0 / 3, 0, 0, 1.0 / 3, 0, 1, 0, -2.0 / 3,
                                  0,       0, 1, 12,      0, 0, 0, 1};
    struct json *j = json_new();

    json_direction(j, "normal", normal);
    json_transform(j, "transform", transform);
    wrote(j, "{\"normal\":[0.6,-0.8,0],"
             "\"transform\":[0.3333333,0,0,0.3333,0,1,0,-0.6667,0,0,1,12,0,0,0,1]}");
}

TEST(test_texts)
{
    struct json *j = json_new();

    json_text(j, "a", "\"\\\n\x01 \xc3\xa4");
    json_text(j, "b", NULL);
    json_text(j, "c", "x\xff\xc3\xa4\xed\xa0\x80");
    json_text(j, "d", "");
    json_flag(j, "e", true);
    json_flag(j, "f", false);
    wrote(j, "{\"a\":\"\\\"\\\\\\n\\u0001 \xc3\xa4\",\"b\":null,"
             "\"c\":\"x\xef\xbf\xbd\xc3\xa4\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd\","
             "\"d\":\"\",\"e\":true,\"f\":false}");
}

static struct json *nested(void)
{
    struct json *j = json_new();

    json_array(j, "list");
    json_object(j, NULL);
    json_number(j, "x", 1);
    json_close(j);
    json_object(j, NULL);
    json_close(j);
    json_close(j);
    json_text(j, "last", "it");
    json_object(j, "open"); /* is closed at the end */
    json_text(j, "y", "z\xff");
    json_rate(j, "r", 0.5);
    return j;
}

TEST(test_nesting)
{
    char *text;
    struct json *j;

    wrote(nested(), "{\"list\":[{\"x\":1},{}],\"last\":\"it\","
                    "\"open\":{\"y\":\"z\xef\xbf\xbd\",\"r\":0.5}}");
    text = json_pretty(nested());
    assert_non_null(text);
    assert_non_null(strstr(text, "\n\t\"last\":\t\"it\",\n"));
    free(text);
    j = json_new();
    json_close(j); /* the outermost stays open */
    for (int i = 1; i < JSON_DEPTH; i++)
        json_array(j, i == 1 ? "a" : NULL);
    text = json_compact(j);
    assert_non_null(text);
    free(text);
    j = json_new();
    for (int i = 1; i <= JSON_DEPTH; i++)
        json_array(j, i == 1 ? "a" : NULL);
    assert_null(json_compact(j));
}

TEST(test_write_memory)
{
    unsigned long n = 0;
    char *text;

    do {
        fail_alloc_at(++n);
        text = json_compact(nested());
        assert_true((text == NULL) == (fail_alloc_count() >= n));
    } while (text == NULL);
    assert_true(n > 20);
    free(text);
    fail_alloc_at(0);
    assert_null(json_compact(NULL));
    json_discard(NULL);
    json_discard(nested());
}

/* ---- reading */

static struct json_value *doc;
static struct errinfo e;

static enum status read_text(const char *text, size_t max_values)
{
    json_free(doc);
    e = (struct errinfo){ST_OK, ""};
    return json_read(text, strlen(text), max_values, &doc, &e);
}

static void bad(const char *text, const char *why)
{
    assert_int_equal(read_text(text, 1000), ST_EINVAL);
    assert_null(doc);
    assert_int_equal(e.code, ST_EINVAL);
    assert_string_equal(e.msg, why);
}

TEST(test_refused)
{
    char deep[JSON_DEPTH + 2] = "", many[600] = "{";

    bad("", "the document is empty");
    bad("{\"a\":\"\xff\"}", "not UTF-8 at byte 6");
    bad("[1,2", "not valid JSON: it ends too early");
    bad("\"\\", "not valid JSON at byte 1");
    bad("[1 2]", "not valid JSON at byte 3");
    bad("{} {}", "not valid JSON at byte 3");
    bad("[01]", "not valid JSON at byte 1");
    bad("[1,-01.5]", "not valid JSON at byte 3");
    bad("[1,2.]", "not valid JSON at byte 3");
    bad("[2.e1]", "not valid JSON at byte 1");
    bad("[-.5]", "not valid JSON at byte 1");
    bad("[+1]", "not valid JSON at byte 1");
    bad("-", "not valid JSON at byte 0");
    bad("[\"\\u0000\"]", "\\u0000 cannot be in a text");
    bad("[\"a\nb\"]", "a control character in a text at byte 3");
    assert_int_equal(json_read("[1]\0[2]", 7, 9, &doc, &e), ST_EINVAL);
    assert_string_equal(e.msg, "not valid JSON at byte 3");
    bad("{\"a\":1,\"b\":2,\"a\":3}", "an object has two members named \"a\"");
    bad("{\"a\":{\"b\":[0,{\"c\":1,\"c\":1}]}}", "an object has two members named \"c\"");
    memset(deep, '[', JSON_DEPTH + 1);
    bad(deep, "deeper than 16 at byte 16");
    for (size_t i = 0, n = 1; i <= JSON_MEMBERS; i++)
        n += (size_t)snprintf(many + n, sizeof many - n, "\"k%zu\":0%s", i,
                              i < JSON_MEMBERS ? "," : "}");
    bad(many, "an object has more than 32 members");
    /* Brackets and commas within texts do not count towards the limits. */
    assert_int_equal(read_text("[\"\\\\u0000 [[[[[[[[[[[[[[[[[[,,,, \\\" \"]", 2), ST_OK);
    assert_int_equal(read_text("[[1],[2]]", 5), ST_OK);
    assert_int_equal(read_text("[[1],[2]]", 4), ST_ELIMIT);
    assert_string_equal(e.msg, "more than 4 values");
}

TEST(test_values)
{
    const struct json_value *v;
    uint64_t count;
    double number;
    bool flag;
    char text[4];

    assert_int_equal(read_text("{\"t\":\"abc\",\"f\":true,\"n\":null,\"c\":7,\"m\":-1,"
                               "\"h\":0.5,\"p\":[1,2.5,-3],\"i\":[1,1e999,2],\"o\":{}}",
                               100),
                     ST_OK);
    assert_true(!json_is_array(doc) && !json_is_null(doc));
    assert_string_equal(json_get_text(json_member(doc, "t")), "abc");
    assert_true(json_copy_text(json_member(doc, "t"), text, 4));
    assert_string_equal(text, "abc");
    assert_false(json_copy_text(json_member(doc, "t"), text, 3));
    assert_false(json_copy_text(json_member(doc, "T"), text, 4));
    assert_null(json_get_text(json_member(doc, "c")));
    assert_true(json_get_flag(json_member(doc, "f"), &flag) && flag);
    assert_false(json_get_flag(json_member(doc, "c"), &flag));
    assert_false(json_get_flag(NULL, &flag));
    assert_true(json_is_null(json_member(doc, "n")));
    assert_false(json_is_null(NULL));
    assert_true(json_get_count(json_member(doc, "c"), &count) && count == 7);
    assert_false(json_get_count(json_member(doc, "m"), &count));
    assert_false(json_get_count(json_member(doc, "h"), &count));
    assert_false(json_get_count(json_member(doc, "t"), &count));
    assert_false(json_get_count(NULL, &count));
    assert_true(json_get_number(json_member(doc, "c"), &number) && number == 7);
    assert_true(json_get_number(json_member(doc, "h"), &number) && number == 0.5);
    assert_false(json_get_number(json_member(doc, "t"), &number));
    assert_false(json_get_number(NULL, &number));
    assert_int_equal(json_count(json_member(doc, "p")), 3);
    assert_int_equal(json_count(json_member(doc, "o")), 0);
    assert_int_equal(json_count(doc), 9);
    assert_int_equal(json_count(NULL), 0);
    v = json_first(doc);
    assert_string_equal(json_get_text(v), "abc");
    assert_true(json_get_flag(json_next(v), &flag));
    assert_null(json_first(json_member(doc, "o")));
    assert_null(json_first(NULL));
    assert_null(json_next(json_member(doc, "o")));
    assert_null(json_member(json_member(doc, "p"), "t"));
    json_free(doc);
    doc = NULL;
}

TEST(test_expect)
{
    static const char *const two[] = {"a", "b", NULL}, *const three[] = {"a", "b", "c",
                                                                         NULL};
    char key[80] = "{\"";

    assert_int_equal(read_text("{\"a\":1,\"b\":{\"c\":1}}", 100), ST_OK);
    assert_int_equal(json_expect(doc, "it", two, &e), ST_OK);
    assert_int_equal(json_expect(json_member(doc, "b"), "it", two, &e), ST_EINVAL);
    assert_string_equal(e.msg, "it: unknown member \"c\"; allowed: a and b");
    assert_int_equal(json_expect(json_member(doc, "a"), "it", two, &e), ST_EINVAL);
    assert_string_equal(e.msg, "it is not an object");
    assert_int_equal(json_expect(NULL, "it", two, &e), ST_EINVAL);
    memset(key + 2, 'x', 63);
    strcat(key, "\xc3\xa4\":1}"); /* the 64th byte is the first of a character */
    assert_int_equal(read_text(key, 100), ST_OK);
    assert_int_equal(json_expect(doc, "it", three, &e), ST_EINVAL);
    assert_int_equal(strlen(e.msg),
                     strlen("it: unknown member \"\"; allowed: a, b and c") + 63);
}

TEST(test_read_memory)
{
    unsigned long n = 0;
    enum status st;

    do {
        fail_alloc_at(++n);
        st = read_text("{\"a\":[1,2],\"b\":\"text\"}", 100);
        assert_int_equal(st, fail_alloc_count() >= n ? ST_ENOMEM : ST_OK);
        assert_true((doc == NULL) == (st != ST_OK));
    } while (st != ST_OK);
    assert_true(n > 7);
    fail_alloc_at(0);
    bad("[", "not valid JSON: it ends too early");
}
