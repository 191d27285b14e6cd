/* log_entry.h -- the two logs of a database: the change log (enrolled, erased, token made, ...) and
 * the access log (verified, refused, exported).  An entry's hash covers its fields and the hash of the
 * entry before it (the first entry follows 32 zero bytes).  Its MAC covers that hash, so that the last
 * entry authenticates the whole log.  The layout of the hashed, authenticated and signed bytes is in
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
#define LOG_DIGEST 32 /* bytes of the digest of all rows with a MAC (log_txn.h) */
/* Each daemon on a database has an access log of its own, so that it waits for no other daemon.  Daemons
 * are numbered in the order in which they joined (admin_join()).  The first one, and the daemon of a
 * database in a file, has the number 0. */
#define LOG_DAEMONS 64

enum log_name { LOG_CHANGES, LOG_ACCESSES, LOGS }; /* hashed, so never renumbered */

/* log_word(log): "changes" or "accesses". */
const char *log_word(enum log_name log);

struct log_act {       /* actor and time of an entry */
    const char *actor; /* id of a token, or name; borrowed */
    int64_t ms;        /* time, ms since 1970, UTC */
    char at[UTC_TEXT]; /* the same time as text */
};

/* log_act(by, actor, e): Sets *by to actor and the present time.  ST_EINVAL: actor is longer than LOG_TEXT
 * characters, or not printable; ST_EINTERNAL: the clock cannot be read. */
enum status log_act(struct log_act *by, const char *actor, struct errinfo *e);

struct log_end {                  /* last entry of a log; all zero: the log is empty */
    uint64_t seq;                 /* number of the entry */
    unsigned char hash[LOG_HASH]; /* hash of the entry */
};

struct log_entry {
    enum log_name log;
    uint32_t
        daemon;   /* number of the daemon with this access log; changes: see accesses */
    uint64_t seq; /* number in its log: 1, 2, ... */
    char at[UTC_TEXT];
    char kind[LOG_TEXT + 1], actor[LOG_TEXT + 1];
    unsigned char uid[LOG_UID]; /* uid of the subject; zeros: no subject */
    char object[LOG_TEXT + 1];  /* id of a template, token or device */
    char outcome[LOG_TEXT + 1];
    unsigned char hash[LOG_HASH], mac[CRYPT_HASH];
    /* Only in changes: */
    unsigned char digest[CRYPT_WRAPPED]; /* encrypted digest of all rows after it */
    struct log_end accesses;             /* end of daemon's access log at that time */
    bool is_signed;
    unsigned char signature[CRYPT_SIGN];
};

/* Kinds of changes with a meaning of their own.
 * LOG_CHECKPOINT: a signed entry, made on request.
 * LOG_EXPORT: an export, which ends with this signed entry.
 * LOG_TRIM: the oldest accesses of a daemon were deleted, at least one is left.  outcome has the number
 * of the last deleted entry, object its hash in hexadecimal.
 * LOG_JOIN: a daemon has joined.
 * LOG_FOUND: names the end of another daemon's access log, so that a signature covers this log too. */
#define LOG_CHECKPOINT "checkpoint"
#define LOG_EXPORT     "export_audit"
#define LOG_TRIM       "trim_accesses"
#define LOG_JOIN       "join"
#define LOG_FOUND      "accesses_found"

/* log_hash(before, entry, out): Computes the hash of entry, which follows an entry with the hash before
 * (BLAKE2b-256).  out may be before. */
void log_hash(const unsigned char before[LOG_HASH], const struct log_entry *entry,
              unsigned char out[LOG_HASH]);

/* log_mac(c, hash, out): Computes the MAC of an entry with this hash. */
void log_mac(const struct crypt *c, const unsigned char hash[LOG_HASH],
             unsigned char out[CRYPT_HASH]);

/* log_sign(c, entry, with): Signs the seq, at and hash of entry, and a text with them.
 *   with  digest of a receipt, in hexadecimal; "": a signature in the log */
void log_sign(const struct crypt *c, struct log_entry *entry, const char *with);

/* log_signed(public, entry, with): Returns true if entry has a valid signature by this key, made by log_sign(). */
bool log_signed(const unsigned char public[CRYPT_KEY], const struct log_entry *entry,
                const char *with);

/* log_follows(c, at, entry): Returns true if entry directly follows *at and its hash and MAC verify with c;
 * then sets *at to entry. */
bool log_follows(const struct crypt *c, struct log_end *at,
                 const struct log_entry *entry);

/* log_trimmed(entry, to): Returns true if entry is a LOG_TRIM.
 *   to  [LOG_DAEMONS]; the element of the trimmed daemon receives its last deleted access, which the
 *       remaining ones follow; the other elements are not changed */
bool log_trimmed(const struct log_entry *entry, struct log_end *to);

/* log_trim_text(daemon, seq, out): Writes the outcome of a LOG_TRIM. */
void log_trim_text(uint32_t daemon, uint64_t seq, char out[LOG_TEXT + 1]);

#endif
