/* store_txn.h -- an open store, and its transactions. */
#ifndef DB_STORE_TXN_H
#define DB_STORE_TXN_H
#include <stdatomic.h>
#include "errinfo.h"
#include "log_txn.h"
#include "rows_types.h"

struct store_limits; /* store_attempts.h */
struct store_worst;

struct newfile;       /* newfile.h */
struct surface_model; /* libsurface.h */
struct rows_subject;  /* rows_subject.h */
struct rows_table;    /* rows_table.h */
struct store_receipt; /* store.h */

struct store {
    struct sql *sql;
    char *path; /* path or URL of the database */
    const struct surface_model
        *model; /* model of new templates, borrowed: store_use_model() */
    char made_by[SURFACE_ENGINE_SIZE]; /* surface_engine() of model */
    struct crypt *crypt;               /* opened keys of the database */
    struct log log;
    char *anchor;                    /* file of the anchor; NULL: no anchor */
    pthread_mutex_t anchor_lock;     /* held to write the anchor, which may take long */
    pthread_mutex_t anchor_why_lock; /* held briefly, to read or write anchor_why */
    atomic_uint_least64_t anchored;  /* number of a change that the anchor has reached */
    struct errinfo anchor_why;       /* why the anchor lags; code ST_OK: it does not */
    bool anchor_left;                /* the anchor's file is still named PATH.part */
    atomic_bool verified;            /* the rows were verified against the digest */
    atomic_bool unread;              /* the last verification of the rows has failed */
    bool open;                       /* store_open() has succeeded */
    atomic_bool
        behind; /* a server lacks a change, and there is an anchor: store_behind() */
    /* The ST_EREFUSED that all transactions now fail with; set once, then read by any thread. */
    struct errinfo refusal;
    atomic_flag refusing; /* a thread has begun to write refusal */
    atomic_bool refused;  /* refusal is complete */
};

/* The locks of a transaction that makes no entry in the change log.  It does not wait for changes, only
 * for transactions that use the same subject or token, or append to the same access log. */
struct store_use {
    int64_t
        subject; /* key of the subject whose attempts it reads and writes; 0: no subject */
    const char *token; /* token whose attempts on all subjects it uses; NULL: no token */
    bool appends;      /* it appends to the access log */
};

/* store_begin(s, how, t, e): Begins a transaction t, to be ended by store_end().  A transaction that
 * writes is the only one that does (LOG_LOCK_CHANGES), except with SQL_TRY.  Before the first write of
 * an open store it verifies the rows.
 * Returns as sql_begin(), log_txn_begin() and store_txn_verify(); ST_EBUSY: SQL_TRY, and the rows are
 * not verified yet; ST_EREFUSED: the database is another one than the one that was opened, or an older
 * state of it, or its rows do not match the last change. */
enum status store_begin(struct store *s, enum sql_begin how, struct log_txn *t,
                        struct errinfo *e);

/* store_begin_use(s, actor, how, use, t, e): Begins a transaction with the locks of *use instead of LOG_LOCK_CHANGES.
 * Verifies the rows before if they were not verified yet.  Sets t->by to actor (NULL: none) and the present time.
 * Returns as store_begin(), or ST_EINVAL: actor is not as log_act() wants it. */
enum status store_begin_use(struct store *s, const char *actor, enum sql_begin how,
                            const struct store_use *use, struct log_txn *t,
                            struct errinfo *e);

/* store_start(s, actor, how, use, t, e): The first step of store_begin_use(), or, if use is NULL, of store_begin():
 * begins t and takes its locks.  The caller may then call store_read_ahead(), and nothing else, until
 * store_check(). */
enum status store_start(struct store *s, const char *actor, enum sql_begin how,
                        const struct store_use *use, struct log_txn *t,
                        struct errinfo *e);

/* store_read_ahead(t, read, arg): Sends the queries of read(arg, NULL) ahead, between store_start() and
 * store_check(), and, in a transaction that writes, the query for the end of the access log.  After
 * store_check() the caller calls read(arg, e), which receives the rows: all in one round trip.
 *   read  asks sql_goes_on() before each query but the first, and makes no changes */
typedef enum status store_read(void *arg, struct errinfo *e);
void store_read_ahead(struct log_txn *t, store_read *read, void *arg);

/* store_check(s, t, e): The second step of store_begin(): checks the database.  After a failure t has
 * ended.  Returns as store_begin(). */
enum status store_check(struct store *s, struct log_txn *t, struct errinfo *e);

/* store_end(s, t, st, e): Ends t: commits it if st is ST_OK, else rolls it back.  After a durable commit
 * advances the anchor.  Returns as sql_end(); ST_EINTERNAL: rows were changed without an entry. */
enum status store_end(struct store *s, struct log_txn *t, enum status st,
                      struct errinfo *e);

/* store_commit(s, t, anchor, what, e): Commits t, then gives a new anchor its name.  If the commit fails it may
 * have been done all the same (a server that was lost amid it, a WAL whose flush failed): the part of the
 * anchor then stays, as the database may need it.
 *   anchor  of log_anchor_prepare(); NEWFILE_NONE: none.  Is released
 *   what    done by the commit, for the message if the anchor cannot be put in its place */
enum status store_commit(struct store *s, struct log_txn *t, struct newfile *anchor,
                         const char *what, struct errinfo *e);

