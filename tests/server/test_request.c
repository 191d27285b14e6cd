/* Requests without HTTP: percent-encoding, query parameters, media types, ids, the routes,
 * and the map from outcomes to HTTP. */
#include "errmap.h"
#include "openapi_json.h"
#include "request.h"
#include "dry_run.h"
#include "route.h"
#include "routes.h"
#include "unit.h"

static void check_decode(const char *in, enum status st, const char *want)
{
    char out[8];

    assert_int_equal(request_decode(in, strlen(in), true, out, sizeof out), st);
    if (st == ST_OK)
        assert_string_equal(out, want);
}

TEST(test_decode)
{
    char out[8];

    check_decode("", ST_OK, "");
    check_decode("abc", ST_OK, "abc");
    check_decode("a+b", ST_OK, "a b");
    check_decode("%41%2f%2F", ST_OK, "A//");
    check_decode("%ff", ST_OK, "\xff");
    check_decode("1234567", ST_OK, "1234567");
    check_decode("12345678", ST_ELIMIT, NULL);
    check_decode("123456%37", ST_OK, "1234567");
    check_decode("%", ST_EINVAL, NULL);
    check_decode("%4", ST_EINVAL, NULL);
    check_decode("a%4", ST_EINVAL, NULL);
    check_decode("%4g", ST_EINVAL, NULL);
    check_decode("%%41", ST_EINVAL, NULL);
    check_decode("%00", ST_EINVAL, NULL);
    assert_int_equal(request_decode("a+b%20c", 3, false, out, sizeof out), ST_OK);
    assert_string_equal(out, "a+b");
    assert_int_equal(request_decode("%41", 2, false, out, sizeof out), ST_EINVAL);
}

static void check_query(const char *target, const char *name, enum status st,
                        const char *want)
{
    char copy[64], out[16];
    struct request r = {.target = copy};

    (void)snprintf(copy, sizeof copy, "%s", target);
    assert_int_equal(request_query(&r, name, out, sizeof out), st);
    assert_string_equal(out, want);
}

TEST(test_query)
{
    check_query("/p", "a", ST_ENOTFOUND, "");
    check_query("/p?", "a", ST_ENOTFOUND, "");
    check_query("/p?a", "a", ST_OK, "");
    check_query("/p?a=", "a", ST_OK, "");
    check_query("/p?a=1", "a", ST_OK, "1");
    check_query("/p?b=2&a=1", "a", ST_OK, "1");
    check_query("/p?a=1&a=2", "a", ST_OK, "1");
    check_query("/p?aa=1&ba=2&&=3&a=4", "a", ST_OK, "4");
    check_query("/p?a=1=2", "a", ST_OK, "1=2");
    check_query("/p?a=%26b", "a", ST_OK, "&b");
    check_query("/p?x=?a=1", "a", ST_ENOTFOUND, "");
    check_query("/p?a=%", "a", ST_EINVAL, "");
}

static void check_media(const char *type, enum request_media want,
                        enum cloudformat format)
{
    enum cloudformat got = CLOUDFORMAT_COUNT;

    assert_int_equal(request_media(type, &got), want);
    assert_int_equal(got, format);
}

TEST(test_media)
{
    check_media(NULL, REQUEST_NO_MEDIA, CLOUDFORMAT_ANY);
    check_media("", REQUEST_OTHER_MEDIA, CLOUDFORMAT_ANY);
    check_media("application/json", REQUEST_JSON, CLOUDFORMAT_JSON);
    check_media(" Application/JSON;charset=utf-8", REQUEST_JSON, CLOUDFORMAT_JSON);
    check_media("application/json ", REQUEST_JSON, CLOUDFORMAT_JSON);
    check_media("application/jsonx", REQUEST_OTHER_MEDIA, CLOUDFORMAT_ANY);
    check_media("application/jso", REQUEST_OTHER_MEDIA, CLOUDFORMAT_ANY);
    check_media("application/merge-patch+json", REQUEST_MERGE, CLOUDFORMAT_ANY);
    check_media("model/ply", REQUEST_SCAN, CLOUDFORMAT_PLY);
    check_media("model/x-ply", REQUEST_SCAN, CLOUDFORMAT_PLY);
    check_media("application/x-ply", REQUEST_SCAN, CLOUDFORMAT_PLY);
    check_media("model/obj", REQUEST_SCAN, CLOUDFORMAT_OBJ);
    check_media("model/stl", REQUEST_SCAN, CLOUDFORMAT_STL);
    check_media("model/gltf-binary", REQUEST_SCAN, CLOUDFORMAT_GLB);
    check_media("text/csv; header=present", REQUEST_SCAN, CLOUDFORMAT_XYZ);
    check_media("image/png", REQUEST_SCAN, CLOUDFORMAT_PNG);
    check_media("image/x-portable-graymap", REQUEST_SCAN, CLOUDFORMAT_PGM);
    check_media("model/vrml", REQUEST_SCAN, CLOUDFORMAT_VRML);
    check_media("text/plain", REQUEST_SCAN, CLOUDFORMAT_ANY);
    check_media("application/octet-stream", REQUEST_SCAN, CLOUDFORMAT_ANY);
    check_media("application/x-www-form-urlencoded", REQUEST_SCAN, CLOUDFORMAT_ANY);
    check_media("image/jpeg", REQUEST_OTHER_MEDIA, CLOUDFORMAT_ANY);
}

