/* cache.h -- decoded face models by template id, shared by the workers.
 * The model of a template never changes and its id is never used again (store.h), so an entry
 * cannot be out of date, even if the template is re-encoded.  The caller must ask the store
 * first whether the template still exists: a deleted template must never match, whichever
 * process deleted it. */
#ifndef SERVER_CACHE_H
#define SERVER_CACHE_H
#include <stddef.h>
#include <stdint.h>
#include "face.h"
#include "status.h"

struct cache;
struct errinfo;
struct store;

/* cache_new(limit): room for models of about limit bytes; the least recently used goes
 * first.  0: nothing is kept, every hold loads.  NULL: out of memory. */
struct cache *cache_new(size_t limit);
void cache_free(struct cache *c); /* nothing may be held; NULL is allowed */

/* cache_hold(c, s, id, w, out, e): the model of template id, from the cache or else loaded
 * from s; the caller has seen that the template is there.  Give it back by cache_release().
 * Returns as store_template_load(). */
enum status cache_hold(struct cache *c, struct store *s, const char *id,
                       struct face_work *w, const struct face **out, struct errinfo *e);
void cache_release(struct cache *c, const struct face *f); /* NULL is allowed */

/* cache_load(c, s, id, w): loads the model ahead; a cache_hold() of it waits for this load.
 * Does nothing if the model is in the cache or being loaded, or if nothing is kept.  A failure
 * is not reported: cache_hold() tries again and reports it. */
void cache_load(struct cache *c, struct store *s, const char *id, struct face_work *w);

/* cache_forget(c, id): drops the model, and releases its memory once nobody holds it.  To be
 * called after the store has deleted the template: no load that is running brings it back. */
void cache_forget(struct cache *c, const char *id);

struct cache_state {
    size_t bytes, limit, entries;
    uint64_t hits, misses;
    uint64_t evictions; /* dropped for want of room, not forgotten */
    uint64_t reencoded; /* of the misses: made by another engine, re-encoded by this one */
};

void cache_look(struct cache *c, struct cache_state *out);

#endif
