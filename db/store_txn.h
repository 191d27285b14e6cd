/* store_txn.h -- an open store, and its transactions. */
#ifndef DB_STORE_TXN_H
#define DB_STORE_TXN_H
#include <stdatomic.h>
#include "errinfo.h"
#include "log_txn.h"
#include "rows_types.h"

struct surface_model; /* libsurface.h */
struct rows_subject;  /* rows_subject.h */
struct store_receipt; /* store.h */

struct store_fault { /* written once, and then read by any thread; all zero at first */
    atomic_flag begun;
    atomic_bool stands; /* why is written */
    struct errinfo why;
};

struct store {
    struct sql *sql;
    char *path;
    const struct surface_model *model; /* store_use_model() */
    char made_by[SURFACE_ENGINE_SIZE];
    struct crypt *crypt;
    struct log log;
    char *anchor;                    /* file of the anchor; NULL: no anchor */
    pthread_mutex_t anchor_lock;     /* held to write the anchor, which may take long */
    pthread_mutex_t anchor_why_lock; /* held for a moment, for anchor_why */
    atomic_uint_least64_t anchored;  /* number of a change that the anchor has reached */
    struct errinfo anchor_why;       /* why it lags; code ST_OK: it does not */
    bool anchor_left;                /* it is still called PATH.part */
    atomic_bool verified;            /* the rows were verified against the digest */
    atomic_bool unread; /* they could not be, as the last attempt has found */
    bool open;          /* store_open() has succeeded */
    atomic_bool behind; /* store_behind() */
    struct store_fault refusal;
};

/* store_begin(s, how, t, e): as sql_begin(), one that writes alone.  ST_EREFUSED: the database is not
 * the one that was opened, or an older one, or its rows are not those of the last change.
 * store_start(s, how, t, e), store_check(s, t, e): the same in two steps, between which queries may be
 * sent ahead, and nothing else; where store_check() fails, t has ended.
 * store_end(s, t, st, e): as sql_end().
 * store_refuse(s, st, why, e): st, for why; where it is ST_EREFUSED, every other transaction fails
 * with it from now on.
 * store_fault_get(f, e): does one stand?  e: why.
 * store_verify_rows(s, report, arg, e): store_verify().
 * store_scrub(s): deleted bytes leave the file and its WAL, after an erasure. */
enum status store_begin(struct store *s, enum sql_begin how, struct log_txn *t,
                        struct errinfo *e);
enum status store_start(struct store *s, enum sql_begin how, struct log_txn *t,
                        struct errinfo *e);
enum status store_check(struct store *s, struct log_txn *t, struct errinfo *e);
enum status store_end(struct store *s, struct log_txn *t, enum status st,
                      struct errinfo *e);
enum status store_refuse(struct store *s, enum status st, const struct errinfo *why,
                         struct errinfo *e);
bool store_fault_get(struct store_fault *f, struct errinfo *e);

/* store_txn_may_pass(st): Returns true if st is an error of the engine that may be over soon: a lock, a
 * lost server, a full disk, no memory. */
bool store_txn_may_pass(enum status st);

/* store_txn_verify(t, report, arg, e): Verifies all rows with a MAC against the digest of the last
 * change, and the indexes.  Calls report() (or NULL) once a problem.  ST_EREFUSED: a difference.  Any
 * other error: the rows could not be read, which proves nothing; they were not verified. */
enum status store_txn_verify(struct log_txn *t, store_report *report, void *arg,
                             struct errinfo *e);
enum status store_verify_rows(struct store *s, store_report *report, void *arg,
                              struct errinfo *e);
void store_scrub(struct store *s);

/* store_settle_anchor(s, path, e): If PATH.part, and not PATH, is the anchor of s, which was opened without
 * one, gives it its name: a new part would replace it.  path may be NULL.  Errors as store_begin();
 * ST_EIO: it could not be renamed. */
enum status store_settle_anchor(struct store *s, const char *path, struct errinfo *e);

/* store_actor_may(t, by, e): a request is as long as its client makes it: a token that was good when it
 * began may have been revoked, or have expired, when it acts.  ST_ETOKEN; of other actors nothing is
 * asked.
 * store_act_begin(s, actor, how, by, t, e): log_act(), store_begin() and store_actor_may(). */
enum status store_actor_may(struct log_txn *t, const struct log_act *by,
                            struct errinfo *e);
enum status store_act_begin(struct store *s, const char *actor, enum sql_begin how,
                            struct log_act *by, struct log_txn *t, struct errinfo *e);

/* A transaction that makes no entry in the change log, and waits for none that does: only for those
 * that use the same subject or token, or that append to the same access log. */
struct store_use {
    int64_t subject;   /* the key of one whose attempts it reads and writes; 0: of none */
    const char *token; /* whose attempts, of all subjects; NULL: of none */
    bool appends;      /* to the access log */
};

/* store_start_use(s, how, use, t, e), store_begin_use(s, how, use, t, e): as store_start() and
 * store_begin().
 * store_lock_subject(t, key, e), store_lock_token(t, token, e): also where a change writes to these
 * attempts; in this order, the subject's before anything of it is written. */
enum status store_start_use(struct store *s, enum sql_begin how,
                            const struct store_use *use, struct log_txn *t,
                            struct errinfo *e);
enum status store_begin_use(struct store *s, enum sql_begin how,
                            const struct store_use *use, struct log_txn *t,
                            struct errinfo *e);
enum status store_lock_subject(struct log_txn *t, int64_t key, struct errinfo *e);
enum status store_lock_token(struct log_txn *t, const char *token, struct errinfo *e);

/* store_erase_rows(t, by, of, outcome, out, e): the subject's row and its templates' are deleted,
 * with a change for each; out: NULL, or receives the templates' ids. */
enum status store_erase_rows(struct log_txn *t, const struct log_act *by,
                             const struct rows_subject *of, const char *outcome,
                             struct store_receipt *out, struct errinfo *e);

/* ---- times, random ids, and how much there may be */

/* 2 * bytes random hexadecimal digits and a NUL; at most 32 bytes. */
void store_rules_random(char *out, size_t bytes);

/* store_rules_now(ms, e): utc_now(), or ST_EINTERNAL. */
enum status store_rules_now(int64_t *ms, struct errinfo *e);

/* store_rules_past(at, ms): has the time come?  "": never; what is no time: yes. */
bool store_rules_past(const char *at, int64_t ms);

/* store_rules_recent(at, ms): is `at` a time in the minute before ms?  One in the future is
 * from before the clock was set back, and is not recent. */
bool store_rules_recent(const char *at, int64_t ms);

/* store_rules_room(subject, templates, e): whether a subject with this many templates may
 * have one more. ST_EFULL. */
enum status store_rules_room(const char *subject, size_t templates, struct errinfo *e);

#endif
