#include "cache.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NBUCKETS 4096

/* A model: in a bucket's list and in that of all by last use, newest first.  refs counts its
 * holders, and the cache itself while it is in the lists. */
struct cache_entry {
    struct cache_held held; /* first: cache_release() gets a pointer to it */
    struct surface_face *face;
    char id[STORE_ID_LEN + 1];
    unsigned refs;
    size_t bytes;
    struct cache_entry *chain; /* next in the bucket */
    struct cache_entry *newer, *older;
};

struct cache {
    pthread_mutex_t lock;
    struct cache_entry *bucket[NBUCKETS];
    struct cache_entry *newest, *oldest;
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

static struct cache_entry *cache_find_entry(struct cache *c, const char *id)
{
    struct cache_entry *x = c->bucket[bucket_of(id)];

    while (x != NULL && strcmp(x->id, id) != 0)
        x = x->chain;
    return x;
}

static void link_newest(struct cache *c, struct cache_entry *x)
{
    x->newer = NULL;
    x->older = c->newest;
    if (c->newest != NULL)
        c->newest->newer = x;
    else
        c->oldest = x;
    c->newest = x;
}

static void unlink_age(struct cache *c, struct cache_entry *x)
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
static void unref(struct cache_entry *x)
{
    if (--x->refs == 0) {
        surface_face_free(x->face);
        free(x);
    }
}

static void cache_drop(struct cache *c, struct cache_entry *x)
{
    struct cache_entry **link = &c->bucket[bucket_of(x->id)];

    while (*link != x)
        link = &(*link)->chain;
    *link = x->chain;
    unlink_age(c, x);
    c->state.bytes -= x->bytes;
    c->state.entries--;
    unref(x);
}

struct cache *cache_new(size_t limit)
{
    struct cache *c = calloc(1, sizeof *c);

    if (c == NULL)
        return NULL;
    (void)pthread_mutex_init(&c->lock, NULL);
    c->state.limit = limit;
    return c;
}

void cache_free(struct cache *c)
{
    if (c == NULL)
        return;
    while (c->oldest != NULL)
        cache_drop(c, c->oldest);
    (void)pthread_mutex_destroy(&c->lock);
    free(c);
}

/* Keep x, which its holder alone has so far, unless another worker has loaded the same
 * meanwhile or it does not fit; the lock is held. */
static void take_in(struct cache *c, struct cache_entry *x)
{
    if (cache_find_entry(c, x->id) != NULL || x->bytes > c->state.limit)
        return;
    x->refs++;
    x->chain = c->bucket[bucket_of(x->id)];
    c->bucket[bucket_of(x->id)] = x;
    link_newest(c, x);
    c->state.bytes += x->bytes;
    c->state.entries++;
    while (c->state.bytes > c->state.limit) {
        cache_drop(c, c->oldest);
        c->state.evictions++;
    }
}

const struct cache_held *cache_find(struct cache *c, const char *id)
{
    struct cache_entry *x;

    if (c == NULL)
        return NULL;
    (void)pthread_mutex_lock(&c->lock);
    x = cache_find_entry(c, id);
    if (x != NULL) {
        x->refs++;
        c->state.hits++;
        unlink_age(c, x);
        link_newest(c, x);
    } else {
        c->state.misses++;
    }
    (void)pthread_mutex_unlock(&c->lock);
    return x != NULL ? &x->held : NULL;
}

uint64_t cache_mark(struct cache *c)
{
    uint64_t mark;

    if (c == NULL)
        return 0;
    (void)pthread_mutex_lock(&c->lock);
    mark = c->forgets;
    (void)pthread_mutex_unlock(&c->lock);
    return mark;
}

const struct cache_held *cache_keep(struct cache *c, uint64_t mark, const char *id,
                                    bool reencoded, struct surface_face *f)
{
    struct cache_entry *x = calloc(1, sizeof *x);

    if (x == NULL)
        return NULL;
    x->face = f;
    x->held.face = f;
    (void)snprintf(x->id, sizeof x->id, "%s", id);
    x->refs = 1;
    x->bytes = sizeof *x + surface_face_memory(f);
    if (c == NULL)
        return &x->held;
    (void)pthread_mutex_lock(&c->lock);
    c->state.reencoded += reencoded;
    if (mark == c->forgets)
        take_in(c, x);
    (void)pthread_mutex_unlock(&c->lock);
    return &x->held;
}

void cache_release(struct cache *c, const struct cache_held *held)
{
    struct cache_entry *x =
        (struct cache_entry *)(uintptr_t)held; /* its first member, never const */

    if (held == NULL)
        return;
    if (c != NULL)
        (void)pthread_mutex_lock(&c->lock);
    unref(x);
    if (c != NULL)
        (void)pthread_mutex_unlock(&c->lock);
}

void cache_forget(struct cache *c, const char *id)
{
    struct cache_entry *x;

    (void)pthread_mutex_lock(&c->lock);
    c->forgets++;
    x = cache_find_entry(c, id);
    if (x != NULL)
        cache_drop(c, x);
    (void)pthread_mutex_unlock(&c->lock);
}

char (*cache_list(struct cache *c, size_t *n))[STORE_ID_LEN + 1]
{
    char(*ids)[STORE_ID_LEN + 1];

    *n = 0;
    (void)pthread_mutex_lock(&c->lock);
    c->forgets++;
    ids = calloc(c->state.entries + 1, sizeof *ids);
    for (const struct cache_entry *x = c->newest; ids != NULL && x != NULL; x = x->older)
        memcpy(ids[(*n)++], x->id, sizeof *ids);
    (void)pthread_mutex_unlock(&c->lock);
    return ids;
}

void cache_look(struct cache *c, struct cache_state *out)
{
    (void)pthread_mutex_lock(&c->lock);
    *out = c->state;
    (void)pthread_mutex_unlock(&c->lock);
}
