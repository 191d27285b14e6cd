/* Connections: their number in all and by address, that connections past their time limit are
 * shut down, and that clients are noticed which go while the daemon works for them. */
#include <arpa/inet.h>
#include <netinet/in.h>
#include <stdatomic.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "errinfo.h"
#include "guard.h"
#include "unit.h"

static struct guard *g;

static void start(const struct guard_rules *rules)
{
    struct errinfo e = {0};

    assert_int_equal(guard_start(rules, &g, &e), ST_OK);
}

/* NULL: a Unix socket. */
static const struct sockaddr *from(const char *text)
{
    static struct sockaddr_storage ss;
    struct sockaddr_in in = {.sin_family = AF_INET};
    struct sockaddr_in6 in6 = {.sin6_family = AF_INET6};

    if (text == NULL)
        return NULL;
    memset(&ss, 0, sizeof ss);
    if (inet_pton(AF_INET, text, &in.sin_addr) == 1) {
        memcpy(&ss, &in, sizeof in);
    } else {
        assert_int_equal(inet_pton(AF_INET6, text, &in6.sin6_addr), 1);
        memcpy(&ss, &in6, sizeof in6);
    }
    return (const struct sockaddr *)&ss;
}

/* A connection with a socket pair in fd. */
static struct guard_peer *connect_from(const char *text, int fd[2])
{
    struct guard_peer *p;

    assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM, 0, fd), 0);
    p = guard_open(g, fd[0], from(text));
    assert_non_null(p);
    return p;
}

static void close_all(struct guard_peer *p[], int fd[][2], int n)
{
    for (int i = 0; i < n; i++) {
        guard_close(p[i]);
        (void)close(fd[i][0]);
        (void)close(fd[i][1]);
    }
    guard_stop(g);
}

TEST(test_by_address)
{
    /* the address of two open connections, and whether a third may connect */
    static const struct {
        const char *two, *third;
        bool local_too, ok;
    } cases[] = {
        {"192.0.2.1", "192.0.2.1", false, false},
        {"192.0.2.1", "192.0.2.2", false, true},
        {"127.0.0.1", "127.0.0.1", false, true},
        {"127.0.0.1", "127.0.0.1", true, false},
        {"127.0.0.1", "127.0.0.2", true, true},
        {"::1", "::1", false, true},
        {"::1", "::1", true, false},
        {NULL, NULL, true, true}, /* a Unix socket has no address */
    };

    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct guard_peer *p[2];
        int fd[2][2];

        start(&(struct guard_rules){100, 2, cases[i].local_too, .timeout_s = 1});
        p[0] = connect_from(cases[i].two, fd[0]);
        p[1] = connect_from(cases[i].two, fd[1]);
        assert_int_equal(guard_admit(g, from(cases[i].third)), cases[i].ok);
        close_all(p, fd, 2);
    }
}

/* Has the other side read the end of the connection? */
static bool has_ended(int fd)
{
    char c;

    return recv(fd, &c, 1, MSG_DONTWAIT) == 0;
}

/* Sends as much as a body must, until the other connection has ended. */
static void keep_up(struct guard_peer *p, int other)
{
    const struct timespec pause = {0, 50 * 1000 * 1000};

    for (int i = 0; i < 600 && !has_ended(other); i++) {
        guard_more(p, (size_t)(0.1 * GUARD_BYTES_PER_S));
        (void)nanosleep(&pause, NULL);
    }
    assert_true(has_ended(other));
}

TEST(test_late)
{
    static const enum guard_step steps[] = {GUARD_REQUEST, GUARD_HEADERS, GUARD_BODY,
                                            GUARD_RESPONSE, GUARD_IDLE};
    enum { LATE, WORK, PATIENT, PEERS };
    struct guard_peer *p[PEERS];
    struct guard_state s;
    int fd[PEERS][2];

    for (size_t i = 0; i < sizeof steps / sizeof steps[0]; i++) {
        start(&(struct guard_rules){.connections = 100, .timeout_s = 1});
        for (int k = 0; k < PEERS; k++)
            p[k] = connect_from(NULL, fd[k]);
        guard_begin(p[WORK], GUARD_WORK);
        guard_begin(p[PATIENT], GUARD_BODY);
        guard_begin(p[LATE], GUARD_IDLE); /* a request is complete */
        guard_begin(p[LATE], steps[i]);
        if (steps[i] != GUARD_IDLE) /* much at once earns no more than little */
            guard_more(p[LATE], (size_t)(3600 * GUARD_BYTES_PER_S));
        keep_up(p[PATIENT], fd[LATE][1]);
        assert_false(has_ended(fd[WORK][1]));
        assert_false(has_ended(fd[PATIENT][1]));
        guard_look(g, &s);
        for (unsigned k = 0; k < GUARD_NSTEPS; k++)
            assert_int_equal(s.late[k], k == steps[i] && steps[i] != GUARD_IDLE);
        close_all(p, fd, PEERS);
    }
}

