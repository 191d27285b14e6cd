#include "idempotency.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sodium.h>

#include "capture.h"
#include "errmap.h"
#include "request.h"

#define NONE   UINT32_MAX /* no entry, no ticket */
#define DIGEST 32
#define DAY_MS (IDEMPOTENCY_HOURS * 3600.0 * 1000.0)

enum state { FREE, RUNNING, DONE };

struct entry {
    enum state state;
    unsigned char key[DIGEST];     /* of token and key */
    unsigned char request[DIGEST]; /* of the request */
    char subject[STORE_SUBJECT_MAX + 1];
    bool erased; /* the subject was, while it ran */
    double since_ms, life_ms;
    uint32_t next;            /* in its bucket */
    struct response response; /* DONE: body is the entry's own */
};

struct idempotency {
    pthread_mutex_t lock;
    unsigned char secret[crypto_generichash_KEYBYTES];
    uint32_t room, oldest, used; /* entries in order of arrival, a ring */
    uint32_t *bucket;            /* room of them */
    size_t bytes;                /* of all bodies */
    struct entry entry[];
};

struct idempotency *idempotency_new(uint32_t room)
{
    struct idempotency *m = calloc(1, sizeof *m + room * sizeof *m->entry);

    if (m == NULL)
        return NULL;
    m->bucket = malloc(room * sizeof *m->bucket);
    if (m->bucket == NULL || pthread_mutex_init(&m->lock, NULL) != 0) {
        free(m->bucket);
        free(m);
        return NULL;
    }
    for (uint32_t i = 0; i < room; i++)
        m->bucket[i] = NONE;
    m->room = room;
    randombytes_buf(m->secret, sizeof m->secret);
    return m;
}

void idempotency_free(struct idempotency *m)
{
    if (m == NULL)
        return;
    for (uint32_t i = 0; i < m->room; i++)
        free(m->entry[i].response.body);
    (void)pthread_mutex_destroy(&m->lock);
    free(m->bucket);
    free(m);
}

/* ---- the table */

static uint32_t *bucket_of(struct idempotency *m, const unsigned char key[DIGEST])
{
    uint32_t h;

    memcpy(&h, key, sizeof h);
    return &m->bucket[h % m->room];
}

static struct entry *find(struct idempotency *m, const unsigned char key[DIGEST])
{
    uint32_t i = *bucket_of(m, key);

    while (i != NONE && memcmp(m->entry[i].key, key, DIGEST) != 0)
        i = m->entry[i].next;
    return i == NONE ? NULL : &m->entry[i];
}

static void wipe(struct idempotency *m, struct response *a)
{
    if (a->body != NULL) {
        sodium_memzero(a->body, a->len);
        m->bytes -= a->len;
    }
    free(a->body);
    a->body = NULL;
    a->len = 0;
}

/* The entry's place in the ring stays until it is the oldest. */
static void forget(struct idempotency *m, struct entry *x)
{
    uint32_t *at = bucket_of(m, x->key), i = (uint32_t)(x - m->entry);

    while (*at != i)
        at = &m->entry[*at].next;
    *at = x->next;
    wipe(m, &x->response);
    *x = (struct entry){.state = FREE};
}

/* Removes the oldest from the ring while it is free, has expired, or takes needed room. */
static void sweep(struct idempotency *m, double now_ms)
{
    while (m->used > 0) {
        struct entry *x = &m->entry[m->oldest];

        if (x->state == RUNNING ||
            (x->state == DONE && m->used < m->room && now_ms - x->since_ms < x->life_ms))
            return;
        if (x->state == DONE)
            forget(m, x);
        m->oldest = (m->oldest + 1) % m->room;
        m->used--;
    }
}

