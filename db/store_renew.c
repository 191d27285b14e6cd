#include "store_renew.h"

#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include "errinfo.h"
#include "row_calibration.h"
#include "row_device.h"
#include "row_event.h"
#include "row_subject.h"
#include "row_template.h"
#include "row_token.h"
#include "store_column.h"
#include "store_rules.h"
#include "store_txn.h"
#include "utc.h"

#define KIND  "renew_subject"  /* of a subject and its templates */
#define BEGUN "renew_subjects" /* of all */
#define BATCH 64 /* subjects a transaction: about 5 MB, a tenth of a second */
#define PAUSE (3600 * 1000LL) /* ms after which what was begun is begun anew */

/* ---- new keys for subjects */

struct renewal { /* of one subject */
    struct store_txn *t;
    const struct store_act *by;
    struct row_crypt_key key; /* the new one */
};

static enum status renew_template(void *arg, const struct store_template *t,
                                  const void *model, size_t len, struct errinfo *e)
{
    const struct renewal *r = arg;
    const enum status st = row_template_write(r->t, &r->key, t, model, len, e);

    return st == ST_OK
               ? row_template_tell(r->t, r->by, KIND, t->subject, t->id, "renewed", e)
               : st;
}

/* The subject's row comes last: its templates are read under the key that it has. */
static enum status renew_subject(struct store_txn *t, const struct store_act *by,
                                 const struct sql_rows *row, struct errinfo *e)
{
    struct renewal r = {.t = t, .by = by};
    struct row_subject p = {.row = sql_column(row, 0).i};
    unsigned char wrapped[VAULT_WRAPPED];
    char(*list)[STORE_ID_LEN + 1] = NULL;
    struct store_template one;
    struct store_subject who;
    size_t n = 0;
    enum status st = row_subject_who(t, row, 1, &who, &p.key, e);

    if (st == ST_OK && (st = row_template_ids(t, p.row, &list, &n, e)) == ST_OK)
        row_crypt_new(t->vault, who.uid, &r.key, wrapped);
    for (size_t i = 0; i < n && st == ST_OK; i++)
        st = row_template_load(t, list[i], &one, renew_template, &r, e);
    free(list);
    p.key = r.key;
    if (st == ST_OK && (st = row_subject_renew(t, &p, &who, wrapped, e)) == ST_OK)
        st = row_subject_tell(t, by, KIND, who.id, &p, "renewed", e);
    sodium_memzero(&p, sizeof p);
    sodium_memzero(&r, sizeof r);
    sodium_memzero(&who, sizeof who);
    return st;
}

/* The next subjects after *last that have no entry since begun. */
static enum status renew_batch(struct store_txn *t, const struct store_act *by,
                               int64_t begun, int64_t *last, size_t *n, struct errinfo *e)
{
    struct sql_rows *row;
    enum status st = SQL_QUERY(
        t->sql, &row, e,
        "SELECT s.subject_key, " ROW_SUBJECT_WHO
        " FROM subjects s WHERE s.subject_key > $1 "
        "AND NOT EXISTS (SELECT 1 FROM events v WHERE v.chain = 0 AND v.object = s.uid "
        "AND v.seq > $2 AND v.kind = '" KIND "') ORDER BY s.subject_key LIMIT $3",
        sql_int(*last), sql_int(begun), sql_int(BATCH));

    for (*n = 0; st == ST_OK && sql_next(row); ++*n) {
        *last = sql_column(row, 0).i;
        st = renew_subject(t, by, row, e);
    }
    return sql_done(row, st, e);
}

/* *begun: the entry by which it was begun, now or by a command that did not end.  Since then
 * others may have got at what was written: not after a pause. */
static enum status begin(struct store_txn *t, const struct store_act *by, int64_t *begun,
                         struct errinfo *e)
{
    unsigned char hash[STORE_CHAIN_HASH];
    char kind[32] = "", at[UTC_TEXT] = "";
    struct sql_rows *r;
    int64_t ms;
    uint64_t seq = 0;
    enum status st = sql_query(
        t->sql,
        "SELECT kind, at, (SELECT max(seq) FROM events WHERE chain = 0 AND kind = '" BEGUN
        "') FROM events WHERE chain = 0 AND kind IN ('" BEGUN "', '" KIND
        "', '" STORE_CHAIN_RENEW "') ORDER BY seq DESC LIMIT 1",
        NULL, 0, &r, e);

    if (st == ST_OK && sql_next(r) && store_column_text(r, 0, kind, sizeof kind) &&
        store_column_text(r, 1, at, sizeof at))
        *begun = sql_column(r, 2).i;
    if ((st = sql_done(r, st, e)) != ST_OK)
        return st;
    if (*begun != 0 && strcmp(kind, STORE_CHAIN_RENEW) != 0 && utc_read(at, &ms) &&
        ms <= by->ms && by->ms - ms < PAUSE)
        return ST_OK;
    if ((st = row_event_add(t, by, BEGUN, "", "", "begun", e)) == ST_OK)
        st = row_event_end(t, STORE_CHAIN_CHANGES, &seq, hash, e);
    *begun = (int64_t)seq;
    return st;
}

enum status store_renew_subjects(struct store *s, const char *actor, struct errinfo *e)
{
    struct store_txn t;
    struct store_act by;
    int64_t begun = 0, last = INT64_MIN;
    size_t n = 1;
    enum status st = store_rules_act(&by, actor, e);