static void count_gone(void *arg)
{
    atomic_uint *n = arg;

    (void)atomic_fetch_add(n, 1);
}

TEST(test_gone)
{
    const struct timespec pause = {0, 20 * 1000 * 1000};
    struct guard_peer *p[5];
    struct guard_state s;
    atomic_uint gone[5];
    int fd[5][2];

    start(&(struct guard_rules){.connections = 100, .timeout_s = 100});
    for (int i = 0; i < 5; i++) {
        p[i] = connect_from(NULL, fd[i]);
        atomic_init(&gone[i], 0);
    }
    guard_work(p[0], count_gone, &gone[0]);
    guard_work(p[1], count_gone, &gone[1]);
    guard_begin(p[2], GUARD_RESPONSE);
    guard_begin(p[3], GUARD_BODY);
    guard_begin(p[4], GUARD_BODY);
    (void)send(fd[4][1], "x", 1, 0); /* is still to be read */
    (void)shutdown(fd[4][1], SHUT_WR);
    (void)shutdown(fd[3][1], SHUT_WR);
    (void)shutdown(fd[1][1], SHUT_WR); /* looks like a closed connection */
    (void)send(fd[0][1], "x", 1, 0);   /* the next request is not yet the end */
    (void)shutdown(fd[2][1], SHUT_RDWR);
    for (int i = 0; i < 500 && atomic_load(&gone[1]) == 0; i++)
        (void)nanosleep(&pause, NULL);
    for (int i = 0; i < 25; i++) /* another look or two */
        (void)nanosleep(&pause, NULL);
    assert_int_equal(atomic_load(&gone[1]), 1);
    assert_int_equal(atomic_load(&gone[0]), 0);
    guard_look(g, &s);
    assert_int_equal(s.gone, 2);
    assert_true(has_ended(fd[3][1]));
    assert_false(has_ended(fd[4][1]));
    assert_false(has_ended(fd[0][1]));
    close_all(p, fd, 5);
}

/* Of connections without a whole request the one that is so for the longest time makes room; one
 * that has just come does not, nor one that is being served. */
TEST(test_crowded)
{
    const struct timespec while_ = {1, 100 * 1000 * 1000};
    struct guard_peer *p[3];
    struct guard_state s;
    int fd[3][2];

    start(&(struct guard_rules){.connections = 3, .timeout_s = 100});
    for (int i = 0; i < 3; i++)
        p[i] = connect_from(NULL, fd[i]);
    guard_begin(p[0], GUARD_BODY);
    assert_false(guard_admit(g, NULL)); /* all have just come, from there */
    (void)nanosleep(&while_, NULL);
    guard_begin(p[1], GUARD_IDLE);
    assert_true(guard_admit(g, NULL));
    assert_false(has_ended(fd[0][1]));
    assert_false(has_ended(fd[1][1]));
    assert_true(has_ended(fd[2][1]));
    guard_look(g, &s);
    assert_int_equal(s.crowded_out, 1);
    assert_int_equal(s.refused_total, 1);
    guard_close(p[2]);
    p[2] = guard_open(g, fd[2][0], from("192.0.2.1"));
    guard_begin(p[0], GUARD_IDLE); /* two of one address, one of another */
    assert_true(guard_admit(g, from("192.0.2.2")));
    assert_true(has_ended(fd[1][1])); /* it was idle before p[0] */
    close_all(p, fd, 3);
}

/* The oldest connection of the address with most connections makes room, and does so once.  A closed connection
 * has made room. */