/* NULL: the ring is full behind one that is still running. */
static struct entry *add(struct idempotency *m, const unsigned char key[DIGEST],
                         double now_ms)
{
    uint32_t i, *at = bucket_of(m, key);
    struct entry *x;

    sweep(m, now_ms);
    if (m->used == m->room)
        return NULL;
    i = (m->oldest + m->used++) % m->room;
    x = &m->entry[i];
    x->state = RUNNING;
    x->since_ms = now_ms;
    memcpy(x->key, key, DIGEST);
    x->next = *at;
    *at = i;
    return x;
}

/* ---- requests */

/* m: NULL: by no secret. */
static void digest_key(const struct idempotency *m, const struct request *r,
                       unsigned char out[DIGEST])
{
    crypto_generichash_state h;

    (void)crypto_generichash_init(&h, m == NULL ? NULL : m->secret,
                                  m == NULL ? 0 : sizeof m->secret, DIGEST);
    (void)crypto_generichash_update(&h, (const unsigned char *)r->actor,
                                    strlen(r->actor) + 1); /* with its end */
    (void)crypto_generichash_update(&h, (const unsigned char *)r->key, strlen(r->key));
    (void)crypto_generichash_final(&h, out, DIGEST);
}

static void digest_request(const struct idempotency *m, const struct request *r,
                           unsigned char out[DIGEST])
{
    const unsigned char kind[4] = {(unsigned char)r->method, (unsigned char)r->media,
                                   (unsigned char)r->format, r->capture.bad};
    crypto_generichash_state h;

    (void)crypto_generichash_init(&h, m->secret, sizeof m->secret, DIGEST);
    (void)crypto_generichash_update(&h, kind, sizeof kind);
    (void)crypto_generichash_update(&h, (const unsigned char *)r->target,
                                    strlen(r->target) + 1);
    /* What was signed does not answer for a request that is not, or by another. */
    (void)crypto_generichash_update(&h, (const unsigned char *)r->capture.header,
                                    strlen(r->capture.header) + 1);
    (void)crypto_generichash_update(&h, r->body, r->len);
    (void)crypto_generichash_final(&h, out, DIGEST);
}

/* A copy with a body of its own; false: no memory for it. */
static bool copy_response(const struct response *from, struct response *to)
{
    char *body = NULL;

    if (from->body != NULL) {
        body = malloc(from->len + 1);
        if (body == NULL)
            return false;
        memcpy(body, from->body, from->len + 1);
    }
    *to = *from;
    to->body = body;
    return true;
}

/* The response to a key that is known. */
static void respond_again(struct request *r, const struct entry *x, bool same)
{
    if (!same) {
        request_problem(r, ERRMAP_KEY_REUSED,
                        "this Idempotency-Key was used for another request");
    } else if (x->state == RUNNING) {
        request_problem(r, ERRMAP_KEY_BUSY,
                        "the first request of this Idempotency-Key is not finished yet");
        r->response.retry_after = 1;
    } else if (copy_response(&x->response, &r->response)) {
        r->response.replayed = true;
    } else {
        request_problem(r, ST_ENOMEM, "no memory for the response");
    }
}

bool idempotency_begin(struct idempotency *m, struct request *r, double now_ms,
                       uint32_t *ticket)
{
    unsigned char key[DIGEST], request[DIGEST];
    struct entry *x;

    *ticket = NONE;
    if (r->bad_key) {
        request_problem(r, ERRMAP_PARAMETER,
                        "Idempotency-Key is not one string of 1-%d visible characters",
                        REQUEST_KEY_MAX);
        return false;
    }
    if (r->key[0] == '\0')
        return true;
    digest_key(m, r, key);
    digest_request(m, r, request);
    (void)pthread_mutex_lock(&m->lock);
    x = find(m, key);
    if (x != NULL && x->state == DONE && now_ms - x->since_ms >= x->life_ms) {
        forget(m, x);
        x = NULL;
    }
    if (x != NULL) {
        respond_again(r, x, memcmp(x->request, request, DIGEST) == 0);
    } else if ((x = add(m, key, now_ms)) != NULL) { /* else it is done without */
        memcpy(x->request, request, DIGEST);
        memcpy(x->subject, r->subject, sizeof x->subject);
        x->life_ms = r->capture.header[0] == '\0' ? DAY_MS : STORE_NONCE_LIFE_MS;
        *ticket = (uint32_t)(x - m->entry);
    }
    (void)pthread_mutex_unlock(&m->lock);
    return r->response.http == 0;
}