    if (st == ST_OK && (st = store_txn_begin(s, SQL_LAZY, &t, e)) == ST_OK)
        st = store_txn_end(&t, begin(&t, &by, &begun, e), e);
    while (st == ST_OK && n > 0) {
        if ((st = store_rules_act(&by, actor, e)) == ST_OK &&
            (st = store_txn_begin(s, SQL_LAZY, &t, e)) == ST_OK)
            st = store_txn_end(&t, renew_batch(&t, &by, begun, &last, &n, e), e);
    }
    return st;
}

/* ---- under the next vault */

/* Rows are read, and held against the audit log, under the old vault, and written under the next
 * one; each has an entry under the next then. */
struct renewing {
    struct store_txn *old, next;
    const struct store_act *by;
};

/* In the audit log it is renamed, since it has another reference there from now on. */
static enum status tell_subject(struct renewing *r, const char *id,
                                const struct row_subject *p, struct errinfo *e)
{
    unsigned char ref[ROW_CRYPT_REF];
    struct row_event_row gone = {.gone = true, .ref = ref};
    enum status st;

    row_crypt_ref(r->old->vault, id, ref);
    memcpy(gone.object, p->key.uid, sizeof gone.object);
    st = row_event_leave(&r->next, r->by, "rename_subject", "", "", "renamed", &gone, e);
    return st == ST_OK
               ? row_subject_tell(&r->next, r->by, "rename_subject", id, p, "named", e)
               : st;
}

static enum status move_templates(struct renewing *r, const struct row_subject *p,
                                  struct errinfo *e)
{
    struct store_template *list;
    size_t n;
    enum status st = row_template_list(r->old, p->row, p->templates, &list, &n, e);

    for (size_t i = 0; st == ST_OK && i < n; i++) {
        const struct store_template *t = &list[i];

        if ((st = row_template_found(&r->next, p, t, e)) == ST_OK)
            st = row_template_tell(&r->next, r->by, STORE_CHAIN_RENEW, t->subject, t->id,
                                   "renewed", e);
    }
    free(list);
    return st;
}

static enum status move_subject(struct renewing *r, const struct sql_rows *row,
                                struct errinfo *e)
{
    unsigned char wrapped[VAULT_WRAPPED];
    struct row_subject p = {.row = sql_column(row, 0).i};
    struct store_subject who;
    enum status st = row_subject_who(r->old, row, 1, &who, &p.key, e);

    p.templates = who.templates;
    if (st == ST_OK && (st = move_templates(r, &p, e)) == ST_OK) {
        vault_wrap(r->next.vault, p.key.uid, p.key.key, wrapped);
        if ((st = row_subject_renew(&r->next, &p, &who, wrapped, e)) == ST_OK)
            st = tell_subject(r, who.id, &p, e);
    }
    sodium_memzero(&p, sizeof p);
    sodium_memzero(&who, sizeof who);
    return st;
}

static enum status move_subjects(struct renewing *r, struct errinfo *e)
{
    struct sql_rows *row;
    enum status st = sql_query(r->old->sql,
                               "SELECT s.subject_key, " ROW_SUBJECT_WHO
                               " FROM subjects s ORDER BY s.subject_key",
                               NULL, 0, &row, e);

    while (st == ST_OK && sql_next(row))
        st = move_subject(r, row, e);
    return sql_done(row, st, e);
}

static enum status move_tokens(struct renewing *r, struct errinfo *e)
{
    struct store_token *list;
    size_t n;
    enum status st = row_token_list(r->old, &list, &n, e);

    for (size_t i = 0; st == ST_OK && i < n; i++)
        st = row_token_tell(&r->next, r->by, STORE_CHAIN_RENEW, list[i].id, e);
    free(list);
    return st;
}

static enum status move_devices(struct renewing *r, struct errinfo *e)
{
    struct store_device *list;
    size_t n;
    enum status st = row_device_list(r->old, &list, &n, e);

    for (size_t i = 0; st == ST_OK && i < n; i++)
        st = row_device_tell(&r->next, r->by, STORE_CHAIN_RENEW, list[i].id, list[i].name,
                             e);
    free(list);
    return st;
}

static enum status move_calibrations(struct renewing *r, struct errinfo *e)
{
    struct store_calibration newest, *list = NULL;
    size_t n = 0;
    enum status st = row_calibration_get(r->old, &newest, e);

    if (st == ST_ENOTFOUND)
        return ST_OK;
    if (st == ST_OK)
        st = row_calibration_list(r->old, &list, &n, e);
    for (size_t i = 0; st == ST_OK && i < n; i++)
        st = row_calibration_tell(&r->next, r->by, list[i].version, e);
    free(list);
    return st;
}

enum status store_renew(struct store_txn *t, const struct store_act *by,
                        const struct vault *next, const char *kept, struct errinfo *e)
{
    struct renewing r = {.old = t, .next = *t, .by = by};
    enum status st;

    r.next.vault = next;
    if ((st = row_event_signs(t, by, STORE_CHAIN_RENEW, next, kept, e)) != ST_OK ||
        (st = row_event_renew(t, next, e)) != ST_OK ||
        (st = move_subjects(&r, e)) != ST_OK || (st = move_tokens(&r, e)) != ST_OK ||
        (st = move_devices(&r, e)) != ST_OK ||
        (st = sql_run(t->sql, "DELETE FROM clouds", NULL, 0, e)) != ST_OK)
        return st; /* of these, hashes by the old key, nothing can be made again */
    if ((st = move_calibrations(&r, e)) == ST_OK)
        t->vault = next;
    return st;
}
