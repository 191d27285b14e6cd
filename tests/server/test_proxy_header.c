/* Headers of the PROXY protocol, version 2: each kind byte by byte as the specification lays it out;
 * every part of one is incomplete, every wrong byte is found. */
#include <arpa/inet.h>
#include <netinet/in.h>

#include "address.h"
#include "proxy_header.h"
#include "unit.h"

#define SIGNATURE "\r\n\r\n\0\r\nQUIT\n"
#define IPV4      "\xc0\x00\x02\x07\xc6\x33\x64\x01\xd9\x03\x01\xbb"
#define IPV6                                                                             \
    "\x20\x01\x0d\xb8\0\0\0\0\0\0\0\0\0\0\0\x2a\x20\x01\x0d\xb8\0\0\0\0\0\0\0\0\0\0\0\1" \
    "\xd9\x03\x01\xbb"
#define MAPPED                                                                               \
    "\0\0\0\0\0\0\0\0\0\0\xff\xff\xc0\x00\x02\x07\0\0\0\0\0\0\0\0\0\0\xff\xff\xc6\x33\x64\1" \
    "\xd9\x03\x01\xbb"

static struct proxy_header h;

static enum proxy_header_state take(const char *bytes, size_t n)
{
    unsigned char *exact = malloc(n > 0 ? n : 1); /* a byte beyond it is an error */
    enum proxy_header_state st;

    assert_non_null(exact);
    memcpy(exact, bytes, n);
    st = proxy_header_read(exact, n, &h);
    free(exact);
    return st;
}

/* As it is read: every part of it is incomplete, and does not ask for bytes beyond its end. */
static void assert_whole(const char *bytes, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        assert_int_equal(take(bytes, i), PROXY_HEADER_MORE);
        assert_int_equal(h.len, i < 16 ? 16 : n);
    }
    assert_int_equal(take(bytes, n), PROXY_HEADER_DONE);
    assert_int_equal(h.len, n);
}

static void assert_client(const char *host, unsigned port)
{
    char got[ADDRESS_HOST_MAX];
    struct sockaddr_in in;
    struct sockaddr_in6 in6;

    assert_true(h.client_len > 0);
    address_host((const struct sockaddr *)&h.client, got);
    assert_string_equal(got, host);
    if (h.client.ss_family == AF_INET) {
        assert_int_equal(h.client_len, sizeof in);
        memcpy(&in, &h.client, sizeof in);
        assert_int_equal(ntohs(in.sin_port), port);
    } else {
        assert_int_equal(h.client_len, sizeof in6);
        memcpy(&in6, &h.client, sizeof in6);
        assert_int_equal(ntohs(in6.sin6_port), port);
    }
}

/* A header of command and family as given, with the bytes after its length. */
#define HEADER(command_family, length, rest) SIGNATURE command_family length rest
#define WHOLE(text)                          assert_whole(text, sizeof(text) - 1)

TEST(test_clients)
{
    WHOLE(HEADER("\x21\x11", "\0\x0c", IPV4));
    assert_client("192.0.2.7", 55555);
    WHOLE(HEADER("\x21\x12", "\0\x0c", IPV4)); /* over QUIC */
    assert_client("192.0.2.7", 55555);
    WHOLE(HEADER("\x21\x21", "\0\x24", IPV6));
    assert_client("2001:db8::2a", 55555);
    WHOLE(HEADER("\x21\x22", "\0\x24", IPV6));
    assert_client("2001:db8::2a", 55555);
    WHOLE(HEADER("\x21\x21", "\0\x24", MAPPED));
    assert_client("192.0.2.7", 55555);
}

/* It is found with the wrong byte, the at-th. */
static void assert_bad(const char *bytes, size_t n, size_t at, const char *why)
{
    for (size_t i = 0; i < at; i++)
        assert_int_equal(take(bytes, i), PROXY_HEADER_MORE);
    for (size_t i = at; i <= n; i++) {
        assert_int_equal(take(bytes, i), PROXY_HEADER_BAD);
        assert_string_equal(h.why, why);
    }
}
#define BAD(text, at, why) assert_bad(text, sizeof(text) - 1, at, why)

