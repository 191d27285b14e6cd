/* Idempotency keys, without HTTP: how the header is parsed, and when the response is replayed:
 * same key and request, another request, another token, while the first is processed, after a
 * day, with a full table, after an erasure.  Also the other fields of headers.h. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include <sodium.h>

#include "headers.h"
#include "idempotency.h"
#include "request.h"

#define DAY_MS (24 * 3600e3)

static void check_key(const char *value, const char *want) /* NULL: bad */
{
    struct request r = {0};

    headers_take(&r, "idempotency-KEY", value);
    assert_int_equal(r.bad_key, want == NULL);
    if (want != NULL)
        assert_string_equal(r.key, want);
}

static void test_key(void **state)
{
    char longest[REQUEST_KEY_MAX + 2];
    struct request r = {0};

    (void)state;
    check_key("8e03978e-40d5", "8e03978e-40d5");
    check_key("\"8e03978e-40d5\"", "8e03978e-40d5");
    check_key(" \"a\" ", "a");
    check_key("a,b;c=1", "a,b;c=1");
    check_key("", NULL);
    check_key(NULL, NULL);
    check_key("\"\"", NULL);
    check_key("\"", NULL);
    check_key("\"a", NULL);
    check_key("a b", NULL);
    check_key("\"a\\\"b\"", NULL);
    check_key("a\tb", NULL);
    check_key("\xc3\xa9", NULL);
    memset(longest, 'k', sizeof longest);
    longest[REQUEST_KEY_MAX + 1] = '\0';
    check_key(longest, NULL);
    longest[REQUEST_KEY_MAX] = '\0';
    check_key(longest, longest);
    headers_take(&r, "Idempotency-Key", "a");
    headers_take(&r, "Idempotency-Key", "a");
    assert_true(r.bad_key);
}

static void check_prefer(const char *first, const char *second, bool minimal)
{
    struct request r = {0};

    headers_take(&r, "Prefer", first);
    if (second != NULL)
        headers_take(&r, "prefer", second);
    assert_int_equal(r.minimal, minimal);
}

static void test_prefer(void **state)
{
    (void)state;
    check_prefer("return=minimal", NULL, true);
    check_prefer("Return = \"minimal\"; foo=bar", NULL, true);
    check_prefer("wait=10, return=minimal", NULL, true);
    check_prefer("respond-async,, return=minimal,x", NULL, true);
    check_prefer("respond-async", "return=minimal", true);
    check_prefer("x=\"a, return=minimal\"", NULL, false);
    check_prefer("return=representation", NULL, false);
    check_prefer("return=representation, return=minimal", NULL, false);
    check_prefer("return=minimal", "return=representation", true);
    check_prefer("return=minimally", NULL, false);
    check_prefer("return", NULL, false);
    check_prefer("return=", NULL, false);
    check_prefer("x;return=minimal", NULL, false);
    check_prefer("returns=minimal", NULL, false);
    check_prefer("", NULL, false);
    check_prefer(", ,\"", NULL, false);
}

static void test_coding(void **state)
{
    struct request r = {0};

    (void)state;
    headers_take(&r, "content-encoding", "gzip");
    assert_int_equal(r.coding, INFLATE_GZIP);
    headers_take(&r, "Content-Encoding", "gzip");
    assert_int_equal(r.coding, INFLATE_OTHER);
    headers_take(&r, "Content-Encoding", "identity");
    assert_int_equal(r.coding, INFLATE_OTHER);
}

/* What became of a request: processed, replayed, or an error. */
enum outcome { DONE, AGAIN, REUSED, BUSY, BAD };

struct ask {
    const char *key, *actor, *target, *body, *capture;
    enum cloudformat format;
    double now_ms;
};

static void make(struct request *r, const struct ask *a)
{
    *r = (struct request){
        .method = REQUEST_POST, .media = REQUEST_SCAN, .format = a->format};
    (void)snprintf(r->key, sizeof r->key, "%s", a->key);
    (void)snprintf(r->actor, sizeof r->actor, "%s", a->actor ? a->actor : "");
    (void)snprintf(r->subject, sizeof r->subject, "alice");
    (void)snprintf(r->capture.header, sizeof r->capture.header, "%s",
                   a->capture ? a->capture : "");
    r->target = strdup(a->target ? a->target : "/t");
    r->body = (unsigned char *)strdup(a->body ? a->body : "body");
    assert_true(r->target != NULL && r->body != NULL);
    r->len = strlen((const char *)r->body);
}

static enum outcome outcome(const struct request *r, bool begun)
{
    if (begun)
        return DONE;
    if (r->response.replayed)
        return AGAIN;
    return r->response.http == 422 ? REUSED : r->response.http == 409 ? BUSY : BAD;
}

/* Sends a request; if it is to be processed, the response is http and the text, and if it is
 * replayed, it must be those. */
