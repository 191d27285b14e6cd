/* link: -Wl,--wrap=malloc -Wl,--wrap=calloc -Wl,--wrap=aligned_alloc */
/* Points read in one pass: the same values, messages and places in them as those of a
 * document that is read with a value for each number. */
#include "errinfo.h"
#include "fail_alloc.h"
#include "json.h"
#include "unit.h"
#include "vec.h"

#define MOST 1000

typedef enum status read_function(const char *, size_t, size_t, struct json_value **,
                                  struct errinfo *);

static struct dvec3 points[MOST], others[MOST];

/* Reads the array at the end of a path of members, "" the document; returns what
 * json_get_points() does. */
static enum status get(const struct json_value *v, const char *path, struct dvec3 *out,
                       size_t *n)
{
    char key[8];

    for (; *path != '\0'; path++) {
        key[0] = *path;
        key[1] = '\0';
        v = json_member(v, key);
    }
    assert_true(json_count(v) <= MOST);
    return json_get_points(v, out, n);
}

/* The array at path has want points, then something for which st is the status, read in
 * either way. */
static void check(const char *text, const char *path, size_t count, size_t want,
                  enum status st)
{
    read_function *const read[] = {json_read_points, json_read};

    for (int i = 0; i < 2; i++) {
        struct json_value *doc;
        struct errinfo e = {0};
        size_t n;

        assert_int_equal(read[i](text, strlen(text), 4 * MOST, &doc, &e), ST_OK);
        assert_int_equal(get(doc, path, i == 0 ? points : others, &n), st);
        assert_int_equal(n, want);
        if (path[0] == '\0')
            assert_int_equal(json_count(doc), count);
        json_free(doc);
    }
    assert_memory_equal(points, others, want * sizeof *points);
}

TEST(test_values)
{
    check("[]", "", 0, 0, ST_OK);
    check("[[1,2,3]]", "", 1, 1, ST_OK);
    check(" [ [ 1 ,\t2.5,-3e-1 ]\r\n, [0,-0,1E2] , [0.1,1e-400,12.345600128173828]\n] ",
          "", 3, 3, ST_OK);
    assert_true(points[0].x == 1 && points[0].y == 2.5 && points[0].z == -0.3);
    assert_true(points[1].x == 0 && signbit(points[1].y) && points[1].z == 100);
    assert_true(points[2].z == 12.345600128173828);
    check("[1,2,3]", "", 3, 0, ST_EINVAL);
    check("[[1,2]]", "", 1, 0, ST_EINVAL);
    check("[[1,2,3],[1,2,3,4],[1,2,3]]", "", 3, 1, ST_EINVAL);
    check("[[1,2,3],[4,5,6],[1,2,\"3\"]]", "", 3, 2, ST_EINVAL);
    check("[[1,2,3],[4,5,6],7]", "", 3, 2, ST_EINVAL);
    check("[[1,2,3],[4,5,6],{}]", "", 3, 2, ST_EINVAL);
    check("[[1,2,3],[4,5,6],[]]", "", 3, 2, ST_EINVAL);
    check("[[1,2,3],[4,5,6],[1,-1e999,2]]", "", 3, 2, ST_ENOTFINITE);
    check("{}", "", 0, 0, ST_EINVAL);
    check("7", "", 0, 0, ST_EINVAL);
}

/* The array that has points is found among others, whatever is in texts and names. */
TEST(test_places)
{
    check("{\"u\":\"[[1,2,3]]\",\"p\":[[1,2,3],[4,5,6]]}", "p", 0, 2, ST_OK);
    check("{\"u\":[1,[2],{\"v\":[]}],\"[\":[\"\\\"[\"],\"p\":[[1,2,3],[4,5,6]]}", "p", 0,
          2, ST_OK);
    check("{\"a\":{\"p\":[[1,2,3]]},\"b\":{\"p\":[[4,5,6],[7,8,9]]}}", "ap", 0, 1, ST_OK);
    assert_true(points[0].x == 1);
    check("{\"a\":{\"p\":[[1,2,3]]},\"b\":{\"p\":[[4,5,6],[7,8,9]]}}", "bp", 0, 2, ST_OK);
    assert_true(points[0].x == 4 && points[1].z == 9);
    check("{\"a\":[[1,2,3],[4,5,6],[[7]]],\"b\":[[8,8,8]],\"c\":[[9,9,9],[9,9,9]]}", "a",
          0, 2, ST_EINVAL);
    check("{\"a\":[[1,2,3],[4,5,6],[[7]]],\"b\":[[8,8,8]],\"c\":[[9,9,9],[9,9,9]]}", "b",
          0, 1, ST_OK);
    check("{\"a\":[[1,2,3],[4,5,6],[[7]]],\"b\":[[8,8,8]],\"c\":[[9,9,9],[9,9,9]]}", "c",
          0, 2, ST_OK);
    check("{\"\\u0070\":[[1,2,3],[4,5,6]]}", "p", 0, 2, ST_OK);
}

