/* A body of few bytes that becomes a large one needs a large one's place in the queue, however it is
 * packed; as it is queued again nothing of it is lost. */
#define ZLIB_CONST /* zlib only reads its input */
#include <stdio.h>
#include <zlib.h>

#include "app.h"
#include "body.h"
#include "mem.h"
#include "quota.h"
#include "request.h"
#include "route.h"
#include "unit.h"

static struct app app = {.max_body = 4 * QUOTA_SMALL};
static const struct route cloud = {.body = ROUTE_CLOUD}, frames = {.body = ROUTE_FRAMES},
                          pair = {.body = ROUTE_PAIR};
static char target[] = "/v1/check";
static unsigned char many[2 * QUOTA_SMALL];

/* The header of a PNG of so many pixels. */
static size_t png(char *out, uint32_t width, uint32_t height)
{
    memcpy(out, "\x89PNG\r\n\x1A\n\0\0\0\x0DIHDR", 16);
    for (int i = 0; i < 4; i++) {
        out[16 + i] = (char)(width >> (24 - 8 * i));
        out[20 + i] = (char)(height >> (24 - 8 * i));
    }
    return 24;
}

/* By gzip. */
static size_t pack(const void *in, size_t len, unsigned char *out, size_t size)
{
    z_stream z = {0};

    assert_int_equal(deflateInit2(&z, 9, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY),
                     Z_OK);
    z.next_in = in;
    z.avail_in = (unsigned)len;
    z.next_out = out;
    z.avail_out = (unsigned)size;
    assert_int_equal(deflate(&z, Z_FINISH), Z_STREAM_END);
    (void)deflateEnd(&z);
    return size - z.avail_out;
}

static struct request request_of(const struct route *route, const void *body, size_t len)
{
    struct request r = {.app = &app, .route = route, .target = target};

    r.media = REQUEST_SCAN;
    r.body = mem_array(len + 1, 1);
    assert_non_null(r.body);
    memcpy(r.body, body, len);
    r.body[r.len = len] = 0;
    return r;
}

/* Needs it a large one's place?  In that it is unpacked, to so many bytes; 0: as it is. */
static bool needs_large(struct request r, size_t len)
{
    const bool first = body_unpack(&r);

    assert_int_equal(r.response.http, 0);
    assert_int_equal(r.large, !first);
    assert_true(first || body_unpack(&r));
    if (len > 0)
        assert_int_equal(r.len, len);
    mem_free(r.body);
    return !first;
}

TEST(test_packed)
{
    unsigned char packed[QUOTA_SMALL / 100];

    for (int i = 0; i < 2; i++) {
        const size_t len = QUOTA_SMALL + (size_t)i;
        struct request r =
            request_of(&cloud, packed, pack(many, len, packed, sizeof packed));

        r.coding = INFLATE_GZIP;
        assert_int_equal(needs_large(r, len), i);
        /* a packed file without Content-Encoding */
        r = request_of(&cloud, packed, pack(many, len, packed, sizeof packed));
        assert_true(needs_large(r, r.len));
    }
}

TEST(test_pixels)
{
    static char raw_target[] = "/v1/check?fx=1&width=1000&height=200";
    char body[24];
    struct request r;

    assert_true(needs_large(request_of(&cloud, body, png(body, 1000, 1000)), 24));
    assert_false(needs_large(request_of(&cloud, body, png(body, 200, 400)), 24));
    r = request_of(&cloud, many, 400000);
    assert_false(needs_large(r, 400000));
    r = request_of(&cloud, many, 400000);
    r.target = raw_target;
    assert_true(needs_large(r, 400000));
}

/* A form with this file n times, with a header line more. */
static struct request form(const struct route *route, const char *more, const void *file,
                           size_t len, int n)
{
    static char body[8000];
    size_t at = 0;
    struct request r;

    for (int i = 0; i < n; i++) {
        at += (size_t)snprintf(body + at, sizeof body - at,
                               "--b\r\nContent-Disposition: form-data; name=\"%c\"; "
                               "filename=\"a\"\r\n%s\r\n",
                               'a' + i, more);
        memcpy(body + at, file, len);
        at += len;
        memcpy(body + at, "\r\n", 2);
        at += 2;
    }
    at += (size_t)snprintf(body + at, sizeof body - at, "--b--\r\n");
    r = request_of(route, body, at);
    r.media = REQUEST_FORM;
    (void)snprintf(r.boundary, sizeof r.boundary, "b");
    return r;
}

TEST(test_forms)
{
    unsigned char packed[3000];
    char body[24];
    size_t len = png(body, 200, 400);

    assert_false(needs_large(form(&frames, "", body, len, 1), len));
    assert_true(needs_large(form(&frames, "", body, len, 2), 0));
    assert_true(needs_large(form(&pair, "", body, len, 2), 0));
    assert_false(needs_large(form(&pair, "", "1 2 3", 5, 2), 0));
    len = pack(many, sizeof many, packed, sizeof packed);
    assert_true(needs_large(form(&frames, "", packed, len, 1), len));
    assert_true(needs_large(form(&frames, "Content-Encoding: gzip\r\n", packed, len, 1),
                            sizeof many));
    len = pack("1 2 3", 5, packed, sizeof packed);
    assert_false(
        needs_large(form(&frames, "Content-Encoding: gzip\r\n", packed, len, 1), 5));
    /* how long each becomes is not known yet */
    assert_true(
        needs_large(form(&frames, "Content-Encoding: gzip\r\n", packed, len, 2), 0));
}
