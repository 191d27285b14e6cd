#include "store_txn.h"

#include <sodium.h>
#include <string.h>

#include "bytes.h"
#include "log_anchor.h"
#include "ident.h"
#include "newfile.h"
#include "rows_digest.h"
#include "rows_token.h"
#include "sql_file.h"
#include "sql_file_index.h"
#include "utc.h"

/* ---- is the database as it was written? */

bool store_txn_refused(struct store *s, struct errinfo *e)
{
    if (!atomic_load(&s->refused))
        return false;
    if (e != NULL)
        *e = s->refusal;
    return true;
}

static void store_txn_count(void *arg, const char *line)
{
    struct errinfo *first = arg;

    if (first->code == ST_OK)
        (void)errinfo_set(first, ST_EREFUSED, "%s", line);
}

bool store_txn_may_pass(enum status st)
{
    return st == ST_EBUSY || st == ST_EIO || st == ST_ENOMEM;
}

enum status store_txn_verify(struct log_txn *t, store_report *report, void *arg,
                             struct errinfo *e)
{
    static const char advice[] =
        "restore a backup (surfacectl restore), or see surfacectl check-database";
    struct errinfo first = {ST_OK, ""}, why;
    store_report *const tell = report != NULL ? report : store_txn_count;
    void *const to = report != NULL ? arg : &first;
    unsigned char sum[LOG_DIGEST];
    uint64_t bad, lost, twice = 0;
    bool same = false;
    enum status st;

    sql_file_forget(t->sql);
    if ((st = rows_digest(t, false, tell, to, sum, &bad, &why)) != ST_OK ||
        (st = sql_file_index_check(t->sql, tell, to, &lost, &why)) != ST_OK ||
        (!sql_file_is(t->sql) &&
         (st = rows_digest_twice(t, tell, to, &twice, &why)) != ST_OK)) {
        if (!store_txn_may_pass(st))
            tell(to, why.msg);
        return errinfo_set(e, st, "%s", why.msg);
    }
    if (log_txn_agrees(t, sum, &same, &why) != ST_OK)
        tell(to, why.msg);
    else if (!same)
        tell(to, rows_digest_problem);
    if (bad == 0 && lost == 0 && twice == 0 && same)
        return ST_OK;
    return errinfo_set(e, ST_EREFUSED, "the database is not as it was written%s%s: %s",
                       first.msg[0] != '\0' ? ": " : "", first.msg, advice);
}

/* ---- transactions */

#define SCRUB_MS 200 /* that an erasure waits for readers */

/* A difference stands until the database is opened again.  Any other error of its engine is the
 * caller's alone: the next transaction may succeed. */
static enum status refuse(struct store *s, enum status st, const struct errinfo *why,
                          struct errinfo *e)
{
    if (st == ST_EREFUSED && s->open && !atomic_flag_test_and_set(&s->refusing)) {
        s->refusal = *why;
        atomic_store(&s->refused, true);
    }
    return errinfo_set(e, st, "%s", why->msg);
}

/* Is it the database that was opened, and no older one? */
static enum status check_end(struct store *s, struct log_txn *t, struct errinfo *e)
{
    enum status st = sql_file_in_place(t->sql, e);

    if (st != ST_OK)
        return st;
    st = log_txn_begin(t, e);
    if (st == ST_EREFUSED && !sql_file_is(t->sql) && s->anchor != NULL)
        atomic_store(&s->behind, true);
    return st;
}

/* Rows that cannot be read may hide a difference: nothing is used until they were read. */
static void note_verified(struct store *s, enum status st)
{
    if (st == ST_OK || !store_txn_may_pass(st)) {
        atomic_store(&s->verified, st == ST_OK);
        atomic_store(&s->unread, st != ST_OK);
    }
}

/* Nothing is written on top of what was not verified. */
static enum status store_txn_check(struct store *s, struct log_txn *t, struct errinfo *e)
{
    enum status st = check_end(s, t, e);

    if (st != ST_OK || atomic_load(&s->verified) ||
        (t->how == SQL_READ && !atomic_load(&s->unread)))
        return st;
    if (t->how == SQL_TRY)
        return errinfo_set(e, ST_EBUSY, "the rows are not verified yet");
    st = store_txn_verify(t, NULL, NULL, e);
    note_verified(s, st);
    return st;
}

static enum status store_txn_start(struct store *s, const char *actor, enum sql_begin how,
                                   struct log_txn *t, struct errinfo *e)
{
    struct errinfo why;
    enum status st;

    *t = (struct log_txn){.log = &s->log,
                          .crypt = s->crypt,
                          .how = how,
                          .added = LOGS,
                          .before = log_newest(&s->log)};
    if ((st = log_act(&t->by, actor != NULL ? actor : "", e)) != ST_OK)
        return st;
    if (store_txn_refused(s, &why))
        return errinfo_set(e, ST_EREFUSED, "%s", why.msg);
    return sql_begin(s->sql, how, &t->sql, e);
}

