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
#include "store_txn.h"

/* Rows are read, and held against the audit log, under the old vault, and written under the next
 * one; each has an entry under the next then. */
struct renewing {
    struct store_txn *old, next;
    const struct store_act *by;
    struct row_subject p; /* the subject with its new key */
};

static enum status renew_template(void *arg, const struct store_template *t,
                                  const void *model, size_t len, struct errinfo *e)
{
    struct renewing *r = arg;
    const enum status st = row_template_renew(&r->next, &r->p.key, t, model, len, e);

    return st == ST_OK ? row_template_tell(&r->next, r->by, STORE_CHAIN_RENEW, t->subject,
                                           t->id, "renewed", e)
                       : st;
}

/* In the audit log it is renamed, since it has another reference there from now on. */
static enum status tell_subject(struct renewing *r, const char *id, struct errinfo *e)
{
    unsigned char ref[ROW_CRYPT_REF];
    struct row_event_row gone = {.gone = true, .ref = ref};
    enum status st;

    row_crypt_ref(r->old->vault, id, ref);
    memcpy(gone.object, r->p.key.uid, sizeof gone.object);
    st = row_event_leave(&r->next, r->by, "rename_subject", "", "", "renamed", &gone, e);
    return st == ST_OK ? row_subject_tell(&r->next, r->by, "rename_subject", id, &r->p,
                                          "named", e)
                       : st;
}

static enum status renew_subject(struct renewing *r, const struct sql_rows *row,
                                 struct errinfo *e)
{
    unsigned char wrapped[VAULT_WRAPPED];
    struct store_template *list = NULL, one;
    struct store_subject who;
    struct row_crypt_key k = {0};
    size_t n = 0;
    enum status st = row_subject_who(r->old, row, 1, &who, &k, e);

    sodium_memzero(&k, sizeof k);
    r->p.row = sql_column(row, 0).i;
    if (st != ST_OK || (st = row_template_list(r->old, r->p.row, &list, &n, e)) != ST_OK)
        return st;
    row_crypt_new(r->next.vault, who.uid, &r->p.key, wrapped);
    for (size_t i = 0; i < n && st == ST_OK; i++)
        st = row_template_load(r->old, list[i].id, &one, renew_template, r, e);
    free(list);
    if (st == ST_OK &&
        (st = row_subject_renew(&r->next, &r->p, &who, wrapped, e)) == ST_OK)
        st = tell_subject(r, who.id, e);
    sodium_memzero(&r->p, sizeof r->p);
    sodium_memzero(&who, sizeof who);
    return st;
}

static enum status renew_subjects(struct renewing *r, struct errinfo *e)
{
    struct sql_rows *row;
    enum status st = sql_query(r->old->sql,
                               "SELECT s.subject_key, " ROW_SUBJECT_WHO
                               " FROM subjects s ORDER BY s.subject_key",
                               NULL, 0, &row, e);

    while (st == ST_OK && sql_next(row))
        st = renew_subject(r, row, e);
    return sql_done(row, st, e);
}

static enum status renew_tokens(struct renewing *r, struct errinfo *e)
{
    struct store_token *list;
    size_t n;
    enum status st = row_token_list(r->old, &list, &n, e);

    for (size_t i = 0; st == ST_OK && i < n; i++)
        st = row_token_tell(&r->next, r->by, STORE_CHAIN_RENEW, list[i].id, e);
    free(list);
    return st;
}

static enum status renew_devices(struct renewing *r, struct errinfo *e)
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

static enum status renew_calibrations(struct renewing *r, struct errinfo *e)
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
        (st = renew_subjects(&r, e)) != ST_OK || (st = renew_tokens(&r, e)) != ST_OK ||
        (st = renew_devices(&r, e)) != ST_OK ||
        (st = sql_run(t->sql, "DELETE FROM clouds", NULL, 0, e)) != ST_OK)
        return st; /* of these, hashes by the old key, nothing can be made again */
    if ((st = renew_calibrations(&r, e)) == ST_OK)
        t->vault = next;
    return st;
}
