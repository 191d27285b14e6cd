#include "quota.h"

#include <stdlib.h>

#define BUCKETS 1024

/* A sender that holds something. */
struct holder {
    uint64_t sender;
    size_t bytes[QUOTA_SIZES];
    struct holder *next; /* next in the bucket */
};

struct quota {
    struct quota_limits limits;
    size_t bytes[QUOTA_SIZES];
    struct holder *bucket[BUCKETS];
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

/* Returns the link to the sender's holder; *link is NULL if the sender holds nothing. */
static struct holder **quota_find(struct quota *q, uint64_t sender)
{
    struct holder **link = &q->bucket[sender % BUCKETS];

    while (*link != NULL && (*link)->sender != sender)
        link = &(*link)->next;
    return link;
}

bool quota_owe(struct quota_share *s, enum quota_size size, size_t bytes)
{
    struct holder **link = quota_find(s->q, s->sender), *h = *link;

    if (h == NULL && bytes == 0)
        return true;
    if (h == NULL) {
        if ((h = calloc(1, sizeof *h)) == NULL)
            return false;
        h->sender = s->sender;
        *link = h;
    }
    h->bytes[s->size] -= s->bytes;
    h->bytes[size] += bytes;
    s->q->bytes[s->size] -= s->bytes;
    s->q->bytes[size] += bytes;
    s->size = size;
    s->bytes = bytes;
    if (h->bytes[QUOTA_IS_SMALL] + h->bytes[QUOTA_IS_LARGE] == 0) {
        *link = h->next;
        free(h);
    }
    return true;
}

bool quota_fits(const struct quota_share *s, enum quota_size size, size_t bytes)
{
    const struct quota_limits *limit = &s->q->limits;
    const struct holder *h = *quota_find(s->q, s->sender);
    const size_t had = size == s->size ? s->bytes : 0;
    const size_t own = h != NULL ? h->bytes[size] : 0;

    return bytes <= had || (own - had + bytes <= limit->one[size] &&
                            s->q->bytes[size] - had + bytes <= limit->all[size]);
}

bool quota_hold(struct quota_share *s, enum quota_size size, size_t bytes)
{
    return quota_fits(s, size, bytes) && quota_owe(s, size, bytes);
}

size_t quota_held(const struct quota *q, enum quota_size size)
{
    return q->bytes[size];
}
