/* cache.h -- decoded face models by template id, shared by the workers.
 * The model of a template never changes and its id is never used again (store.h), so an
 * entry cannot be out of date, even if the template is re-encoded.  The caller must ask
 * the store first whether the template still exists: a deleted template must never match,
 * whichever process deleted it.  A NULL cache is empty and keeps nothing: a face given to
 * cache_keep() then belongs to its caller. */
#ifndef SERVICE_CACHE_H
#define SERVICE_CACHE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "libsurface.h"
#include "rows_types.h"

struct cache;

struct cache_held {
    const struct surface_face *face;
};

/* cache_new(limit): room for models of about limit bytes; the least recently used goes
 * first.  0: nothing is kept.  NULL: out of memory. */
struct cache *cache_new(size_t limit);
void cache_free(struct cache *c); /* nothing may be held; NULL is allowed */

/* cache_find(c, id): the model of a template that the caller has seen in the store; NULL: it is
 * not there, and the caller loads it.  Give it back by cache_release(). */
const struct cache_held *cache_find(struct cache *c, const char *id);

/* cache_mark(c): a moment, for cache_keep().
 * cache_keep(c, mark, id, reencoded, f): takes over f, which was read after the mark,
 * and returns it as held by cache_find().  Nobody else finds it where it does not fit, where
 * another has loaded it meanwhile, and where any template was forgotten since the mark: it may
 * be that one.  reencoded: it was made by another engine.  NULL: out of memory; f is still
 * the caller's. */
uint64_t cache_mark(struct cache *c);
const struct cache_held *cache_keep(struct cache *c, uint64_t mark, const char *id,
                                    bool reencoded, struct surface_face *f);

void cache_release(struct cache *c, const struct cache_held *held); /* NULL is allowed */

/* cache_forget(c, id): drops the model, and releases its memory once nobody holds it.  To be
 * called after the store has deleted the template: nobody who reads it just then brings it back. */
void cache_forget(struct cache *c, const char *id);

/* cache_list(c, n): Returns the ids of all *n entries, to be released by free(); NULL: out of
 * memory.  The caller finds out which of these templates other processes have deleted, and calls
 * cache_forget() for them.  The cache does not keep a model that is being read at this moment. */
char (*cache_list(struct cache *c, size_t *n))[STORE_ID_LEN + 1];

struct cache_state {
    size_t bytes, limit, entries;
    uint64_t hits, misses;
    uint64_t evictions; /* dropped for want of room, not forgotten */
    /* of the misses: made by another engine, re-encoded by this one */
    uint64_t reencoded;
};

void cache_look(struct cache *c, struct cache_state *out);

#endif
