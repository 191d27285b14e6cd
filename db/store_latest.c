#include "store_latest.h"

#include <stdlib.h>
#include <string.h>

#include "bytes.h"

#define ROOM 1024

void store_latest_init(struct store_latest *l)
{
    (void)pthread_mutex_init(&l->lock, NULL);
}

void store_latest_free(struct store_latest *l)
{
    (void)pthread_mutex_destroy(&l->lock);
    free(l->slot);
}

/* That of the object, or the free one where it goes.  Objects are random already. */
static struct store_latest_slot *place(struct store_latest_slot *slot, size_t room,
                                       const unsigned char *object)
{
    size_t i = (size_t)bytes_number(object, 8) & (room - 1);

    while (slot[i].seq != 0 && memcmp(slot[i].object, object, STORE_CHAIN_OBJECT) != 0)
        i = (i + 1) & (room - 1);
    return &slot[i];
}

/* Twice the room, so that half of it is always free. */
static bool grow(struct store_latest *l)
{
    const size_t room = l->room != 0 ? 2 * l->room : ROOM;
    struct store_latest_slot *slot = calloc(room, sizeof *slot);

    if (slot == NULL)
        return false;
    for (size_t i = 0; i < l->room; i++)
        if (l->slot[i].seq != 0)
            *place(slot, room, l->slot[i].object) = l->slot[i];
    free(l->slot);
    l->slot = slot;
    l->room = room;
    return true;
}

bool store_latest_begin(struct store_latest *l)
{
    bool done;

    (void)pthread_mutex_lock(&l->lock);
    done = l->slot != NULL || grow(l);
    (void)pthread_mutex_unlock(&l->lock);
    return done;
}

bool store_latest_add(struct store_latest *l,
                      const unsigned char object[STORE_CHAIN_OBJECT], uint64_t seq,
                      const unsigned char *row)
{
    bool done = true;

    (void)pthread_mutex_lock(&l->lock);
    if (l->slot != NULL && (done = 2 * l->n < l->room || grow(l))) {
        struct store_latest_slot *s = place(l->slot, l->room, object);

        l->n += s->seq == 0;
        if (seq > s->seq) {
            *s = (struct store_latest_slot){.seq = seq};
            memcpy(s->object, object, STORE_CHAIN_OBJECT);
            if (row != NULL)
                memcpy(s->row, row, STORE_LATEST_ROW);
        }
    }
    (void)pthread_mutex_unlock(&l->lock);
    return done;
}

bool store_latest_find(struct store_latest *l,
                       const unsigned char object[STORE_CHAIN_OBJECT],
                       struct store_latest_slot *out)
{
    bool kept;

    (void)pthread_mutex_lock(&l->lock);
    if ((kept = l->slot != NULL))
        *out = *place(l->slot, l->room, object);
    (void)pthread_mutex_unlock(&l->lock);
    return kept;
}