/* An id is text, the key of a lock a number. */
static uint32_t hash_token(const char *token)
{
    unsigned char hash[crypto_generichash_BYTES_MIN];

    (void)crypto_generichash(hash, sizeof hash, (const unsigned char *)token,
                             strlen(token), NULL, 0);
    return (uint32_t)bytes_number(hash, 4);
}

enum status store_lock_subject(struct log_txn *t, int64_t key, struct errinfo *e)
{
    return sql_lock(t->sql, LOG_LOCK_SUBJECT(key), e);
}

enum status store_lock_token(struct log_txn *t, const char *token, struct errinfo *e)
{
    return sql_lock(t->sql, LOG_LOCK_TOKEN(hash_token(token)), e);
}

enum status store_txn_verify_alone(struct store *s, store_report *report, void *arg,
                                   struct errinfo *e)
{
    struct errinfo why;
    struct log_txn t;
    enum status st = store_txn_start(s, NULL, SQL_READ, &t, e);

    if (st != ST_OK)
        return st;
    if ((st = check_end(s, &t, &why)) == ST_OK) {
        st = store_txn_verify(&t, report, arg, &why);
        note_verified(s, st);
    }
    (void)sql_end(t.sql, st, NULL);
    return st == ST_OK ? ST_OK : refuse(s, st, &why, e);
}

static enum status lock(enum sql_begin how, const struct store_use *use,
                        struct log_txn *t, struct errinfo *e)
{
    enum status st = ST_OK;

    /* What a SQL_TRY writes is in no log, and no other row depends on it. */
    if (use == NULL)
        return how != SQL_READ && how != SQL_TRY ? sql_lock(t->sql, LOG_LOCK_CHANGES, e)
                                                 : ST_OK;
    if (use->subject != 0)
        st = store_lock_subject(t, use->subject, e);
    if (st == ST_OK && use->token != NULL)
        st = store_lock_token(t, use->token, e);
    return st == ST_OK && use->appends ? log_txn_appends(t, e) : st;
}

enum status store_start(struct store *s, const char *actor, enum sql_begin how,
                        const struct store_use *use, struct log_txn *t, struct errinfo *e)
{
    enum status st = ST_OK;

    if (use != NULL && !atomic_load(&s->verified))
        st = store_txn_verify_alone(s, NULL, NULL, e);
    if (st == ST_OK && (st = store_txn_start(s, actor, how, t, e)) == ST_OK &&
        (st = lock(how, use, t, e)) != ST_OK)
        (void)sql_end(t->sql, st, NULL);
    return st;
}

enum status store_begin_use(struct store *s, const char *actor, enum sql_begin how,
                            const struct store_use *use, struct log_txn *t,
                            struct errinfo *e)
{
    const enum status st = store_start(s, actor, how, use, t, e);

    return st == ST_OK ? store_check(s, t, e) : st;
}

void store_read_ahead(struct log_txn *t, store_read *read, void *arg)
{
    if (!sql_ahead(t->sql, true))
        return;
    (void)read(arg, NULL);
    if (t->how != SQL_READ)
        log_txn_ahead(t);
    (void)sql_ahead(t->sql, false);
}

enum status store_check(struct store *s, struct log_txn *t, struct errinfo *e)
{
    struct errinfo why;
    const enum status st = store_txn_check(s, t, &why);

    if (st == ST_OK)
        return ST_OK;
    (void)sql_end(t->sql, st, NULL);
    return refuse(s, st, &why, e);
}

enum status store_begin(struct store *s, enum sql_begin how, struct log_txn *t,
                        struct errinfo *e)
{
    return store_begin_use(s, NULL, how, NULL, t, e);
}

enum status store_actor_may(struct log_txn *t, struct errinfo *e)
{
    struct rows_token one;
    enum status st;

    if (!ident_id_valid(t->by.actor))
        return ST_OK;
    st = rows_token_get(t, t->by.actor, &one, e);
    if (st == ST_ENOTFOUND || (st == ST_OK && one.token.revoked[0] != '\0'))
        return errinfo_set(e, ST_ETOKEN, "the token was revoked");
    if (st == ST_OK && store_rules_past(one.token.expires, t->by.ms))
        return errinfo_set(e, ST_ETOKEN, "the token has expired");
    if (st == ST_OK)
        memcpy(t->groups, one.token.groups, sizeof t->groups);
    return st;
}

enum status store_act_begin(struct store *s, const char *actor, enum sql_begin how,
                            struct log_txn *t, struct errinfo *e)
{
    enum status st = store_begin_use(s, actor, how, NULL, t, e);

    if (st == ST_OK && (st = store_actor_may(t, e)) != ST_OK)
        return store_end(s, t, st, e);
    return st;
}

