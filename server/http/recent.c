#include "recent.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <sodium.h>

#include "errmap.h"
#include "utc.h"

struct recent {
    pthread_mutex_t lock;
    uint64_t last;                          /* seq of the newest; 0: none */
    struct recent_entry entry[RECENT_MOST]; /* seq at (seq - 1) % RECENT_MOST */
};

struct recent *recent_new(void)
{
    struct recent *m = calloc(1, sizeof *m);

    if (m != NULL && pthread_mutex_init(&m->lock, NULL) != 0) {
        free(m);
        return NULL;
    }
    return m;
}

void recent_free(struct recent *m)
{
    if (m == NULL)
        return;
    (void)pthread_mutex_destroy(&m->lock);
    sodium_memzero(m, sizeof *m);
    free(m);
}

void recent_note(struct recent *m, const struct request *r)
{
    const struct request_result *x = &r->result;
    struct recent_entry e = {.scored = x->scored,
                             .score = x->score,
                             .threshold = x->threshold,
                             .overlap = x->overlap};
    const bool refused = r->response.problem != 0;

    if (x->kind == NULL)
        return;
    (void)utc_now(&e.at_ms);
    e.outcome = refused ? "refused" : x->outcome;
    e.code = refused ? errmap_get(r->response.problem)->code : NULL;
    (void)snprintf(e.kind, sizeof e.kind, "%s", x->kind);
    (void)snprintf(e.subject, sizeof e.subject, "%s", r->subject);
    (void)snprintf(e.token_name, sizeof e.token_name, "%s", r->token_name);
    (void)snprintf(e.request_id, sizeof e.request_id, "%s", r->id);
    (void)snprintf(e.detail, sizeof e.detail, "%s", refused ? r->told : "");
    (void)pthread_mutex_lock(&m->lock);
    e.seq = ++m->last;
    m->entry[(e.seq - 1) % RECENT_MOST] = e;
    (void)pthread_mutex_unlock(&m->lock);
}

size_t recent_read(struct recent *m, uint64_t after, size_t most,
                   struct recent_entry *out, uint64_t *last)
{
    size_t n = 0;
    uint64_t from;

    if (most > RECENT_MOST)
        most = RECENT_MOST;
    (void)pthread_mutex_lock(&m->lock);
    from = m->last > most ? m->last - most : 0;
    if (after > from)
        from = after;
    for (uint64_t seq = from + 1; seq <= m->last; seq++)
        out[n++] = m->entry[(seq - 1) % RECENT_MOST];
    *last = m->last;
    (void)pthread_mutex_unlock(&m->lock);
    return n;
}
