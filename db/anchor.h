/* anchor.h -- a small file outside the database that says how far its chain of changes has come,
 * so that an older copy of the database is found.  It has two places, 4096 bytes apart, each with
 * a MAC under the database's key; what is said next goes into the place that is not in force, so
 * that a torn write leaves what was said before (layout: db/FORMAT.md).
 *
 * It names what is durable in the database already, is written after that and not flushed: after a
 * loss of power it may say less than the database, never more.  Calls wait for one another by a
 * lock on the file, whichever processes make them. */
#ifndef DB_ANCHOR_H
#define DB_ANCHOR_H
#include <stdbool.h>
#include <stdint.h>
#include "store_chain.h"

struct errinfo;

struct anchor_end {                       /* of the chains */
    uint64_t seq;                         /* of the last change, */
    unsigned char hash[STORE_CHAIN_HASH]; /* its hash, */
    uint64_t uses;                        /* and of the last use known then */
};

struct anchor {
    struct anchor_end last; /* the database has it */
    /* or this, if announced: one that takes its place is written */
    struct anchor_end next;
    bool said, announced; /* is there a last, a next? */
    bool served;          /* a daemon has it open, or did when it was killed */
};

/* anchor_read(path, v, out, e): ST_ENOTFOUND; ST_EREFUSED: nothing in it is of the vault's
 * database; ST_EIO, ST_ENOMEM. */
enum status anchor_read(const char *path, const struct vault *v, struct anchor *out,
                        struct errinfo *e);

/* anchor_advance(path, v, end, e): end is durable.  Never goes back: what is there may be
 * further, by another process.  ST_ENOTFOUND; nothing where a next is announced.
 * anchor_set(path, v, end, served, e): this is the last, whatever was said before, and it is
 * flushed; a file that is missing is made.
 * anchor_announce(path, v, next, e): the same, but what was the last is good too, until one of the
 * others is called with what was found. */
enum status anchor_advance(const char *path, const struct vault *v,
                           const struct anchor_end *end, struct errinfo *e);
enum status anchor_set(const char *path, const struct vault *v,
                       const struct anchor_end *end, bool served, struct errinfo *e);
enum status anchor_announce(const char *path, const struct vault *v,
                            const struct anchor_end *next, struct errinfo *e);

/* anchor_mark(path, v, served, e): does a daemon serve the database?  Flushed.  Nothing else of
 * what was said changes. */
enum status anchor_mark(const char *path, const struct vault *v, bool served,
                        struct errinfo *e);

/* anchor_used(path): is there a file that is or was the anchor of some database?  Not one of which
 * nothing but a next was ever announced. */
bool anchor_used(const char *path);

/* anchor_serve(path, alone, e): an open file that says, until it is closed, that a daemon has the
 * database open; -1: ST_EIO.  *alone: no other daemon does.
 * anchor_serves_alone(fd): is it so still? */
int anchor_serve(const char *path, bool *alone, struct errinfo *e);
bool anchor_serves_alone(int fd);

#endif
