/* Captures that devices sign: nonces that are valid once.  Names and keys: tests/box/http-signed.sh. */
#include <pthread.h>
#include <sodium.h>

#include "store.h"
#include "tempdb.h"
#include "unit.h"

static struct errinfo e;

static struct pair {
    unsigned char public[crypto_sign_PUBLICKEYBYTES], secret[crypto_sign_SECRETKEYBYTES];
} pair;

static void add(struct store *s, const char *name)
{
    struct store_device d;

    (void)crypto_sign_keypair(pair.public, pair.secret);
    must(store_device_add(s, "test", name, pair.public, &d, &e));
    assert_string_equal(d.name, name);
    assert_true(ident_id_valid(d.id));
}

/* A capture of the device with the nonce, signed. */
static struct store_capture capture(const char *device, const char *nonce)
{
    static const char text[] = "what was captured";
    struct store_capture c = {
        .device = device, .nonce = nonce, .text = text, .len = sizeof text};

    (void)crypto_sign_detached(c.signature, NULL, (const unsigned char *)text,
                               sizeof text, pair.secret);
    return c;
}

static enum store_captured take(struct store *s, const struct store_capture *c)
{
    enum store_captured is;

    must(store_capture_take(s, c, &is, &e));
    return is;
}

static void make_nonce(struct store *s, char nonce[STORE_NONCE_TEXT + 1])
{
    char expires[32];

    must(store_capture_nonce(s, nonce, expires, &e));
    assert_int_equal(strlen(nonce), STORE_NONCE_TEXT);
}

/* Every character of a nonce counts.  Unknown devices, forged captures, nonces that were used before:
 * tests/box/http-signed.sh. */
TEST(test_nonces)
{
    char nonce[STORE_NONCE_TEXT + 1], other[STORE_NONCE_TEXT + 1];
    struct store *s = tempdb_fresh();
    struct store_capture c;

    add(s, "door-1");
    make_nonce(s, nonce);
    make_nonce(s, other);
    assert_string_not_equal(nonce, other);
    c = capture("door-1", other);
    assert_int_equal(take(s, &c), STORE_CAPTURED);
    for (size_t i = 0; i < STORE_NONCE_TEXT - 1; i++) { /* the last has spare bits */
        make_nonce(s, nonce);
        nonce[i] = nonce[i] == 'A' ? 'B' : 'A';
        c.nonce = nonce;
        assert_int_equal(take(s, &c), STORE_CAPTURE_FOREIGN);
    }
    for (size_t i = 0; i < 3; i++) {
        c.nonce = ((const char *const[]){"", "=", "AAAA"})[i];
        assert_int_equal(take(s, &c), STORE_CAPTURE_FOREIGN);
    }
    store_close(s);
}

#define THREADS 8

struct taker {
    struct store *store;
    struct store_capture capture;
    pthread_t thread;
    enum store_captured is;
    enum status st;
};

static void *run(void *arg)
{
    struct taker *t = arg;

    t->st = store_capture_take(t->store, &t->capture, &t->is, NULL);
    return NULL;
}

/* Many at once: one of them has the nonce. */
TEST(test_at_once)
{
    struct taker t[THREADS];
    char nonce[STORE_NONCE_TEXT + 1];
    struct store *s = tempdb_fresh();
    int taken = 0;

    add(s, "door-1");
    make_nonce(s, nonce);
    for (int i = 0; i < THREADS; i++) {
        t[i] = (struct taker){.store = s, .capture = capture("door-1", nonce)};
        assert_int_equal(pthread_create(&t[i].thread, NULL, run, &t[i]), 0);
    }
    for (int i = 0; i < THREADS; i++) {
        assert_int_equal(pthread_join(t[i].thread, NULL), 0);
        assert_int_equal(t[i].st, ST_OK);
        assert_true(t[i].is == STORE_CAPTURED || t[i].is == STORE_CAPTURE_REPLAYED);
        taken += t[i].is == STORE_CAPTURED;
    }
    assert_int_equal(taken, 1);
    store_close(s);
}