TEST(test_bad)
{
    static const char none[] = "no PROXY protocol header",
                      family[] = "unknown address family or transport",
                      shorter[] = "the header is shorter than its addresses";

    BAD("\x16\x03\x01\x02", 1, none); /* TLS */
    BAD("GET / HTTP/1.1\r\n", 1, none);
    BAD("\r\n\r\n\0\r\nQUIX\n\x21\x11\0\x0c", 11, none);
    BAD(HEADER("\x11\x11", "\0\x0c", ""), 13, "unknown version of the PROXY protocol");
    BAD(HEADER("\x31\x11", "\0\x0c", ""), 13, "unknown version of the PROXY protocol");
    BAD(HEADER("\x22\x11", "\0\x0c", ""), 13, "unknown command");
    BAD(HEADER("\x2f\x11", "\0\x0c", ""), 13, "unknown command");
    BAD(HEADER("\x21\x41", "\0\x0c", ""), 14, family);
    BAD(HEADER("\x21\xf1", "\0\x0c", ""), 14, family);
    BAD(HEADER("\x21\x13", "\0\x0c", ""), 14, family);
    BAD(HEADER("\x21\x0f", "\0\x0c", ""), 14, family);
    BAD(HEADER("\x21\x11", "\0\x0b", IPV4), 16, shorter);
    BAD(HEADER("\x21\x11", "\0\0", ""), 16, shorter);
    BAD(HEADER("\x21\x21", "\0\x23", IPV6), 16, shorter);
    BAD(HEADER("\x21\x31", "\0\xd7", ""), 16, shorter);
    BAD(HEADER("\x21\x11", "\x0f\xf1", IPV4), 16, "the header is too long");
    BAD(HEADER("\x20\x00", "\xff\xff", ""), 16, "the header is too long");
}

TEST(test_version_1)
{
    static const char text[] = "PROXY TCP4 192.0.2.7 198.51.100.1 55555 443\r\n";

    for (size_t i = 5; i < sizeof text; i++) {
        assert_int_equal(take(text, i), PROXY_HEADER_BAD);
        assert_string_equal(h.why, "version 1 of the PROXY protocol");
    }
    assert_int_equal(take("P", 1), PROXY_HEADER_BAD);
    assert_int_equal(take("POST / HTTP/1.1", 15), PROXY_HEADER_BAD);
    assert_string_equal(h.why, "no PROXY protocol header");
}

TEST(test_longest)
{
    static char text[PROXY_HEADER_MAX] = HEADER("\x21\x11", "\x0f\xf0", IPV4);

    assert_whole(text, sizeof text);
    assert_client("192.0.2.7", 55555);
}

/* For every command, family and length: the fields alone decide, as the specification has it. */
TEST(test_every_header)
{
    static const size_t size[] = {0, 12, 36, 216};
    static const size_t lengths[] = {0,  11,  12,  13,  35,   36,
                                     37, 215, 216, 217, 4080, 4081};
    static char text[16 + 4081] = SIGNATURE;

    for (unsigned both = 0; both < 0x10000; both++) {
        const unsigned command = both >> 8, family = both & 255;
        const bool proxy = command == 0x21, stream = (family & 15) > 0;
        const bool known =
            command == 0x20 || (proxy && family >> 4 <= 3 && (family & 15) <= 2);
        const size_t needed = proxy && known && stream ? size[family >> 4] : 0;

        text[12] = (char)command;
        text[13] = (char)family;
        for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
            const size_t n = lengths[i];
            const bool good = known && n >= needed && n <= 4080;

            text[14] = (char)(n >> 8);
            text[15] = (char)(n & 255);
            assert_int_equal(proxy_header_read((const unsigned char *)text, 16 + n, &h),
                             good ? PROXY_HEADER_DONE : PROXY_HEADER_BAD);
            assert_int_equal(h.client_len > 0, good && (needed == 12 || needed == 36));
        }
    }
}
