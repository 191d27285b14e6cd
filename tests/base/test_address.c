/* Addresses for the limits; lists of addresses and networks: what is one, and which addresses are in it. */
#include <arpa/inet.h>
#include <netinet/in.h>

#include "address.h"
#include "unit.h"

static const struct sockaddr *at(const char *text)
{
    static struct sockaddr_storage ss;
    struct sockaddr_in in = {.sin_family = AF_INET, .sin_port = 7};
    struct sockaddr_in6 in6 = {.sin6_family = AF_INET6, .sin6_port = 7};

    memset(&ss, 0, sizeof ss);
    if (strcmp(text, "unix") == 0) {
        ss.ss_family = AF_UNIX;
    } else if (inet_pton(AF_INET, text, &in.sin_addr) == 1) {
        memcpy(&ss, &in, sizeof in);
    } else {
        assert_int_equal(inet_pton(AF_INET6, text, &in6.sin6_addr), 1);
        memcpy(&ss, &in6, sizeof in6);
    }
    return (const struct sockaddr *)&ss;
}

TEST(test_key)
{
    static const struct {
        const char *a, *b;
        bool same;
    } cases[] = {
        {"192.0.2.1", "192.0.2.1", true},
        {"192.0.2.1", "192.0.2.2", false},
        {"192.0.2.1", "::ffff:192.0.2.1", true},
        {"2001:db8:1:2::1", "2001:db8:1:2:ffff::", true},
        {"2001:db8:1:2::1", "2001:db8:1:3::1", false},
        {"192.0.2.1", "c000:201::", false}, /* the same first bytes */
        {"0.0.0.0", "::", false},
        {"unix", "::", false},
    };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const uint64_t a = address_key(at(cases[i].a));

        if ((a == address_key(at(cases[i].b))) != cases[i].same)
            fail_msg("%s and %s", cases[i].a, cases[i].b);
    }
    assert_true(address_key(at("unix")) == ADDRESS_NO_KEY);
    assert_true(address_key(NULL) == ADDRESS_NO_KEY);
}

TEST(test_is_list)
{
    static const char *const good[] = {
        "192.0.2.1",
        "unix",
        "2001:DB8::1",
        "::",
        "10.0.0.0/8",
        "0.0.0.0/0",
        "::/0",
        "192.0.2.1/32",
        "2001:db8::/32",
        "::1/128",
        "127.0.0.1,::1,unix,10.64.0.0/10",
    };
    static const char *const bad[] = {
        "",
        ",",
        "192.0.2.1,",
        ",192.0.2.1",
        "192.0.2.1, ::1",
        " 192.0.2.1",
        "192.0.2.1 ",
        "192.0.2",
        "192.0.2.256",
        "192.0.2.1:80",
        "[::1]",
        "localhost",
        "proxy.example.org",
        "unix:/run/x",
        "unix/0",
        "10.0.0.0/",
        "10.0.0.0/33",
        "10.0.0.0/-1",
        "10.0.0.0/+8",
        "10.0.0.0/ 8",
        "10.0.0.0/8x",
        "10.0.0.0/0008",
        "10.0.0.0/255.0.0.0",
        "10.0.0.1/8",
        "10.128.0.0/8",
        "::1/129",
        "2001:db8::/28",
        "/8",
        "fe80::1%eth0",
        "1111:1111:1111:1111:1111:1111:1111:1111:1111:1111:1111:1111:1111:1111",
    };

    for (size_t i = 0; i < sizeof good / sizeof *good; i++)
        if (!address_is_list(good[i]))
            fail_msg("'%s' is a list", good[i]);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        if (address_is_list(bad[i]))
            fail_msg("'%s' is no list", bad[i]);
}

TEST(test_in_list)
{
    static const struct {
        const char *list, *addr;
        bool in;
    } cases[] = {
        {"192.0.2.1", "192.0.2.1", true},
        {"192.0.2.1", "192.0.2.2", false},
        {"192.0.2.1", "::ffff:192.0.2.1", true}, /* a socket for both */
        {"192.0.2.1", "::192.0.2.1", false},
        {"::ffff:192.0.2.1", "192.0.2.1", true},
        {"2001:DB8:0::1", "2001:db8::1", true},
        {"2001:db8::1", "2001:db8::2", false},
        {"127.0.0.1,2001:db8::1,unix", "2001:db8::1", true},
        {"127.0.0.1,2001:db8::1,unix", "unix", true},
        {"127.0.0.1,2001:db8::1,unix", "127.0.0.2", false},
        {"10.0.0.0/8", "10.255.3.4", true},
        {"10.0.0.0/8", "11.0.0.0", false},
        {"10.64.0.0/10", "10.127.255.255", true},
        {"10.64.0.0/10", "10.128.0.0", false},
        {"10.64.0.0/10", "10.63.255.255", false},
        {"192.0.2.6/31", "192.0.2.7", true},
        {"192.0.2.6/31", "192.0.2.8", false},
        {"0.0.0.0/0", "203.0.113.9", true},
        {"0.0.0.0/0", "2001:db8::1", false},
        {"0.0.0.0/0", "unix", false},
        {"::/0", "2001:db8::1", true},
        {"::/0", "unix", false},
        {"2001:db8::/33", "2001:db8:7fff::1", true},
        {"2001:db8::/33", "2001:db8:8000::1", false},
        {"unix", "127.0.0.1", false},
    };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        if (address_in_list(cases[i].list, at(cases[i].addr)) != cases[i].in)
            fail_msg("%s in %s", cases[i].addr, cases[i].list);
    assert_false(address_in_list("0.0.0.0/0,unix", NULL));
}

/* By each of an address's bits: it is in the networks of its first bits, and with this bit changed
 * only in those that do not reach it. */
TEST(test_every_bit)
{
    char list[ADDRESS_HOST_MAX + 8], host[ADDRESS_HOST_MAX];

    for (unsigned bits = 0; bits <= 128; bits++) {
        struct sockaddr_in6 net = {.sin6_family = AF_INET6}, one;

        for (unsigned i = 0; i < bits; i++)
            net.sin6_addr.s6_addr[i / 8] |=
                (unsigned char)(i % 3 == 0 ? 128 >> i % 8 : 0);
        assert_non_null(inet_ntop(AF_INET6, &net.sin6_addr, host, sizeof host));
        (void)snprintf(list, sizeof list, "%s/%u", host, bits);
        assert_true(address_is_list(list));
        for (unsigned i = 0; i < 128; i++) {
            one = net;
            one.sin6_addr.s6_addr[i / 8] ^= (unsigned char)(128 >> i % 8);
            assert_int_equal(address_in_list(list, (const struct sockaddr *)&one),
                             i >= bits);
        }
    }
}
