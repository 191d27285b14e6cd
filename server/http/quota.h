/* quota.h -- limits the bytes of requests and responses that the daemon holds, in all and for each sender
 * (request_sender()).  So a client that sends slowly, or does not read, does not keep other clients out.  Small
 * requests have room of their own that large ones cannot take.  In memory alone; on the I/O thread only. */
#ifndef SERVER_QUOTA_H
#define SERVER_QUOTA_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct quota;

/* Size of a small body: up to 10,000 points, which take 600 KB as JSON with 17 digits a number. */
#define QUOTA_SMALL ((size_t)1 << 20)

enum quota_size { QUOTA_IS_SMALL, QUOTA_IS_LARGE, QUOTA_SIZES };

struct quota_limits {
    size_t all[QUOTA_SIZES]; /* limit in all, bytes */
    size_t one[QUOTA_SIZES]; /* limit of a sender, bytes */
};

/* quota_new(limits): Returns a quota of which nothing is held.  NULL: out of memory. */
struct quota *quota_new(const struct quota_limits *limits);
void quota_free(struct quota *q); /* NULL is allowed */

/* The bytes that one request holds: none if all is zero but q and sender.  The sender stays the same while the
 * request holds some. */
struct quota_share {
    struct quota *q;
    uint64_t sender;
    enum quota_size size;
    size_t bytes;
};

/* quota_hold(s, size, bytes): Sets the share to bytes, if there is room.  Returns false, and leaves s, if there
 * is none, or if out of memory. */
bool quota_hold(struct quota_share *s, enum quota_size size, size_t bytes);

/* quota_owe(s, size, bytes): Sets the share to bytes without checking the limits: for bytes that the daemon
 * already holds.  Returns false if out of memory. */
bool quota_owe(struct quota_share *s, enum quota_size size, size_t bytes);

/* quota_fits(s, size, bytes): Returns true if there is room for quota_hold(). */
bool quota_fits(const struct quota_share *s, enum quota_size size, size_t bytes);

/* quota_held(q, size): Returns the bytes that all hold. */
size_t quota_held(const struct quota *q, enum quota_size size);

#endif
