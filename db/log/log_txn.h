/* log_txn.h -- a transaction on an authenticated database.  It sees no older state than its process has
 * seen before, and its changes end with an entry in the change log.
 *
 * The digest is a sum modulo 2^256: each row of a table with a MAC (rows_table.h) adds a keyed hash of
 * its MAC.  Each change entry carries the digest, encrypted: an attacker who knew the summands could
 * combine rows of different times.  An entry's digest is computed from the digest of the entry before
 * it and the transaction's changes, never from the stored rows.  A row that was rolled back, is missing
 * from an index or is a duplicate therefore stays a difference between the last entry and the rows,
 * regardless of later writes. */
#ifndef DB_LOG_TXN_H
#define DB_LOG_TXN_H
#include <pthread.h>
#include <stdatomic.h>
#include "groups.h"
#include "log_entry.h"
#include "sql.h"

struct log { /* the newest state of an open database that this process has seen */
    pthread_mutex_t lock;
    struct log_end newest; /* newest end of the change log; seq 0: none seen yet */
    struct log_end
        found;       /* end of this daemon's access log that its last seen change names */
    uint32_t daemon; /* number of this daemon, and of its access log */
    atomic_bool erasure; /* another process has erased rows, which are to be scrubbed */
};

/* The keys of sql_lock(), to be taken in this order: all changes; a subject's attempts; a token's
 * attempts; a daemon's access log.  Different subjects or tokens may share a lock. */
#define LOG_LOCK_CHANGES          0U
#define LOG_LOCK_SUBJECT(k)       (0x40000000U + (uint32_t)(k) % 0x40000000U)
#define LOG_LOCK_TOKEN(k)         (0x80000000U + (uint32_t)(k) % 0x40000000U)
#define LOG_LOCK_ACCESSES(daemon) (1U + (daemon))

struct log_txn {
    struct log *log;
    struct sql_txn *sql;
    const struct crypt *crypt;
    enum sql_begin how;
    struct log_act by; /* of its entries */
    struct log_end
        changes; /* end of the change log, with the entries of this transaction */
    struct log_end
        accesses; /* end of the daemon's access log that its last known change names */
    struct log_end uses;   /* present end of that access log; seq 0: not read, or empty */
    struct log_end before; /* log_newest() before the transaction began */
    unsigned char
        wrapped[CRYPT_WRAPPED]; /* encrypted digest of the last entry at the begin */
    unsigned char
        digest[LOG_DIGEST]; /* its plain digest, with the changes made since; see known */
    bool known;             /* digest is set */
    bool appends;           /* log_txn_appends() was called */
    bool unlogged;          /* rows were changed after the last entry */
    bool settled;           /* sql_settle() was called */
    /* Groups that its actor is bound to (store_actor_may()); "": it is not bound.  Subjects of other groups do
     * not exist for the transaction: rows_subject_find(), rows_template_get(), rows_token_get(). */
    char groups[GROUPS_SIZE];
    enum log_name
        added; /* log of the last entry of this transaction; LOGS: no entry yet */
};

/* log_init(l), log_free(l): Begins and ends the use of *l. */
void log_init(struct log *l);
void log_free(struct log *l);

/* log_newest(l): Returns the newest end of the change log that this process has seen.  Call it before the
 * SQL transaction begins: the transaction then sees that entry.  The result goes into t->before. */
struct log_end log_newest(struct log *l);

/* log_txn_begin(t, e): Reads the end of the change log, and checks that the log continues t->before.
 *   t  the caller has set log, sql, crypt, how, by, before, and added to LOGS
 * Cost: O(entries since t->before).
 * Returns ST_OK; ST_EREFUSED: the database is older than t->before, or another one; ST_ECORRUPT: the
 * last entry is missing, was modified or has no valid MAC. */
enum status log_txn_begin(struct log_txn *t, struct errinfo *e);

/* log_txn_create(t): Replaces log_txn_begin() in the transaction that creates a database. */
void log_txn_create(struct log_txn *t);

/* log_txn_check(t, e): Checks, before a commit, that each change of rows has an entry.  ST_EINTERNAL: rows
 * were changed after the last entry. */
enum status log_txn_check(const struct log_txn *t, struct errinfo *e);

/* log_txn_prove(t): Calls sql_prove() with the last entry that t has added.  Without one does nothing. */
void log_txn_prove(struct log_txn *t);

/* log_txn_committed(t): Records in t->log that the changes of t are committed. */
void log_txn_committed(struct log_txn *t);

/* log_txn_count(t, minus, plus, e): Updates the digest of t for a changed row.
 *   minus  MAC of the row that was removed or replaced; NULL: none
 *   plus   MAC of the row that was added, or the new MAC of the replaced row; NULL: none
 * ST_ECORRUPT: the digest of the last entry cannot be decrypted. */
enum status log_txn_count(struct log_txn *t, const unsigned char *minus,
                          const unsigned char *plus, struct errinfo *e);

/* log_txn_sum(c, minus, plus, sum): Updates *sum, any sum of the summands of rows, for a changed row as
 * log_txn_count() updates the digest. */
void log_txn_sum(const struct crypt *c, const unsigned char *minus,
                 const unsigned char *plus, unsigned char sum[LOG_DIGEST]);

/* log_txn_agrees(t, sum, same, e): Sets *same to true if sum is the digest of t: the digest of the last
 * entry, with the changes since.  ST_ECORRUPT: as log_txn_count(). */
enum status log_txn_agrees(struct log_txn *t, const unsigned char sum[LOG_DIGEST],
                           bool *same, struct errinfo *e);

/* log_txn_accept(t, sum): Makes sum the digest of t, for the next entry to carry. */
void log_txn_accept(struct log_txn *t, const unsigned char sum[LOG_DIGEST]);

/* log_change(t, kind, uid, object, outcome, e): Appends an entry to the change log.  The entry is signed
 * if kind is LOG_CHECKPOINT or LOG_EXPORT.
 *   uid  of the subject; NULL: no subject */
enum status log_change(struct log_txn *t, const char *kind, const unsigned char *uid,
                       const char *object, const char *outcome, struct errinfo *e);

/* log_access(t, kind, uid, object, outcome, e): Appends an entry to this daemon's access log.  Takes the
 * lock of the access log, unless log_txn_appends() did.  uid as in log_change().
 * ST_ECORRUPT: the log's last entry has no valid MAC, or is earlier than the end that this daemon's
 * last change names. */
enum status log_access(struct log_txn *t, const char *kind, const unsigned char *uid,
                       const char *object, const char *outcome, struct errinfo *e);

/* log_txn_appends(t, e): Takes the lock of this daemon's access log at once, for a later log_access(). */
enum status log_txn_appends(struct log_txn *t, struct errinfo *e);

/* log_txn_ahead(t): Sends the query for the end of the access log, while sql_ahead() is on. */
void log_txn_ahead(struct log_txn *t);

/* log_found(t, daemon, to, e): Appends a change that names the present end of another daemon's access
 * log, if the last change that names one names an earlier end.
 *   to  receives the number of the named entry; 0 if daemon is t's own, whose changes all name its end */
enum status log_found(struct log_txn *t, uint32_t daemon, uint64_t *to,
                      struct errinfo *e);

/* log_has(t, at, has, e): Sets *has to true if the change log has the entry *at, and all entries after it
 * are authentic up to the end that t has seen.
 *   at  all zero: all entries from the first on are checked
 * Cost: O(entries after *at). */
enum status log_has(struct log_txn *t, const struct log_end *at, bool *has,
                    struct errinfo *e);

#endif