/* The changes that a durable commit has seen are durable too, whichever process wrote them. */
static void advance_anchor(struct store *s, const struct log_end *to)
{
    const struct log_anchor at = {.daemon = s->log.daemon, .end = *to};
    struct errinfo why = {ST_OK, ""};

    if (s->anchor == NULL || to->seq <= atomic_load(&s->anchored))
        return;
    (void)pthread_mutex_lock(&s->anchor_lock);
    if (s->anchor_left)
        s->anchor_left = log_anchor_adopt(s->anchor, &why) != ST_OK;
    if (!s->anchor_left && log_anchor_advance(s->anchor, s->crypt, &at, &why) == ST_OK)
        atomic_store(&s->anchored, to->seq);
    (void)pthread_mutex_lock(&s->anchor_why_lock);
    s->anchor_why = why;
    (void)pthread_mutex_unlock(&s->anchor_why_lock);
    (void)pthread_mutex_unlock(&s->anchor_lock);
}

/* Another process may have erased, and ended before the bytes had left the WAL. */
enum status store_end(struct store *s, struct log_txn *t, enum status st,
                      struct errinfo *e)
{
    if (t->how == SQL_READ)
        return sql_end(t->sql, st, e);
    if (st == ST_OK)
        st = log_txn_check(t, e);
    if (st == ST_OK && atomic_exchange(&s->log.erasure, false))
        sql_file_scrub_later(s->sql);
    if (st == ST_OK)
        log_txn_prove(t);
    if ((st = sql_end(t->sql, st, e)) != ST_OK)
        return st;
    log_txn_committed(t);
    if (t->how != SQL_LAZY && (t->added != LOGS || t->settled))
        advance_anchor(s, &t->changes);
    return ST_OK;
}

enum status store_commit(struct store *s, struct log_txn *t, struct newfile *anchor,
                         const char *what, struct errinfo *e)
{
    struct errinfo why;
    enum status st;

    if (anchor->part != NULL)
        atomic_store(&s->anchored, t->changes.seq); /* it says so */
    if ((st = store_end(s, t, ST_OK, e)) == ST_OK && anchor->part != NULL &&
        (st = newfile_commit(anchor, &why)) != ST_OK)
        (void)errinfo_set(
            e, st,
            "%s, but the anchor is not in place yet: %.300s; run the command again", what,
            why.msg);
    newfile_leave(anchor);
    return st;
}

enum status store_list(struct store *s, const struct rows_table *table, size_t size,
                       void **list, size_t *n, struct errinfo *e)
{
    struct log_txn t;
    const enum status st = store_begin(s, SQL_READ, &t, e);

    *list = NULL;
    *n = 0;
    return st == ST_OK ? store_end(s, &t, rows_table_all(&t, table, size, list, n, e), e)
                       : st;
}

void store_scrub(struct store *s)
{
    sql_file_scrub(s->sql, SCRUB_MS);
}

/* ---- what the nouns share */

#define RANDOM_MAX 32
#define RECENT_MS  60000

void store_rules_random(char *out, size_t bytes)
{
    unsigned char raw[RANDOM_MAX];

    randombytes_buf(raw, bytes);
    (void)sodium_bin2hex(out, 2 * bytes + 1, raw, bytes);
    sodium_memzero(raw, sizeof raw);
}

enum status store_rules_now(int64_t *ms, struct errinfo *e)
{
    if (!utc_now(ms))
        return errinfo_set(e, ST_EINTERNAL, "the system's clock cannot be read");
    return ST_OK;
}

bool store_rules_past(const char *at, int64_t ms)
{
    int64_t then;

    return at[0] != '\0' && (!utc_read(at, &then) || then <= ms);
}

bool store_rules_recent(const char *at, int64_t ms)
{
    int64_t then;

    return utc_read(at, &then) && then <= ms && ms - then < RECENT_MS;
}

enum status store_rules_within(const struct log_txn *t, const char *list,
                               struct errinfo *e)
{
    if (groups_within(t->groups, list))
        return ST_OK;
    return errinfo_set(
        e, ST_EDENIED,
        "the token is bound to groups (%.300s): it gives one or more of these, "
        "and no others",
        t->groups);
}

enum status store_rules_groups(const struct log_txn *t, char list[GROUPS_SIZE],
                               struct errinfo *e)
{
    if (list[0] == '\0')
        memcpy(list, t->groups, sizeof t->groups);
    return store_rules_within(t, list, e);
}

void store_rules_shown(const struct log_txn *t, struct store_subject *one)
{
    char all[GROUPS_SIZE];

    memcpy(all, one->groups, sizeof all);
    groups_common(t->groups, all, one->groups);
}

enum status store_rules_room(const char *subject, size_t templates, struct errinfo *e)
{
    if (templates < STORE_TEMPLATES_MAX)
        return ST_OK;
    return errinfo_set(
        e, ST_EFULL,
        "subject %s would have more than %d templates: delete some of them "
        "first, or add fewer",
        subject, STORE_TEMPLATES_MAX);
}