static void check_route(enum request_method m, const char *target, const char *pattern,
                        int http)
{
    char copy[256];
    struct request r = {.target = copy, .method = m};
    size_t n;
    const struct route *table = routes_table(&n);

    (void)snprintf(copy, sizeof copy, "%s", target);
    route_find(table, n, &r);
    if (r.route != NULL)
        route_read_id(&r);
    assert_int_equal(r.response.http, http);
    if (pattern != NULL) {
        assert_non_null(r.route);
        assert_string_equal(r.route->pattern, pattern);
    } else {
        assert_null(r.route);
    }
    request_free(&(struct request){.response.body = r.response.body});
}

TEST(test_routes)
{
    const char *const id = "/v1/templates/0123456789abcdef0123456789abcdef";

    check_route(REQUEST_GET, "/healthz", "/healthz", 0);
    check_route(REQUEST_GET, "/healthz?x=/y", "/healthz", 0);
    check_route(REQUEST_GET, "/healthz/", NULL, 404);
    check_route(REQUEST_GET, "healthz", NULL, 404);
    check_route(REQUEST_GET, "", NULL, 404);
    check_route(REQUEST_GET, "*", NULL, 404);
    check_route(REQUEST_GET, "http://host/healthz", NULL, 404);
    check_route(REQUEST_GET, "/v1/subjects", "/v1/subjects", 0);
    check_route(REQUEST_GET, "/v1/subjects/", NULL, 404);
    check_route(REQUEST_GET, "/v1/subjects/verify", "/v1/subjects/{subject}", 0);
    check_route(REQUEST_GET, "/v1/subjects/a%2Fb", "/v1/subjects/{subject}", 400);
    check_route(REQUEST_GET, "/v1/subjects/a/b", NULL, 404);
    check_route(REQUEST_POST, "/v1/subjects/a", NULL, 405);
    check_route(REQUEST_OTHER, "/v1/subjects/a", NULL, 405);
    check_route(REQUEST_POST, "/v1/subjects/a/verify?x", "/v1/subjects/{subject}/verify",
                0);
    check_route(REQUEST_DELETE, id, "/v1/templates/{template_id}", 0);
    check_route(REQUEST_DELETE, "/v1/templates/0123", "/v1/templates/{template_id}", 404);
}

TEST(test_id)
{
    struct request r = {0};
    char longest[REQUEST_ID_MAX + 2];

    request_set_id(&r, "Abc-1_2.z", 1);
    assert_string_equal(r.id, "Abc-1_2.z");
    memset(longest, 'x', sizeof longest);
    longest[REQUEST_ID_MAX] = '\0';
    request_set_id(&r, longest, 2);
    assert_string_equal(r.id, longest);
    longest[REQUEST_ID_MAX] = 'x';
    longest[REQUEST_ID_MAX + 1] = '\0';
    request_set_id(&r, longest, 3);
    assert_string_equal(r.id + strlen(r.id) - 8, "00000003");
    request_set_id(&r, "a\nb", 4);
    assert_string_equal(r.id + strlen(r.id) - 8, "00000004");
    request_set_id(&r, "", 5);
    assert_string_equal(r.id + strlen(r.id) - 8, "00000005");
}

/* Every outcome has an entry, and every code consists of lower-case letters and '_'. */
TEST(test_errmap)
{
    for (unsigned k = 1; k < ERRMAP_COUNT; k++) {
        const struct errmap *m = errmap_get(k);

        assert_true(m->http >= 400 && m->http <= 599);
        assert_true(strspn(m->code, "abcdefghijklmnopqrstuvwxyz_") == strlen(m->code));
        assert_non_null(m->title);
        if (m->http < 500)
            assert_string_not_equal(m->code, "internal");
    }
    for (unsigned st = 1; st < ST_COUNT; st++) /* of a scan: the command's word too */
        if (dry_run_is_refusal(st))
            assert_string_equal(errmap_get(st)->code, status_refusal(st));
    assert_string_equal(errmap_get(ST_OK)->code, "internal");
    assert_string_equal(errmap_get(ERRMAP_COUNT)->code, "internal");
    assert_string_equal(errmap_get(UINT32_MAX)->code, "internal");
}

/* Every route but the parts of the pages /docs and /console is an operation of the API's description. */
TEST(test_described)
{
    size_t n, described = 0, wanted = 0;
    const struct route *table = routes_table(&n);

    for (const char *at = openapi_json; (at = strstr(at, "\"operationId\": ")) != NULL;
         at++)
        described++;
    for (size_t i = 0; i < n; i++) {
        char path[128];

        if (strncmp(table[i].pattern, "/docs/", 6) == 0 ||
            strncmp(table[i].pattern, "/console/", 9) == 0)
            continue;
        wanted++;
        (void)snprintf(path, sizeof path, "\n    \"%s\": {\n", table[i].pattern);
        if (strstr(openapi_json, path) == NULL)
            fail_msg("server/openapi.json lacks %s", table[i].pattern);
    }
    assert_int_equal(described, wanted);
}