/* store_txn_may_pass(st): Returns true if st is a temporary error of the database engine: a lock, a lost
 * server, a full disk, no memory. */
bool store_txn_may_pass(enum status st);

/* store_txn_verify(t, report, arg, e): Verifies all rows with a MAC against the digest of the last
 * change, and the indexes.  Calls report() (NULL is allowed) once for each problem.  ST_EREFUSED: a
 * difference was found.  Any other error: the rows could not be read and were not verified. */
enum status store_txn_verify(struct log_txn *t, store_report *report, void *arg,
                             struct errinfo *e);

/* store_txn_verify_alone(s, report, arg, e): Runs store_txn_verify() in a transaction of its own: store_verify(). */
enum status store_txn_verify_alone(struct store *s, store_report *report, void *arg,
                                   struct errinfo *e);

/* store_txn_refused(s, e): Is store_refused(). */
bool store_txn_refused(struct store *s, struct errinfo *e);

/* store_list(s, table, size, list, n, e): Runs rows_table_all() in a transaction of its own. */
enum status store_list(struct store *s, const struct rows_table *table, size_t size,
                       void **list, size_t *n, struct errinfo *e);

/* store_scrub(s): Removes deleted bytes from the file and its WAL, after an erasure. */
void store_scrub(struct store *s);

/* store_settle_anchor(s, path, e): Renames PATH.part to PATH if PATH.part, and not PATH, is the anchor of s.
 * Otherwise a new part would replace it.
 *   s     was opened without an anchor
 *   path  of the anchor; NULL: does nothing
 * Returns as store_begin(); ST_EIO: the file could not be renamed. */
enum status store_settle_anchor(struct store *s, const char *path, struct errinfo *e);

/* store_actor_may(t, e): Checks that the token of t->by is still valid, and sets t->groups to its groups.  A
 * client can make a request as long as it likes, and its token may be revoked or may expire between its
 * start and its write.  Actors that are not tokens always pass, and are not bound.  ST_ETOKEN: revoked, or expired. */
enum status store_actor_may(struct log_txn *t, struct errinfo *e);

/* store_act_begin(s, actor, how, t, e): Runs store_begin() for actor, and store_actor_may().  On failure t has
 * ended. */
enum status store_act_begin(struct store *s, const char *actor, enum sql_begin how,
                            struct log_txn *t, struct errinfo *e);

/* store_lock_subject(t, key, e): Takes the lock of a subject's attempts.  A change that writes to them
 * takes it too, before it writes anything of the subject, and before store_lock_token(). */
enum status store_lock_subject(struct log_txn *t, int64_t key, struct errinfo *e);

/* store_lock_token(t, token, e): Takes the lock of a token's attempts, as store_lock_subject(). */
enum status store_lock_token(struct log_txn *t, const char *token, struct errinfo *e);

/* store_erase_rows(t, of, outcome, out, e): Deletes the subject's row and the rows of its templates, and
 * appends an entry to the change log for each row.
 *   out  receives the templates' ids; NULL is allowed */
enum status store_erase_rows(struct log_txn *t, const struct rows_subject *of,
                             const char *outcome, struct store_receipt *out,
                             struct errinfo *e);

/* ---- times, random ids, limits */

/* store_attempts_longest(t, subject, l, now, out, e): As store_attempts_worst(), inside the transaction t, at the
 * time now. */
enum status store_attempts_longest(struct log_txn *t, const struct store_subject *subject,
                                   const struct store_limits *l, int64_t now,
                                   struct store_worst *out, struct errinfo *e);

/* store_rules_random(out, bytes): Writes 2 * bytes random hexadecimal digits and a NUL.
 *   bytes  at most 32 */
void store_rules_random(char *out, size_t bytes);

/* store_rules_now(ms, e): Sets *ms to the time (utc_now()).  ST_EINTERNAL: the clock cannot be read. */
enum status store_rules_now(int64_t *ms, struct errinfo *e);

/* store_rules_past(at, ms): Returns true if the time `at` is not after ms, or is malformed.  Returns false
 * for "", which means never. */
bool store_rules_past(const char *at, int64_t ms);

/* store_rules_recent(at, ms): Returns true if `at` is a time in the minute before ms.  A time after ms was
 * written before the clock was set back, and is not recent. */
bool store_rules_recent(const char *at, int64_t ms);

/* store_rules_within(t, list, e): Checks that the actor of t may give these groups to a subject or a token: if it
 * is bound, they are some of its own.  ST_EDENIED. */
enum status store_rules_within(const struct log_txn *t, const char *list,
                               struct errinfo *e);

/* store_rules_groups(t, list, e): Decides the groups of a new subject or token: list, or, if it is "", the groups
 * of the actor of t.  Returns as store_rules_within(). */
enum status store_rules_groups(const struct log_txn *t, char list[GROUPS_SIZE],
                               struct errinfo *e);

/* store_rules_shown(t, one): Leaves in one->groups those that the actor of t may know. */
void store_rules_shown(const struct log_txn *t, struct store_subject *one);

/* store_rules_room(subject, templates, e): Checks that a subject with this many templates may have one
 * more.  ST_EFULL: it has STORE_TEMPLATES_MAX. */
enum status store_rules_room(const char *subject, size_t templates, struct errinfo *e);

#endif