static enum outcome ask(struct idempotency *m, const struct ask *a, int http,
                        const char *text)
{
    struct request r;
    uint32_t ticket;
    enum outcome got;

    make(&r, a);
    got = outcome(&r, idempotency_begin(m, &r, a->now_ms, &ticket));
    if (got == DONE) {
        request_respond(&r, http, strdup(text));
        r.response.http = http;
        idempotency_end(m, &r, r.subject, ticket);
    } else if (got == AGAIN) {
        assert_int_equal(r.response.http, http);
        assert_string_equal(r.response.body != NULL ? r.response.body : "", text);
    }
    request_free(&r);
    return got;
}

static void test_again(void **state)
{
    struct idempotency *m = idempotency_new(100);

    (void)state;
    assert_int_equal(ask(m, &(struct ask){.key = "k"}, 201, "one"), DONE);
    assert_int_equal(ask(m, &(struct ask){.key = "k"}, 201, "one"), AGAIN);
    assert_int_equal(ask(m, &(struct ask){.key = "k"}, 201, "one"), AGAIN);
    assert_int_equal(ask(m, &(struct ask){.key = "k", .body = "other"}, 0, ""), REUSED);
    assert_int_equal(ask(m, &(struct ask){.key = "k", .target = "/t?x"}, 0, ""), REUSED);
    assert_int_equal(ask(m, &(struct ask){.key = "k", .format = CLOUDFORMAT_PLY}, 0, ""),
                     REUSED);
    assert_int_equal(ask(m, &(struct ask){.key = "k", .capture = "sig"}, 0, ""), REUSED);
    assert_int_equal(ask(m, &(struct ask){.key = "k", .actor = "b"}, 409, "two"), DONE);
    assert_int_equal(ask(m, &(struct ask){.key = "k", .actor = "b"}, 409, "two"), AGAIN);
    assert_int_equal(ask(m, &(struct ask){.key = "k"}, 201, "one"), AGAIN);
    assert_int_equal(ask(m, &(struct ask){.key = ""}, 201, "no key"), DONE);
    assert_int_equal(ask(m, &(struct ask){.key = ""}, 201, "no key"), DONE);
    /* different actors and keys whose concatenations are equal */
    assert_int_equal(ask(m, &(struct ask){.key = "c", .actor = "ab"}, 201, "x"), DONE);
    assert_int_equal(ask(m, &(struct ask){.key = "bc", .actor = "a"}, 201, "y"), DONE);
    idempotency_free(m);
}

static void test_fault(void **state)
{
    struct idempotency *m = idempotency_new(1);

    (void)state;
    assert_int_equal(ask(m, &(struct ask){.key = "k"}, 503, "later"), DONE);
    assert_int_equal(ask(m, &(struct ask){.key = "k"}, 429, "wait"), DONE);
    assert_int_equal(ask(m, &(struct ask){.key = "k"}, 422, "bad"), DONE);
    assert_int_equal(ask(m, &(struct ask){.key = "k"}, 422, "bad"), AGAIN);
    idempotency_free(m);
}

static void test_time(void **state)
{
    struct idempotency *m = idempotency_new(100);

    (void)state;
    assert_int_equal(ask(m, &(struct ask){.key = "k"}, 201, "one"), DONE);
    assert_int_equal(ask(m, &(struct ask){.key = "k", .now_ms = DAY_MS - 1}, 201, "one"),
                     AGAIN);
    assert_int_equal(ask(m, &(struct ask){.key = "k", .now_ms = DAY_MS}, 201, "two"),
                     DONE);
    assert_int_equal(ask(m, &(struct ask){.key = "k", .now_ms = DAY_MS + 9}, 201, "two"),
                     AGAIN);
    for (int i = 0; i < 2; i++) { /* a signed capture: as long as its nonce, 2 minutes */
        struct ask c = {.key = "c", .capture = "sig", .now_ms = 120000.0 * i};

        assert_int_equal(ask(m, &c, 200, "match"), DONE);
        c.now_ms += 119999;
        assert_int_equal(ask(m, &c, 200, "match"), AGAIN);
    }
    idempotency_free(m);
}

static void test_full(void **state)
{
    struct idempotency *m = idempotency_new(10);
    char key[16];

    (void)state;
    for (int i = 0; i < 1000; i++) {
        (void)snprintf(key, sizeof key, "k%d", i);
        assert_int_equal(ask(m, &(struct ask){.key = key}, 201, key), DONE);
        for (int back = 0; back < 14 && back <= i; back++) {
            (void)snprintf(key, sizeof key, "k%d", i - back);
            if (back < 9)
                assert_int_equal(ask(m, &(struct ask){.key = key}, 201, key), AGAIN);
        }
    }
    assert_int_equal(ask(m, &(struct ask){.key = "k900"}, 201, "x"),
                     DONE); /* forgotten */
    idempotency_free(m);
}

