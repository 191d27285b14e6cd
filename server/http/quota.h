/* quota.h -- how many bytes of requests and responses the daemon holds: in all, and for
 * each sender (request_sender()), so that a client that sends much and slowly, or does
 * not read, keeps no other client else out.  What is small has room of its own that what
 * is large cannot take.  In memory alone; on the I/O thread only. */
#ifndef SERVER_QUOTA_H
#define SERVER_QUOTA_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct quota;

/* Room for bodies of up to 10,000 points: as JSON with 17 digits a number they take 600 KB. */
#define QUOTA_SMALL ((size_t)1 << 20)

enum quota_size { QUOTA_IS_SMALL, QUOTA_IS_LARGE, QUOTA_SIZES };

struct quota_limits {
    size_t all[QUOTA_SIZES]; /* bytes */
    size_t one[QUOTA_SIZES]; /* of them a sender */
};

/* quota_new(limits): NULL: out of memory. */
struct quota *quota_new(const struct quota_limits *limits);
void quota_free(struct quota *q); /* NULL is allowed */

/* What one request holds; all zero but q and sender is nothing.  The sender stays while it holds
 * something. */
struct quota_share {
    struct quota *q;
    uint64_t sender;
    enum quota_size size;
    size_t bytes;
};

/* quota_hold(s, size, bytes): s now holds bytes bytes instead of the previous number; 0:
 * none. False, and s is as before: there is no room for more, or no memory.
 * quota_owe(s, size, bytes): the same, but whether there is room is not asked: what the
 * daemon has already.  False: no memory. */
bool quota_hold(struct quota_share *s, enum quota_size size, size_t bytes);
bool quota_owe(struct quota_share *s, enum quota_size size, size_t bytes);

/* quota_fits(s, size, bytes): would quota_hold() do it?  It changes nothing. */
bool quota_fits(const struct quota_share *s, enum quota_size size, size_t bytes);

/* quota_held(q, size): by all. */
size_t quota_held(const struct quota *q, enum quota_size size);

#endif
