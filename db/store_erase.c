#include "store_erase.h"

#include <sodium.h>
#include <string.h>

#include "errinfo.h"
#include "row_event.h"
#include "row_subject.h"
#include "row_template.h"
#include "store_receipt.h"
#include "store_rules.h"
#include "store_txn.h"

/* A corrupt subject row may be erased on request, not by expiry. */
static enum status may_erase(struct store_txn *t, const struct store_act *by,
                             const char *subject, bool due, struct errinfo *e)
{
    struct store_subject one;
    enum status st = row_subject_read(t, subject, &one, e);

    if (st == ST_ECORRUPT && !due)
        return ST_OK;
    if (st != ST_OK)
        return st;
    if (one.hold)
        return errinfo_set(e, ST_EHELD, "subject %s is on hold", subject);
    if (due && !store_rules_past(one.expires, by->ms))
        return errinfo_set(e, ST_ENOTFOUND, "subject %s has not expired", subject);
    return ST_OK;
}

enum status store_erase_row(struct store_txn *t, const struct store_act *by,
                            const char *subject, const char *outcome, int64_t row,
                            const struct row_event_row *gone,
                            char (**template_id)[STORE_ID_LEN + 1], size_t *n,
                            struct errinfo *e)
{
    enum status st = row_template_ids(t, row, template_id, n, e);

    if (st != ST_OK || (st = row_subject_delete(t, row, e)) != ST_OK)
        return st;
    for (size_t i = 0; i < *n && st == ST_OK; i++)
        if (store_id_valid((*template_id)[i]))
            st = row_template_tell(t, by, "delete_template", subject, (*template_id)[i],
                                   "deleted", e);
    return st == ST_OK
               ? row_event_leave(t, by, "delete_subject", subject, "", outcome, gone, e)
               : st;
}

/* The receipt of what has just been done, while the transaction is open. */
static enum status give_receipt(struct store_txn *t, const struct store_act *by,
                                const char *subject, struct store_receipt *out,
                                struct errinfo *e)
{
    unsigned char hash[STORE_CHAIN_HASH];
    const enum status st = row_event_end(t, STORE_CHAIN_CHANGES, &out->seq, hash, e);

    if (st != ST_OK)
        return st;
    (void)sodium_bin2hex(out->hash, sizeof out->hash, hash, sizeof hash);
    memcpy(out->subject, subject, strlen(subject) + 1);
    memcpy(out->at, by->at, sizeof out->at);
    store_receipt_sign(t->vault, out);
    return ST_OK;
}

static enum status erase_row(struct store_txn *t, const struct store_act *by,
                             const char *subject, bool due, struct store_receipt *out,
                             struct errinfo *e)
{
    struct row_event_row gone;
    struct row_subject p = {0};
    size_t n = 0;
    enum status st = row_subject_find(t, subject, &p, e);

    sodium_memzero(&p.key, sizeof p.key);
    if ((st != ST_OK && (st != ST_ECORRUPT || p.row == 0)) ||
        (st = may_erase(t, by, subject, due, e)) != ST_OK ||
        (st = row_event_named(t, subject, &gone, e)) != ST_OK)
        return st;
    if (gone.gone) /* else who it was is the audit log's to say: the row may be damaged */
        memcpy(gone.object, p.key.uid, sizeof gone.object);
    gone.gone = true;
    st = store_erase_row(t, by, subject, "deleted", p.row, &gone, &out->template_id, &n,
                         e);
    out->templates = (uint32_t)n;
    return st == ST_OK ? give_receipt(t, by, subject, out, e) : st;
}

static enum status erase(struct store *s, const char *actor, const char *subject,
                         bool due, struct store_receipt *out, struct errinfo *e)
{
    struct store_act by;
    struct store_txn t;
    enum status st;

    memset(out, 0, sizeof *out);
    if ((st = store_rules_subject(subject, e)) != ST_OK ||
        (st = store_rules_act(&by, actor, e)) != ST_OK ||
        (st = store_txn_begin(s, SQL_WRITE, &t, e)) != ST_OK)
        return st;
    st = store_txn_end(&t, erase_row(&t, &by, subject, due, out, e), e);
    if (st == ST_OK)
        store_txn_scrub(s);
    return st;
}

enum status store_subject_erase(struct store *s, const char *actor, const char *subject,
                                struct store_receipt *out, struct errinfo *e)
{
    return erase(s, actor, subject, false, out, e);
}

enum status store_subject_purge(struct store *s, const char *actor, const char *subject,
                                struct errinfo *e)
{
    struct store_receipt r;
    const enum status st = erase(s, actor, subject, true, &r, e);

    store_receipt_free(&r);
    return st;
}

enum status store_erased_since(struct store *s, int64_t *since, bool *erased,
                               struct errinfo *e)
{
    struct store_txn t;
    int64_t last = *since;
    enum status st = store_txn_begin(s, SQL_READ, &t, e);

    *erased = false;
    if (st != ST_OK)
        return st;
    st = store_txn_end(&t, store_txn_erasures(&t, *since, &last, erased, e), e);
    *erased = *erased || last < *since; /* a database that was restored */
    *since = last;
    return st;
}
