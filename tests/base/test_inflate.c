/* link: -Wl,--wrap=aligned_alloc */
/* Compressed bodies: round trips of every length near the limits, several members and frames,
 * damage at every byte, truncation at every byte, and the memory that bombs can take. */
#include <zlib.h>
#include <zstd.h>

#include "errinfo.h"
#include "inflate.h"
#include "mem.h"
#include "unit.h"

static size_t most; /* the largest size passed to aligned_alloc() */

void *__real_aligned_alloc(size_t alignment, size_t n);
void *__wrap_aligned_alloc(size_t alignment, size_t n);
void *__wrap_aligned_alloc(size_t alignment, size_t n)
{
    if (n > most)
        most = n;
    return __real_aligned_alloc(alignment, n);
}

/* Compresses in[0..len-1] to out, which has room for size bytes; returns the length. */
static size_t pack(enum inflate_coding coding, const unsigned char *in, size_t len,
                   unsigned char *out, size_t size)
{
    z_stream z = {0};
    unsigned char *copy;
    size_t n;

    if (coding == INFLATE_ZSTD) {
        n = ZSTD_compress(out, size, in, len, 3);
        assert_false(ZSTD_isError(n));
        return n;
    }
    copy = malloc(len + 1);
    assert_non_null(copy);
    memcpy(copy, in, len);
    assert_int_equal(deflateInit2(&z, 6, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY),
                     Z_OK);
    z.next_in = copy;
    z.avail_in = (unsigned)len;
    z.next_out = out;
    z.avail_out = (unsigned)size;
    assert_int_equal(deflate(&z, Z_FINISH), Z_STREAM_END);
    n = z.total_out;
    (void)deflateEnd(&z);
    free(copy);
    return n;
}

/* Text that compresses to about a fifth. */
static unsigned char *make_text(size_t len)
{
    unsigned char *text = malloc(len + 1);
    uint32_t state = 1;

    assert_non_null(text);
    for (size_t i = 0; i < len; i++) {
        state = state * 1664525 + 1013904223;
        text[i] = (unsigned char)("0123 4.5-"[(state >> 24) % 9]);
    }
    return text;
}

static void check(enum inflate_coding coding, const unsigned char *in, size_t len,
                  size_t limit, enum status want, const unsigned char *text, size_t n)
{
    unsigned char *out = (unsigned char *)1, *exact = malloc(len > 0 ? len : 1);
    struct errinfo e = {0};
    size_t got = 99;

    assert_non_null(exact); /* of exact size: the sanitizer sees an overrun */
    memcpy(exact, in, len);
    assert_int_equal(inflate_body(coding, exact, len, limit, &out, &got, &e), want);
    if (want == ST_OK) {
        assert_int_equal(got, n);
        assert_int_equal(out[n], 0);
        assert_memory_equal(out, text, n);
    } else {
        assert_null(out);
        assert_int_equal(got, 0);
        assert_int_equal(e.code, want);
        assert_true(strlen(e.msg) > 5);
    }
    free(out);
    free(exact);
}

static const enum inflate_coding both[] = {INFLATE_GZIP, INFLATE_ZSTD};

TEST(test_lengths)
{
    static const size_t lengths[] = {0,     1,     2,      100,    65534,  65535,
                                     65536, 65537, 131071, 131072, 131073, 400000};
    unsigned char *text = make_text(400000), *packed = malloc(500000);

    assert_non_null(packed);
    for (int c = 0; c < 2; c++) {
        for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
            size_t n = lengths[i], len = pack(both[c], text, n, packed, 500000);

            check(both[c], packed, len, 1 << 20, ST_OK, text, n);
            check(both[c], packed, len, n, ST_OK, text, n);
            if (n > 0)
                check(both[c], packed, len, n - 1, ST_ESIZE, NULL, 0);
            if (n > 1)
                check(both[c], packed, len, 1, ST_ESIZE, NULL, 0);
        }
    }
    free(text);
    free(packed);
}

TEST(test_several)
{
    unsigned char *text = make_text(3000), packed[9000];

    for (int c = 0; c < 2; c++) {
        size_t len = pack(both[c], text, 1000, packed, 3000);

        len += pack(both[c], text, 0, packed + len, 3000); /* an empty one between */
        len += pack(both[c], text + 1000, 2000, packed + len, 3000);
        check(both[c], packed, len, 3000, ST_OK, text, 3000);
        check(both[c], packed, len, 2999, ST_ESIZE, NULL, 0);
        packed[len] = 'x';
        check(both[c], packed, len + 1, 3000 + 1, ST_EINVAL, NULL, 0);
        memset(packed + len, 0, 512);
        check(both[c], packed, len + 512, 3000 + 1, ST_EINVAL, NULL, 0);
    }
    free(text);
}

