/* log_entry.h -- the two logs of a database: the change log (enrolled, erased, token made, ...) and
 * the access log (verified, refused, exported).  An entry's hash is of its fields and of the hash
 * before it (the first follows 32 zero bytes); its MAC is of that hash, so that the last entry
 * authenticates the log up to it.  Layout of what is hashed, authenticated and signed:
 * db/FORMAT.md. */
#ifndef DB_LOG_ENTRY_H
#define DB_LOG_ENTRY_H
#include <stdbool.h>
#include <stdint.h>
#include "crypt.h"
#include "status.h"
#include "utc.h"

struct errinfo;

#define LOG_HASH   32
#define LOG_UID    16
#define LOG_TEXT   64 /* bytes of a kind, actor, object, outcome: printable ASCII */
#define LOG_DIGEST 32 /* of all rows with a MAC (log_txn.h) */
/* Each daemon on a database has an access log of its own, so that it waits for no other daemon.  Daemons
 * are numbered in the order in which they joined (admin_join()).  The first one, and the daemon of a
 * database in a file, has the number 0. */
#define LOG_DAEMONS 64

enum log_name { LOG_CHANGES, LOG_ACCESSES, LOGS }; /* hashed, so never renumbered */

/* log_word(log): "changes" or "accesses". */
const char *log_word(enum log_name log);

struct log_act { /* who does something, and when */
    const char *actor;
    int64_t ms; /* since 1970, UTC */
    char at[UTC_TEXT];
};

/* log_act(by, actor, e): actor acts now.  ST_EINVAL: not up to LOG_TEXT printable characters;
 * ST_EINTERNAL: there is no clock. */
enum status log_act(struct log_act *by, const char *actor, struct errinfo *e);

struct log_end { /* of a log; all zero: it is empty */
    uint64_t seq;
    unsigned char hash[LOG_HASH];
};

struct log_entry {
    enum log_name log;
    uint32_t
        daemon; /* whose access log it is in, or, of a change, whose it names the end of */
    uint64_t seq; /* in its log: 1, 2, ... */
    char at[UTC_TEXT];
    char kind[LOG_TEXT + 1], actor[LOG_TEXT + 1];
    unsigned char uid[LOG_UID]; /* of the subject; zeros: of none */
    char object[LOG_TEXT + 1];  /* a template's, token's or device's id */
    char outcome[LOG_TEXT + 1];
    unsigned char hash[LOG_HASH], mac[CRYPT_HASH];
    /* Of changes alone: */
    unsigned char digest[CRYPT_WRAPPED]; /* of the rows after the change, encrypted */
    struct log_end accesses;             /* the end of that access log at that time */
    bool is_signed;
    unsigned char signature[CRYPT_SIGN];
};

/* Kinds of changes with a meaning of their own: a request for a signed entry; an export, which
 * ends with a signed entry; the oldest accesses of a daemon were cut off, up to the one that outcome
 * numbers and whose hash object is, in hexadecimal; one at least is left; a daemon has joined; the
 * end of another daemon's access log, so that a signature covers that too. */
#define LOG_CHECKPOINT "checkpoint"
#define LOG_EXPORT     "export_audit"
#define LOG_TRIM       "trim_accesses"
#define LOG_JOIN       "join"
#define LOG_FOUND      "accesses_found"

/* log_hash(before, entry, out): BLAKE2b-256; out may be before.
 * log_mac(c, hash, out): of an entry with this hash.
 * log_sign(c, entry): its signature, by its hash.
 * log_signed(public, entry): is it the signature of this key? */
void log_hash(const unsigned char before[LOG_HASH], const struct log_entry *entry,
              unsigned char out[LOG_HASH]);
void log_mac(const struct crypt *c, const unsigned char hash[LOG_HASH],
             unsigned char out[CRYPT_HASH]);
void log_sign(const struct crypt *c, struct log_entry *entry);
bool log_signed(const unsigned char public[CRYPT_KEY], const struct log_entry *entry);

/* log_follows(c, at, entry): is it the entry after *at, as it was written by c's key?  Then *at is it. */
bool log_follows(const struct crypt *c, struct log_end *at,
                 const struct log_entry *entry);

/* log_trimmed(entry, to): is it a LOG_TRIM?  to[LOG_DAEMONS]: the access that the rest of that
 * daemon's follows; of the others unchanged.
 * log_trim_text(daemon, seq, out): the outcome of one. */
bool log_trimmed(const struct log_entry *entry, struct log_end *to);
void log_trim_text(uint32_t daemon, uint64_t seq, char out[LOG_TEXT + 1]);

#endif