/* The oldest responses go where all together are too long. */
static void limit_bytes(struct idempotency *m)
{
    for (uint32_t i = 0; m->bytes > IDEMPOTENCY_BYTES && i < m->used; i++) {
        struct entry *x = &m->entry[(m->oldest + i) % m->room];

        if (x->state == DONE && x->response.len > 0)
            forget(m, x);
    }
}

static bool keep(struct idempotency *m, struct entry *x, const struct request *r)
{
    if (x->erased || r->response.http >= 500 || r->response.http == 429 ||
        capture_refused(r) || r->response.len > IDEMPOTENCY_BYTES / 8 ||
        !copy_response(&r->response, &x->response))
        return false;
    x->state = DONE;
    m->bytes += x->response.len;
    limit_bytes(m);
    return true;
}

void idempotency_end(struct idempotency *m, const struct request *r, const char *subject,
                     uint32_t ticket)
{
    struct entry *x;

    if (ticket == NONE)
        return;
    (void)pthread_mutex_lock(&m->lock);
    x = &m->entry[ticket];
    (void)snprintf(x->subject, sizeof x->subject, "%s", subject);
    if (!keep(m, x, r))
        forget(m, x);
    (void)pthread_mutex_unlock(&m->lock);
}

/* Nothing but that the key was used. */
static void empty(struct idempotency *m, struct entry *x)
{
    sodium_memzero(x->subject, sizeof x->subject);
    if (x->response.http < 300)
        wipe(m, &x->response);
    else
        forget(m, x);
}

void idempotency_empty(struct idempotency *m, const struct request *r)
{
    unsigned char key[DIGEST];
    struct entry *x;

    digest_key(m, r, key);
    (void)pthread_mutex_lock(&m->lock);
    if ((x = find(m, key)) != NULL && x->state == DONE)
        empty(m, x);
    (void)pthread_mutex_unlock(&m->lock);
}

void idempotency_erase(struct idempotency *m, const char *subject)
{
    (void)pthread_mutex_lock(&m->lock);
    for (uint32_t i = 0; i < m->used; i++) {
        struct entry *x = &m->entry[(m->oldest + i) % m->room];

        if (x->state == RUNNING) /* the subject of some is not known yet */
            x->erased |= x->subject[0] == '\0' || strcmp(x->subject, subject) == 0;
        else if (x->state == DONE && strcmp(x->subject, subject) == 0)
            empty(m, x);
    }
    (void)pthread_mutex_unlock(&m->lock);
}

void idempotency_name(const struct request *r, char hex[65])
{
    unsigned char name[DIGEST];

    hex[0] = '\0';
    if (r->key[0] == '\0')
        return;
    digest_key(NULL, r, name);
    (void)sodium_bin2hex(hex, 65, name, sizeof name);
}

char (*idempotency_list(struct idempotency *m, size_t *n))[STORE_SUBJECT_MAX + 1]
{
    char(*subjects)[STORE_SUBJECT_MAX + 1];

    *n = 0;
    (void)pthread_mutex_lock(&m->lock);
    subjects = calloc(m->used + 1, sizeof *subjects);
    for (uint32_t i = 0; subjects != NULL && i < m->used; i++) {
        const struct entry *x = &m->entry[(m->oldest + i) % m->room];

        if (x->state == DONE && x->subject[0] != '\0')
            memcpy(subjects[(*n)++], x->subject, sizeof *subjects);
    }
    (void)pthread_mutex_unlock(&m->lock);
    return subjects;
}
