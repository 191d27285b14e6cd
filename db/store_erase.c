#include "store.h"

#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include "rows_template.h"
#include "store_txn.h"

/* ---- receipts */

static void add_line(crypto_hash_sha256_state *h, const char *text)
{
    (void)crypto_hash_sha256_update(h, (const unsigned char *)text, strlen(text));
    (void)crypto_hash_sha256_update(h, (const unsigned char *)"\n", 1);
}

/* As text, so that it can be made by hand. */
static void digest(const struct store_receipt *r, char out[65])
{
    unsigned char hash[crypto_hash_sha256_BYTES];
    char uid[2 * STORE_UID + 1];
    crypto_hash_sha256_state h;

    (void)sodium_bin2hex(uid, sizeof uid, r->entry.uid, sizeof r->entry.uid);
    (void)crypto_hash_sha256_init(&h);
    add_line(&h, "surface erasure 2");
    add_line(&h, r->subject);
    add_line(&h, uid);
    add_line(&h, r->entry.at);
    for (uint32_t i = 0; i < r->templates; i++)
        add_line(&h, r->template_id[i]);
    (void)crypto_hash_sha256_final(&h, hash);
    (void)sodium_bin2hex(out, 65, hash, sizeof hash);
}

bool store_receipt_true(const struct store_receipt *r)
{
    char wanted[65];

    digest(r, wanted);
    return strcmp(wanted, r->digest) == 0 &&
           log_signed(r->public_key, &r->entry, r->digest);
}

void store_receipt_free(struct store_receipt *r)
{
    free(r->template_id);
    r->template_id = NULL;
    r->templates = 0;
}

/* ---- erasing */

static enum status list_ids(const struct rows_template *row, size_t n,
                            struct store_receipt *out, struct errinfo *e)
{
    if (n == 0)
        return ST_OK;
    if ((out->template_id = calloc(n, sizeof *out->template_id)) == NULL)
        return errinfo_memory(e);
    for (size_t i = 0; i < n; i++)
        memcpy(out->template_id[i], row[i].one.id, sizeof out->template_id[i]);
    out->templates = (uint32_t)n;
    return ST_OK;
}

enum status store_erase_rows(struct log_txn *t, const struct rows_subject *of,
                             const char *outcome, struct store_receipt *out,
                             struct errinfo *e)
{
    struct rows_template *row = NULL;
    size_t n;
    enum status st = store_lock_subject(t, of->one.key, e);

    if (st != ST_OK || (st = rows_template_list(t, of, &row, &n, e)) != ST_OK)
        return st;
    if (out != NULL)
        st = list_ids(row, n, out, e);
    for (size_t i = 0; st == ST_OK && i < n; i++)
        if ((st = rows_table_delete(t, &rows_templates, &row[i], e)) == ST_OK)
            st = log_change(t, "delete_template", of->one.uid, row[i].one.id, "deleted",
                            e);
    free(row);
    if (st != ST_OK || (st = rows_table_delete(t, &rows_subjects, of, e)) != ST_OK)
        return st;
    return log_change(t, "delete_subject", of->one.uid, "", outcome, e);
}

/* The receipt of what has just been done, while the transaction is open. */
static void give_receipt(const struct log_txn *t, const struct store_subject *who,
                         struct store_receipt *out)
{
    struct log_entry *entry = &out->entry;

    entry->seq = t->changes.seq;
    memcpy(entry->hash, t->changes.hash, sizeof entry->hash);
    memcpy(entry->uid, who->uid, sizeof entry->uid);
    memcpy(entry->at, t->by.at, sizeof entry->at);
    memcpy(out->subject, who->id, sizeof out->subject);
    digest(out, out->digest);
    log_sign(t->crypt, entry, out->digest);
    crypt_public(t->crypt, out->public_key);
}

static enum status erase_rows(struct log_txn *t, const char *subject, bool due,
                              struct store_receipt *out, struct errinfo *e)
{
    struct rows_subject of;
    enum status st = rows_subject_find(t, subject, &of, e);

    if (st == ST_OK && of.one.hold)
        st = errinfo_set(e, ST_EHELD, "subject %s is on hold", subject);
    if (st == ST_OK && due && !store_rules_past(of.one.expires, t->by.ms))
        st = errinfo_set(e, ST_ENOTFOUND, "subject %s has not expired", subject);
    if (st == ST_OK && (st = store_erase_rows(t, &of, "erased", out, e)) == ST_OK)
        give_receipt(t, &of.one, out);
    sodium_memzero(&of, sizeof of);
    return st;
}

static enum status erase(struct store *s, const char *actor, const char *subject,
                         bool due, struct store_receipt *out, struct errinfo *e)
{
    struct log_txn t;
    enum status st;

    memset(out, 0, sizeof *out);
    if ((st = ident_subject(subject, e)) != ST_OK ||
        (st = store_act_begin(s, actor, SQL_WRITE, &t, e)) != ST_OK)
        return st;
    st = store_end(s, &t, erase_rows(&t, subject, due, out, e), e);
    if (st == ST_OK)
        store_scrub(s);
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
