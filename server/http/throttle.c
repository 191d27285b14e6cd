#include "throttle.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sodium.h>

#define SETS      1024
#define WAYS      4 /* addresses in a set, found by a keyed hash */
#define GOOD      4096
#define TOKEN_MAX 128 /* of a longer one the rest does not count */

/* A bucket with a hole: each failure adds 1, and as many leave in a period as there may be. */
struct bucket {
    uint64_t address;
    double level, at_ms;
};

struct throttle {
    pthread_mutex_t lock;
    double most, period_ms;
    unsigned char key[crypto_shorthash_KEYBYTES];
    struct bucket set[SETS][WAYS];
    uint64_t good[GOOD]; /* keyed hashes of address and token, each in its place */
};

struct throttle *throttle_new(unsigned most, double period_ms)
{
    struct throttle *t = calloc(1, sizeof *t);

    if (t == NULL || pthread_mutex_init(&t->lock, NULL) != 0) {
        free(t);
        return NULL;
    }
    t->most = most;
    t->period_ms = period_ms;
    crypto_shorthash_keygen(t->key);
    return t;
}

void throttle_free(struct throttle *t)
{
    if (t == NULL)
        return;
    (void)pthread_mutex_destroy(&t->lock);
    sodium_memzero(t, sizeof *t);
    free(t);
}

static uint64_t hash(const struct throttle *t, const void *bytes, size_t n)
{
    unsigned char h[crypto_shorthash_BYTES];
    uint64_t out;

    (void)crypto_shorthash(h, bytes, n, t->key);
    memcpy(&out, h, sizeof out);
    return out;
}

static uint64_t hash_both(const struct throttle *t, uint64_t address, const char *token)
{
    unsigned char both[sizeof address + TOKEN_MAX];
    const size_t n = strnlen(token, TOKEN_MAX);
    uint64_t h;

    memcpy(both, &address, sizeof address);
    memcpy(both + sizeof address, token, n);
    h = hash(t, both, sizeof address + n);
    sodium_memzero(both, sizeof both);
    return h;
}

/* Returns the level that is left now. */
static double level(const struct throttle *t, const struct bucket *b, double now_ms)
{
    return fmax(0.0, b->level - (now_ms - b->at_ms) * t->most / t->period_ms);
}

/* The address's bucket, or of those in its place the emptiest. */
static struct bucket *bucket_of(struct throttle *t, uint64_t address, double now_ms)
{
    struct bucket *set = t->set[hash(t, &address, sizeof address) % SETS], *b = set;

    for (size_t i = 0; i < WAYS; i++) {
        if (set[i].address == address)
            return &set[i];
        if (level(t, &set[i], now_ms) < level(t, b, now_ms))
            b = &set[i];
    }
    return b;
}

unsigned throttle_wait(struct throttle *t, uint64_t address, const char *token,
                       double now_ms)
{
    const struct bucket *b;
    double over = 0.0;

    if (t->most <= 0.0)
        return 0;
    (void)pthread_mutex_lock(&t->lock);
    b = bucket_of(t, address, now_ms);
    if (b->address == address)
        over = level(t, b, now_ms) + 1.0 - t->most;
    if (over > 0.0) {
        const uint64_t h = hash_both(t, address, token);

        if (t->good[h % GOOD] == h)
            over = 0.0;
    }
    (void)pthread_mutex_unlock(&t->lock);
    return over > 0.0 ? (unsigned)ceil(over * t->period_ms / 1000.0 / t->most) : 0;
}

void throttle_note(struct throttle *t, uint64_t address, const char *token, bool good,
                   double now_ms)
{
    struct bucket *b;
    uint64_t h, *place;

    h = hash_both(t, address, token);
    place = &t->good[h % GOOD];
    (void)pthread_mutex_lock(&t->lock);
    if (good) {
        *place = h;
    } else {
        if (*place == h)
            *place = 0; /* it is no longer valid */
        b = bucket_of(t, address, now_ms);
        if (b->address == address) {
            b->level = level(t, b, now_ms) + 1.0;
        } else {
            b->address = address;
            b->level = 1.0;
        }
        b->at_ms = now_ms;
    }
    (void)pthread_mutex_unlock(&t->lock);
}