/* Skippable frames of zstd, and frames of an old version. */
TEST(test_skippable)
{
    unsigned char packed[600] = {0x5a, 0x2a, 0x4d, 0x18, 5, 0, 0, 0, 1, 2, 3, 4, 5};
    size_t len =
        13 + pack(INFLATE_ZSTD, (const unsigned char *)"abc", 3, packed + 13, 500);

    memcpy(packed + len, packed, 13);
    check(INFLATE_ZSTD, packed, len + 13, 10, ST_OK, (const unsigned char *)"abc", 3);
    check(INFLATE_ZSTD, packed, len + 12, 10, ST_EINVAL, NULL, 0);
    check(INFLATE_ZSTD, packed, 13, 10, ST_OK, (const unsigned char *)"", 0);
    memcpy(packed, (const unsigned char[]){0x27, 0xb5, 0x2f, 0xfd}, 4); /* version 0.7 */
    check(INFLATE_ZSTD, packed, len, 10, ST_EINVAL, NULL, 0);
}

TEST(test_window)
{
    /* A frame header alone: magic, no content size, a window of 8 MB or 16 MB; then one
     * last raw block of one byte. */
    unsigned char packed[] = {0x28, 0xb5, 0x2f, 0xfd, 0, 13 << 3, 9, 0, 0, 'a'};

    check(INFLATE_ZSTD, packed, sizeof packed, 10, ST_OK, (const unsigned char *)"a", 1);
    packed[5] = 14 << 3;
    check(INFLATE_ZSTD, packed, sizeof packed, 10, ST_EINVAL, NULL, 0);
}

/* Truncated anywhere the body is rejected; with any bit flipped it is rejected or, if the bit
 * is part of the metadata (time, name, system), gives the same text. */
TEST(test_damage)
{
    unsigned char *text = make_text(700), packed[1000];

    for (int c = 0; c < 2; c++) {
        size_t len = pack(both[c], text, 700, packed, sizeof packed);

        for (size_t i = 0; i < len; i++)
            check(both[c], packed, i, 700, i > 0 || c == 0 ? ST_EINVAL : ST_OK, text, 0);
        for (size_t i = 0; i < 8 * len && c == 0; i++) {
            unsigned char *out = NULL;
            struct errinfo e = {0};
            size_t n = 0;

            packed[i / 8] ^= (unsigned char)(1U << i % 8);
            if (inflate_body(both[c], packed, len, 1 << 20, &out, &n, &e) == ST_OK) {
                assert_int_equal(n, 700);
                assert_memory_equal(out, text, n);
            } else {
                assert_null(out);
            }
            free(out);
            packed[i / 8] ^= (unsigned char)(1U << i % 8);
        }
    }
    check(INFLATE_GZIP, (const unsigned char *)"no gzip", 7, 700, ST_EINVAL, NULL, 0);
    check(INFLATE_ZSTD, (const unsigned char *)"no zstd", 7, 700, ST_EINVAL, NULL, 0);
    free(text);
}

/* A hundred megabytes of zeros are rejected, with bounded memory. */
TEST(test_bomb)
{
    const size_t size = 100 << 20, limit = 1 << 20;
    unsigned char *zeros = calloc(size, 1), *packed = malloc(1 << 20);

    assert_non_null(zeros);
    assert_non_null(packed);
    for (int c = 0; c < 2; c++) {
        size_t len = pack(both[c], zeros, size, packed, 1 << 20);

        most = 0;
        check(both[c], packed, len, limit, ST_ESIZE, NULL, 0);
        assert_true(most <= mem_round(limit + 1));
        check(both[c], packed, len, 1, ST_ESIZE, NULL, 0);
    }
    free(zeros);
    free(packed);
}

TEST(test_coding)
{
    assert_int_equal(inflate_coding(NULL), INFLATE_NONE);
    assert_int_equal(inflate_coding("identity"), INFLATE_NONE);
    assert_int_equal(inflate_coding("gzip"), INFLATE_GZIP);
    assert_int_equal(inflate_coding(" GZip\t"), INFLATE_GZIP);
    assert_int_equal(inflate_coding("x-gzip"), INFLATE_GZIP);
    assert_int_equal(inflate_coding("zstd"), INFLATE_ZSTD);
    assert_int_equal(inflate_coding(""), INFLATE_OTHER);
    assert_int_equal(inflate_coding("br"), INFLATE_OTHER);
    assert_int_equal(inflate_coding("gzi"), INFLATE_OTHER);
    assert_int_equal(inflate_coding("gzipp"), INFLATE_OTHER);
    assert_int_equal(inflate_coding("gzip, zstd"), INFLATE_OTHER);
    assert_int_equal(inflate_coding("gzip,"), INFLATE_OTHER);
    assert_int_equal(inflate_coding("gzip gzip"), INFLATE_OTHER);
    assert_int_equal(inflate_coding("gzip;q=1"), INFLATE_OTHER);
}
