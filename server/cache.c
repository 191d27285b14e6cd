#include "cache.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "store.h"

#define NBUCKETS 4096

/* A model: in the list of loads while it is read, then in a bucket's and in that of all by
 * last use, newest first.  refs counts its holders, and the cache itself while it is in the
 * latter. */
struct entry {
    struct face face; /* first: cache_release() gets a pointer to it */
    char id[STORE_ID_LEN + 1];
    unsigned refs;
    bool ahead; /* by cache_load(), and not held since */
    size_t bytes;
    struct entry *chain; /* next in the bucket, or of the loads */
    struct entry *newer, *older;
};

struct cache {
    pthread_mutex_t lock;
    pthread_cond_t loaded; /* a load ahead has ended, well or not */
    struct entry *loads;
    struct entry *bucket[NBUCKETS];
    struct entry *newest, *oldest;
    uint64_t forgets; /* calls of cache_forget() */
    struct cache_state state;
};

/* Ids are 128 random bits in hex: their first digits are hash enough. */
static size_t bucket_of(const char *id)
{
    char digits[9] = {0};

    memcpy(digits, id, 8);
    return strtoul(digits, NULL, 16) % NBUCKETS;
}

static struct entry *find(struct cache *c, const char *id)
{
    struct entry *x = c->bucket[bucket_of(id)];

    while (x != NULL && strcmp(x->id, id) != 0)
        x = x->chain;
    return x;
}

static void link_newest(struct cache *c, struct entry *x)
{
    x->newer = NULL;
    x->older = c->newest;
    if (c->newest != NULL)
        c->newest->newer = x;
    else
        c->oldest = x;
    c->newest = x;
}

static void unlink_age(struct cache *c, struct entry *x)
{
    if (x->newer != NULL)
        x->newer->older = x->older;
    else
        c->newest = x->older;
    if (x->older != NULL)
        x->older->newer = x->newer;
    else
        c->oldest = x->newer;
}

/* One reference less; the lock is held. */
static void unref(struct entry *x)
{
    if (--x->refs == 0) {
        face_free(&x->face);
        free(x);
    }
}

static void drop(struct cache *c, struct entry *x)
{
    struct entry **link = &c->bucket[bucket_of(x->id)];

    while (*link != x)
        link = &(*link)->chain;
    *link = x->chain;
    unlink_age(c, x);
    c->state.bytes -= x->bytes;
    c->state.entries--;
    unref(x);
}

static size_t face_bytes(const struct face *f)
{
    return sizeof(struct entry) + (size_t)f->surface.mesh.cap * 68 +
           f->surface.mesh.nv * sizeof *f->surface.spacing +
           f->surface.mesh.nt * sizeof *f->surface.bridge;
}

struct cache *cache_new(size_t limit)
{
    struct cache *c = calloc(1, sizeof *c);

    if (c == NULL)
        return NULL;
    (void)pthread_mutex_init(&c->lock, NULL);
    (void)pthread_cond_init(&c->loaded, NULL);
    c->state.limit = limit;
    return c;
}

void cache_free(struct cache *c)
{
    if (c == NULL)
        return;
    while (c->oldest != NULL)
        drop(c, c->oldest);
    (void)pthread_cond_destroy(&c->loaded);
    (void)pthread_mutex_destroy(&c->lock);
    free(c);
}

/* Keep x, which its holder alone has so far, unless another worker has loaded the same
 * meanwhile or it does not fit; the lock is held. */
static void take_in(struct cache *c, struct entry *x)
{
    if (find(c, x->id) != NULL || x->bytes > c->state.limit)
        return;
    x->refs++;
    x->chain = c->bucket[bucket_of(x->id)];
    c->bucket[bucket_of(x->id)] = x;
    link_newest(c, x);
    c->state.bytes += x->bytes;
    c->state.entries++;
    while (c->state.bytes > c->state.limit) {
        drop(c, c->oldest);
        c->state.evictions++;
    }
}

static const struct entry *under_way(const struct cache *c, const char *id)
{
    const struct entry *x = c->loads;

    while (x != NULL && strcmp(x->id, id) != 0)
        x = x->chain;
    return x;
}

/* Load what is not there; the lock is held, but not meanwhile. */
static enum status load(struct cache *c, struct store *s, const char *id, bool ahead,
                        struct face_work *w, struct entry **out, struct errinfo *e)
{
    struct entry *x = calloc(1, sizeof *x), **link = &c->loads;
    const uint64_t forgets = c->forgets;
    struct store_template t;
    enum status st;

    if (x == NULL)
        return ST_ENOMEM;
    (void)snprintf(x->id, sizeof x->id, "%s", id);
    x->refs = 1;
    x->ahead = ahead;
    x->chain = c->loads;
    c->loads = x;
    c->state.misses++;
    (void)pthread_mutex_unlock(&c->lock);
    st = store_template_load(s, id, &t, w, &x->face, e);
    (void)pthread_mutex_lock(&c->lock);

    while (*link != x)
        link = &(*link)->chain;
    *link = x->chain;
    if (ahead)
        (void)pthread_cond_broadcast(&c->loaded);
    if (st != ST_OK) {
        unref(x);
        return st;
    }
    x->bytes = face_bytes(&x->face);
    c->state.reencoded += store_template_outdated(s, &t);
    /* A template that was deleted since it was read must not be kept after its
     * cache_forget(): it would stay until evicted.  Other templates are then loaded again. */
    if (forgets == c->forgets)
        take_in(c, x);
    *out = x;
    return ST_OK;
}

enum status cache_hold(struct cache *c, struct store *s, const char *id,
                       struct face_work *w, const struct face **out, struct errinfo *e)
{
    const struct entry *other;
    struct entry *x;
    enum status st = ST_OK;

    *out = NULL;
    (void)pthread_mutex_lock(&c->lock);
    while ((x = find(c, id)) == NULL && (other = under_way(c, id)) != NULL &&
           other->ahead)
        (void)pthread_cond_wait(&c->loaded, &c->lock);
    if (x != NULL) {
        x->refs++;
        c->state.hits += !x->ahead; /* it was a miss of cache_load() */
        x->ahead = false;
        unlink_age(c, x);
        link_newest(c, x);
    } else {
        st = load(c, s, id, false, w, &x, e);
    }
    (void)pthread_mutex_unlock(&c->lock);
    if (st == ST_OK)
        *out = &x->face;
    return st;
}

void cache_load(struct cache *c, struct store *s, const char *id, struct face_work *w)
{
    struct entry *x;

    (void)pthread_mutex_lock(&c->lock);
    if (c->state.limit > 0 && find(c, id) == NULL && under_way(c, id) == NULL &&
        load(c, s, id, true, w, &x, NULL) == ST_OK)
        unref(x);
    (void)pthread_mutex_unlock(&c->lock);
}

void cache_release(struct cache *c, const struct face *f)
{
    if (f == NULL)
        return;
    (void)pthread_mutex_lock(&c->lock);
    unref((struct entry *)(uintptr_t)f); /* its first member, never really const */
    (void)pthread_mutex_unlock(&c->lock);
}

void cache_forget(struct cache *c, const char *id)
{
    struct entry *x;

    (void)pthread_mutex_lock(&c->lock);
    c->forgets++;
    x = find(c, id);
    if (x != NULL)
        drop(c, x);
    (void)pthread_mutex_unlock(&c->lock);
}

void cache_look(struct cache *c, struct cache_state *out)
{
    (void)pthread_mutex_lock(&c->lock);
    *out = c->state;
    (void)pthread_mutex_unlock(&c->lock);
}
