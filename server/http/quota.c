#include "quota.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "rows_types.h"

#define BUCKETS 1024

/* A token or an address that holds something. */
struct quota_holder {
    char name[STORE_ID_LEN + 2]; /* a token's id, or an address behind a byte 1 */
    size_t shares;               /* that refer to it */
    size_t bytes[QUOTA_SIZES];
    struct quota_holder *next; /* in the bucket */
};

struct quota {
    struct quota_limits limits;
    size_t bytes[QUOTA_SIZES];
    struct quota_holder *bucket[BUCKETS];
};

struct quota *quota_new(const struct quota_limits *limits)
{
    struct quota *q = calloc(1, sizeof *q);

    if (q != NULL)
        q->limits = *limits;
    return q;
}

void quota_free(struct quota *q)
{
    free(q); /* nothing is held */
}

/* ---- holders */

/* FNV-1a.  Ids are random and an address has to be one's own: nobody chooses collisions. */
static struct quota_holder **bucket_of(struct quota *q, const char *name)
{
    uint32_t h = 2166136261u;

    for (size_t i = 0; i < sizeof((struct quota_holder *)0)->name; i++)
        h = (h ^ (unsigned char)name[i]) * 16777619u;
    return &q->bucket[h % BUCKETS];
}

/* One reference more; NULL: out of memory. */
static struct quota_holder *take(struct quota *q, const char *name)
{
    struct quota_holder **bucket = bucket_of(q, name), *h = *bucket;

    while (h != NULL && memcmp(h->name, name, sizeof h->name) != 0)
        h = h->next;
    if (h == NULL) {
        if ((h = calloc(1, sizeof *h)) == NULL)
            return NULL;
        memcpy(h->name, name, sizeof h->name);
        h->next = *bucket;
        *bucket = h;
    }
    h->shares++;
    return h;
}

static void give_back(struct quota *q, struct quota_holder *h)
{
    struct quota_holder **at;

    if (h == NULL || --h->shares > 0)
        return;
    for (at = bucket_of(q, h->name); *at != h; at = &(*at)->next)
        ;
    *at = h->next;
    free(h);
}

static bool take_holders(struct quota_share *s)
{
    char name[sizeof s->holder[0]->name] = {0};

    if (s->holder[0] != NULL)
        return true;
    name[0] = 1;
    memcpy(name + 1, s->address, THROTTLE_ADDRESS);
    s->holder[0] = take(s->q, name);
    if (s->holder[0] == NULL || s->token[0] == '\0')
        return s->holder[0] != NULL;
    memset(name, 0, sizeof name);
    (void)snprintf(name, sizeof name, "%s", s->token);
    if ((s->holder[1] = take(s->q, name)) != NULL)
        return true;
    give_back(s->q, s->holder[0]);
    s->holder[0] = NULL;
    return false;
}

/* ---- shares */

static void count(struct quota_share *s, enum quota_size size, size_t bytes)
{
    for (int i = 0; i < 2; i++)
        if (s->holder[i] != NULL) {
            s->holder[i]->bytes[s->size] -= s->bytes;
            s->holder[i]->bytes[size] += bytes;
        }
    s->q->bytes[s->size] -= s->bytes;
    s->q->bytes[size] += bytes;
    s->size = size;
    s->bytes = bytes;
}

static bool fits(const struct quota_share *s, enum quota_size size, size_t bytes)
{
    const struct quota_limits *limit = &s->q->limits;
    const size_t had = size == s->size ? s->bytes : 0;

    if (bytes <= had)
        return true;
    for (int i = 0; i < 2; i++)
        if (s->holder[i] != NULL &&
            s->holder[i]->bytes[size] - had + bytes > limit->one[size])
            return false;
    return s->q->bytes[size] - had + bytes <= limit->all[size];
}

bool quota_owe(struct quota_share *s, enum quota_size size, size_t bytes)
{
    if (bytes > 0 && !take_holders(s))
        return false;
    count(s, size, bytes);
    if (bytes == 0)
        for (int i = 0; i < 2; i++) {
            give_back(s->q, s->holder[i]);
            s->holder[i] = NULL;
        }
    return true;
}

bool quota_hold(struct quota_share *s, enum quota_size size, size_t bytes)
{
    const bool nothing = s->bytes == 0;

    if (bytes > 0 && !take_holders(s))
        return false;
    if (fits(s, size, bytes))
        return quota_owe(s, size, bytes);
    if (nothing)
        (void)quota_owe(s, size, 0); /* gives the holders back */
    return false;
}

bool quota_fits(const struct quota_share *s, enum quota_size size, size_t bytes)
{
    struct quota_share same = *s;
    const bool had = s->holder[0] != NULL;
    const bool fit = bytes == 0 || (take_holders(&same) && fits(&same, size, bytes));

    for (int i = 0; i < 2 && !had; i++)
        give_back(s->q, same.holder[i]);
    return fit;
}

size_t quota_held(const struct quota *q, enum quota_size size)
{
    return q->bytes[size];
}