/* A request that takes long does not block others. */
static void test_running(void **state)
{
    struct idempotency *m = idempotency_new(4);
    struct request r, twin;
    uint32_t ticket, none;
    char key[16];

    (void)state;
    make(&r, &(struct ask){.key = "slow"});
    make(&twin, &(struct ask){.key = "slow"});
    assert_true(idempotency_begin(m, &r, 0, &ticket));
    assert_int_equal(outcome(&twin, idempotency_begin(m, &twin, 1, &none)), BUSY);
    assert_int_equal(ask(m, &(struct ask){.key = "slow", .body = "other"}, 0, ""),
                     REUSED);
    for (int i = 0; i < 20; i++) {
        (void)snprintf(key, sizeof key, "k%d", i);
        assert_int_equal(
            ask(m, &(struct ask){.key = key, .now_ms = i * DAY_MS}, 201, "x"), DONE);
    }
    request_respond(&r, 201, strdup("slowly"));
    idempotency_end(m, &r, r.subject, ticket);
    assert_int_equal(ask(m, &(struct ask){.key = "slow"}, 201, "slowly"), AGAIN);
    for (int i = 0; i < 20; i++) {
        (void)snprintf(key, sizeof key, "l%d", i);
        assert_int_equal(ask(m, &(struct ask){.key = key}, 201, "x"), DONE);
        assert_int_equal(ask(m, &(struct ask){.key = key}, 201, "x"), AGAIN);
    }
    request_free(&r);
    request_free(&twin);
    idempotency_free(m);
}

static void test_erase(void **state)
{
    struct idempotency *m = idempotency_new(10);

    (void)state;
    assert_int_equal(ask(m, &(struct ask){.key = "k"}, 201, "of alice"), DONE);
    assert_int_equal(ask(m, &(struct ask){.key = "n"}, 409, "no"), DONE);
    idempotency_erase(m, "bob");
    assert_int_equal(ask(m, &(struct ask){.key = "k"}, 201, "of alice"), AGAIN);
    idempotency_erase(m, "alice");
    assert_int_equal(ask(m, &(struct ask){.key = "k"}, 201, ""), AGAIN);
    assert_int_equal(ask(m, &(struct ask){.key = "n"}, 409, "anew"), DONE);
    idempotency_free(m);
}

/* What was under way when its subject was erased is not kept, nor where the subject is known
 * at the end alone; nor one whose template is gone. */
static void test_erase_running(void **state)
{
    struct idempotency *m = idempotency_new(10);
    struct request r;
    uint32_t ticket;

    (void)state;
    for (int i = 0; i < 2; i++) {
        make(&r, &(struct ask){.key = "k"});
        if (i == 1)
            r.subject[0] = '\0';
        assert_true(idempotency_begin(m, &r, 0, &ticket));
        idempotency_erase(m, "alice");
        request_respond(&r, 200, strdup("of alice"));
        idempotency_end(m, &r, "alice", ticket);
        request_free(&r);
    }
    assert_int_equal(ask(m, &(struct ask){.key = "k"}, 200, "anew"), DONE);
    make(&r, &(struct ask){.key = "k"});
    idempotency_empty(m, &r);
    request_free(&r);
    assert_int_equal(ask(m, &(struct ask){.key = "k"}, 200, ""), AGAIN);
    idempotency_free(m);
}

/* Long responses push out the oldest; the longest are not kept. */
static void test_bytes(void **state)
{
    struct idempotency *m = idempotency_new(100);
    const size_t len = IDEMPOTENCY_BYTES / 8;
    char *text = malloc(len + 2), key[16];

    (void)state;
    assert_non_null(text);
    memset(text, 'x', len + 1);
    text[len + 1] = '\0';
    assert_int_equal(ask(m, &(struct ask){.key = "k"}, 200, text), DONE);
    assert_int_equal(ask(m, &(struct ask){.key = "k"}, 200, text), DONE);
    text[len] = '\0';
    for (int i = 0; i < 9; i++) {
        (void)snprintf(key, sizeof key, "k%d", i);
        assert_int_equal(ask(m, &(struct ask){.key = key}, 200, text), DONE);
    }
    assert_int_equal(ask(m, &(struct ask){.key = "k8"}, 200, text), AGAIN);
    assert_int_equal(ask(m, &(struct ask){.key = "k1"}, 200, text), AGAIN);
    assert_int_equal(ask(m, &(struct ask){.key = "k0"}, 200, text), DONE);
    assert_int_equal(ask(m, &(struct ask){.key = "k1"}, 200, text), DONE);
    free(text);
    idempotency_free(m);
}

static void test_bad(void **state)
{
    struct idempotency *m = idempotency_new(10);
    struct request r;
    uint32_t ticket;

    (void)state;
    make(&r, &(struct ask){.key = "k"});
    r.bad_key = true;
    assert_false(idempotency_begin(m, &r, 0, &ticket));
    assert_int_equal(r.response.http, 400);
    request_free(&r);
    idempotency_free(m);
    idempotency_free(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_key),           cmocka_unit_test(test_prefer),
        cmocka_unit_test(test_coding),        cmocka_unit_test(test_again),
        cmocka_unit_test(test_fault),         cmocka_unit_test(test_time),
        cmocka_unit_test(test_full),          cmocka_unit_test(test_running),
        cmocka_unit_test(test_erase),         cmocka_unit_test(test_bad),
        cmocka_unit_test(test_erase_running), cmocka_unit_test(test_bytes),
    };

    return sodium_init() < 0 ? 1 : cmocka_run_group_tests(tests, NULL, NULL);
}