TEST(test_crowd)
{
    struct guard_peer *p[4];
    struct guard_state s;
    int fd[4][2];

    start(&(struct guard_rules){.connections = 3, .timeout_s = 1});
    for (int i = 0; i < 3; i++)
        p[i] = connect_from(i == 0 ? "192.0.2.1" : "192.0.2.2", fd[i]);
    assert_true(guard_admit(g, from("192.0.2.3")));
    assert_false(has_ended(fd[0][1])); /* the oldest, but alone */
    assert_true(has_ended(fd[1][1]));
    assert_true(guard_admit(g, from("192.0.2.3"))); /* there is room */
    guard_look(g, &s);
    assert_int_equal(s.crowded_out, 1);
    p[3] = connect_from("192.0.2.2", fd[3]);
    assert_true(guard_admit(g, from("192.0.2.3")));
    assert_true(has_ended(fd[2][1]));
    guard_look(g, &s);
    assert_int_equal(s.crowded_out, 2);
    close_all(p, fd, 4);

    start(&(struct guard_rules){.connections = 1, .timeout_s = 1});
    p[0] = connect_from("192.0.2.1", fd[0]);
    guard_begin(p[0], GUARD_WORK);
    assert_false(guard_admit(g, from("192.0.2.3")));
    guard_begin(p[0], GUARD_IDLE);
    guard_begin(p[0], GUARD_HEADERS);
    assert_true(guard_admit(g, from("192.0.2.3")));
    close_all(p, fd, 1);
}

/* The headers of the first request are part of it; between requests there is more time. */
TEST(test_steps)
{
    const struct timespec pause = {0, 20 * 1000 * 1000};
    struct guard_peer *p[2];
    struct guard_state s;
    int fd[2][2];

    start(&(struct guard_rules){.connections = 100, .timeout_s = 1});
    p[0] = connect_from("192.0.2.1", fd[0]);
    p[1] = connect_from("192.0.2.1", fd[1]);
    guard_begin(p[0], GUARD_IDLE);
    guard_begin(p[1], GUARD_HEADERS);
    for (int i = 0; i < 1000 && !has_ended(fd[1][1]); i++)
        (void)nanosleep(&pause, NULL);
    assert_true(has_ended(fd[1][1]));
    assert_false(has_ended(fd[0][1])); /* 2 s are left to it */
    guard_look(g, &s);
    assert_int_equal(s.late[GUARD_REQUEST], 1);
    assert_int_equal(s.late[GUARD_HEADERS], 0);
    close_all(p, fd, 2);
}

static void note_when(void *arg)
{
    struct timespec t;

    (void)clock_gettime(CLOCK_MONOTONIC, &t);
    atomic_store((atomic_long *)arg, t.tv_sec * 1000L + t.tv_nsec / 1000000L);
}

/* A client that has closed its side alone counts as gone after 2 s, a closed one at once, and neither once the
 * work is done. */
TEST(test_half)
{
    const struct timespec pause = {0, 20 * 1000 * 1000};
    struct guard_peer *p[3];
    atomic_long when[3], begin = 0;
    int fd[3][2];

    start(&(struct guard_rules){.connections = 100, .timeout_s = 100});
    for (int i = 0; i < 3; i++) {
        p[i] = connect_from("192.0.2.1", fd[i]);
        atomic_init(&when[i], 0);
    }
    note_when(&begin);
    for (int i = 0; i < 3; i++)
        guard_work(p[i], note_when, &when[i]);
    guard_begin(p[2], GUARD_RESPONSE);
    (void)shutdown(fd[0][1], SHUT_WR);
    (void)shutdown(fd[1][1], SHUT_RDWR);
    (void)shutdown(fd[2][1], SHUT_RDWR);
    for (int i = 0; i < 1000 && atomic_load(&when[0]) == 0; i++)
        (void)nanosleep(&pause, NULL);
    assert_true(atomic_load(&when[0]) - atomic_load(&begin) >= 1990);
    assert_true(atomic_load(&when[1]) > 0);
    assert_true(atomic_load(&when[0]) - atomic_load(&when[1]) >= 100);
    assert_int_equal(atomic_load(&when[2]), 0);
    close_all(p, fd, 3);
}
