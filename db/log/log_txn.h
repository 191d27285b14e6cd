/* log_txn.h -- a transaction on an authenticated database: it sees nothing older than its process
 * has seen before, and what it changes ends with an entry in the change log.
 *
 * Each row of a table with a MAC (rows_table.h) adds a keyed hash of its MAC to the digest, a sum
 * modulo 2^256 that each change entry carries, encrypted: who knew the summands could combine rows
 * of different times.  An entry's digest follows from the one before it and from what the
 * transaction changed, never from the rows as they are read: a row that was put back, hidden or
 * doubled stays a difference between the last entry and the rows, whatever is written later. */
#ifndef DB_LOG_TXN_H
#define DB_LOG_TXN_H
#include <pthread.h>
#include <stdatomic.h>
#include "log_entry.h"
#include "sql.h"

struct log { /* what this process has seen of an open database */
    pthread_mutex_t lock;
    struct log_end newest; /* of the change log; seq 0: nothing yet */
    struct log_end found;  /* the end of the daemon's accesses, by its last change seen */
    uint32_t daemon;       /* whose accesses it writes */
    atomic_bool erasure;   /* another process has erased something */
};

/* What sql_lock() takes, in this order: all changes; a subject's attempts; a token's; a daemon's
 * accesses.  Different subjects or tokens may share a lock. */
#define LOG_LOCK_CHANGES          0U
#define LOG_LOCK_SUBJECT(k)       (0x40000000U + (uint32_t)(k) % 0x40000000U)
#define LOG_LOCK_TOKEN(k)         (0x80000000U + (uint32_t)(k) % 0x40000000U)
#define LOG_LOCK_ACCESSES(daemon) (1U + (daemon))

struct log_txn {
    struct log *log;
    struct sql_txn *sql;
    const struct crypt *crypt;
    enum sql_begin how;
    struct log_end changes;  /* the change log's end, with what it has added itself */
    struct log_end accesses; /* the end of its accesses, by its last known change */
    struct log_end uses;     /* and as it is now; seq 0: not read yet, or it is empty */
    struct log_end before;   /* what this process had seen when it began */
    unsigned char wrapped[CRYPT_WRAPPED]; /* digest of that entry, */
    unsigned char digest[LOG_DIGEST];     /* and decrypted, with what was changed since */
    bool known;                           /* digest is set */
    bool appends;                         /* log_txn_appends() was called */
    bool unlogged;                        /* rows were changed after the last entry */
    bool settled;                         /* sql_settle() was called */
    enum log_name added; /* the log of the last entry that it has added, LOGS: none */
};

void log_init(struct log *l);
void log_free(struct log *l);

/* log_newest(l): to be asked before the SQL transaction begins, which then sees that entry: `before`.
 * log_txn_begin(t, e): log, sql, crypt, how and before are set.  ST_EREFUSED: the database is
 * older than `before`, or another one; ST_ECORRUPT: the last entry is missing, is not what was
 * written or has no good MAC.
 * O(entries since `before`).
 * log_txn_create(t): instead, of a new database.
 * log_txn_check(t, e): to be called before a commit.  ST_EINTERNAL: rows were changed without an
 * entry.
 * log_txn_prove(t): sql_prove() by an entry that it has added.
 * log_txn_committed(t): the end of the log that t made is durable, or will be. */
struct log_end log_newest(struct log *l);
enum status log_txn_begin(struct log_txn *t, struct errinfo *e);
void log_txn_create(struct log_txn *t);
enum status log_txn_check(const struct log_txn *t, struct errinfo *e);
void log_txn_prove(struct log_txn *t);
void log_txn_committed(struct log_txn *t);

/* log_txn_count(t, minus, plus, e): a row with the MAC `minus` is gone, one with the MAC `plus`
 * was added; NULL for neither.  ST_ECORRUPT: the last entry's digest cannot be decrypted.
 * log_txn_sum(c, minus, plus, sum): the same for any sum of rows' summands.
 * log_txn_agrees(t, sum, same, e): is sum the digest of the last entry?
 * log_txn_accept(t, sum): it is from now on. */
enum status log_txn_count(struct log_txn *t, const unsigned char *minus,
                          const unsigned char *plus, struct errinfo *e);
void log_txn_sum(const struct crypt *c, const unsigned char *minus,
                 const unsigned char *plus, unsigned char sum[LOG_DIGEST]);
enum status log_txn_agrees(struct log_txn *t, const unsigned char sum[LOG_DIGEST],
                           bool *same, struct errinfo *e);
void log_txn_accept(struct log_txn *t, const unsigned char sum[LOG_DIGEST]);

/* log_change(t, by, kind, uid, object, outcome, e): append to the change log; signed where kind
 * is LOG_CHECKPOINT or LOG_EXPORT.  uid: NULL for no subject.
 * log_access(t, by, kind, uid, object, outcome, e): append to the daemon's access log.  ST_ECORRUPT:
 * its last entry has no good MAC, or is an earlier one than the last change found there.
 * log_found(t, by, daemon, to, e): a change that names the end of another daemon's accesses, where the
 * last that did names an earlier one.  *to: that end, 0 of t's own daemon.
 * log_txn_appends(t, e): takes the lock of the accesses now, that log_access() takes otherwise.
 * log_txn_ahead(t): before log_txn_begin(), while sql_ahead() is on: what these will read.
 * log_has(t, at, has, e): has the change log this entry, and each after it as it was written, up to
 * the end that t has seen?  All zero: each from the first on.  O(entries since). */
enum status log_change(struct log_txn *t, const struct log_act *by, const char *kind,
                       const unsigned char *uid, const char *object, const char *outcome,
                       struct errinfo *e);
enum status log_access(struct log_txn *t, const struct log_act *by, const char *kind,
                       const unsigned char *uid, const char *object, const char *outcome,
                       struct errinfo *e);
enum status log_txn_appends(struct log_txn *t, struct errinfo *e);
void log_txn_ahead(struct log_txn *t);
enum status log_found(struct log_txn *t, const struct log_act *by, uint32_t daemon,
                      uint64_t *to, struct errinfo *e);
enum status log_has(struct log_txn *t, const struct log_end *at, bool *has,
                    struct errinfo *e);

#endif