static void bad(const char *text, enum status st, const char *why)
{
    read_function *const read[] = {json_read_points, json_read};

    for (int i = 0; i < 2; i++) {
        struct json_value *doc;
        struct errinfo e = {0};

        assert_int_equal(read[i](text, strlen(text), 36, &doc, &e), st);
        assert_string_equal(e.msg, why);
        assert_null(doc);
    }
}

TEST(test_refused)
{
    bad("[[1,2,3],[4,5,6],]", ST_EINVAL, "not valid JSON at byte 17");
    bad("[[1,2,3],[4,5,6] [7,8,9]]", ST_EINVAL, "not valid JSON at byte 17");
    bad("[[1,2,3],[4,5,6],[7,8 9]]", ST_EINVAL, "not valid JSON at byte 22");
    bad("[[1,2,3],[4,5,6],[7,8,09]]", ST_EINVAL, "not valid JSON at byte 22");
    bad("[[1,2,3],[4,5,6],[7,8,NaN]]", ST_EINVAL,
        "not valid JSON at byte 22: NaN is no number of JSON");
    bad("[[1,2,3],[4,5,6],[7,8,-Infinity]]", ST_EINVAL,
        "not valid JSON at byte 22: Infinity is no number of JSON");
    bad("[[1,2,3],[4,5,6]}", ST_EINVAL, "not valid JSON at byte 16");
    bad("[[1,2,3],[4,5,6]", ST_EINVAL, "not valid JSON: it ends too early");
    bad("[[1,2,3],[4,5,6],", ST_EINVAL, "not valid JSON: it ends too early");
    bad("[[1,2,3],[4,5", ST_EINVAL, "not valid JSON: it ends too early");
    bad("{[[1,2,3],[4,5,6]]}", ST_EINVAL, "not valid JSON at byte 2");
    bad("[[1,2,3],[4,5,6]] []", ST_EINVAL, "not valid JSON at byte 18");
    bad("{\"a\":[[1,2,3],[4,5,6]],\"b\":[[1,2,3],[4,5,6]],,}", ST_EINVAL,
        "not valid JSON at byte 46");
    bad("{\"a\":[[1,2,3],[4,5,6]],\"b\":[[1,2,3],[4,5,6]],\"a\":1}", ST_EINVAL,
        "an object has two members named \"a\"");
    bad("{\"a\":[[1,2,3],[4,5,6],{\"c\":1,\"c\":1}]}", ST_EINVAL,
        "an object has two members named \"c\"");
    bad("[[[[[[[[[[[[[[[[[1,2,3]]]]]]]]]]]]]]]]]", ST_EINVAL,
        "deeper than 16 at byte 16");
    check("[[1,2,3],[1,2,3],[1,2,3],[1,2,3],[1,2,3],[1,2,3],[1,2,3],[1,2,3],[1,2,3]]", "",
          9, 9, ST_OK);
    bad("[[1,2,3],[1,2,3],[1,2,3],[1,2,3],[1,2,3],[1,2,3],[1,2,3],[1,2,3],[1,2,3],7]",
        ST_ELIMIT, "more than 36 values");
    bad("[[1,2,3],[1,2,3],[1,2,3],[1,2,3],[1,2,3],[1,2,3],[1,2,3],[1,2,3],[1,2,3],[1,2,3]]",
        ST_ELIMIT, "more than 36 values");
}

/* A number of any length, which the library would refuse beyond 63 characters. */
TEST(test_long_number)
{
    char text[500];
    struct json_value *doc;
    struct errinfo e;
    size_t n;

    (void)snprintf(text, sizeof text, "[[0.1%0400d,-2,3]]", 1);
    assert_int_equal(json_read_points(text, strlen(text), MOST, &doc, &e), ST_OK);
    assert_int_equal(get(doc, "", points, &n), ST_OK);
    assert_true(n == 1 && points[0].x == 0.1 && points[0].y == -2);
    json_free(doc);
}

/* Clouds need no value for each number: some bytes a point in all. */
TEST(test_memory)
{
    char *text = malloc(60000);
    struct json_value *doc;
    struct errinfo e;
    size_t len = 0, n;
    unsigned long failing = 0;
    enum status st;

    assert_non_null(text);
    len += (size_t)sprintf(text + len, "{\"p\":[");
    for (int i = 0; i < MOST; i++)
        len +=
            (size_t)sprintf(text + len, "%s[%d,-%d,%d]", i > 0 ? "," : "", i, i, i % 9);
    len += (size_t)sprintf(text + len, "]}");
    fail_alloc_at(0);
    assert_int_equal(json_read_points(text, len, 4 * MOST + 2, &doc, &e), ST_OK);
    assert_true(fail_alloc_bytes() < 100 * MOST);
    assert_int_equal(get(doc, "p", points, &n), ST_OK);
    assert_true(n == MOST && points[999].x == 999 && points[10].y == -10);
    json_free(doc);
    do {
        fail_alloc_at(++failing);
        st = json_read_points(text, len, 4 * MOST + 2, &doc, &e);
        assert_int_equal(st, fail_alloc_count() >= failing ? ST_ENOMEM : ST_OK);
        assert_true((doc == NULL) == (st != ST_OK));
    } while (st != ST_OK);
    assert_true(failing > 5);
    fail_alloc_at(0);
    json_free(doc);
    free(text);
}
