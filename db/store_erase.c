#include "store.h"

#include <inttypes.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "rows_template.h"
#include "store_txn.h"

/* ---- receipts */

#define SIGNED_TEXT 192

static void add_line(crypto_hash_sha256_state *h, const char *text)
{
    (void)crypto_hash_sha256_update(h, (const unsigned char *)text, strlen(text));
    (void)crypto_hash_sha256_update(h, (const unsigned char *)"\n", 1);
}

/* As text, so that it can be made by hand. */
static void digest(const struct store_receipt *r, char out[65])
{
    unsigned char hash[crypto_hash_sha256_BYTES];
    crypto_hash_sha256_state h;

    (void)crypto_hash_sha256_init(&h);
    add_line(&h, "surface erasure 2");
    add_line(&h, r->subject);
    add_line(&h, r->uid);
    add_line(&h, r->at);
    for (uint32_t i = 0; i < r->templates; i++)
        add_line(&h, r->template_id[i]);
    (void)crypto_hash_sha256_final(&h, hash);
    (void)sodium_bin2hex(out, 65, hash, sizeof hash);
}

static size_t signed_text(const struct store_receipt *r, char out[SIGNED_TEXT])
{
    return (size_t)snprintf(out, SIGNED_TEXT, "surface receipt 2\n%s\n%" PRIu64 "\n%s\n",
                            r->digest, r->seq, r->hash);
}

static void sign(const struct crypt *c, struct store_receipt *r)
{
    unsigned char public[CRYPT_KEY], signature[CRYPT_SIGN];
    char text[SIGNED_TEXT];

    digest(r, r->digest);
    crypt_sign(c, text, signed_text(r, text), signature);
    crypt_public(c, public);
    (void)sodium_bin2hex(r->signature, sizeof r->signature, signature, sizeof signature);
    (void)sodium_bin2hex(r->public_key, sizeof r->public_key, public, sizeof public);
}

static bool read_hex(const char *text, unsigned char *out, size_t n)
{
    size_t got = 0;

    return sodium_hex2bin(out, n, text, strlen(text), NULL, &got, NULL) == 0 && got == n;
}

bool store_receipt_true(const struct store_receipt *r)
{
    unsigned char public[CRYPT_KEY], signature[CRYPT_SIGN];
    char wanted[65], text[SIGNED_TEXT];

    digest(r, wanted);
    return strcmp(wanted, r->digest) == 0 &&
           read_hex(r->public_key, public, sizeof public) &&
           read_hex(r->signature, signature, sizeof signature) &&
           crypt_verify(public, text, signed_text(r, text), signature);
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
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    for (size_t i = 0; i < n; i++)
        memcpy(out->template_id[i], row[i].one.id, sizeof out->template_id[i]);
    out->templates = (uint32_t)n;
    return ST_OK;
}

enum status store_erase_rows(struct log_txn *t, const struct log_act *by,
                             const struct rows_subject *of, const char *outcome,
                             struct store_receipt *out, struct errinfo *e)
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
            st = log_change(t, by, "delete_template", of->one.uid, row[i].one.id,
                            "deleted", e);
    free(row);
    if (st != ST_OK || (st = rows_table_delete(t, &rows_subjects, of, e)) != ST_OK)
        return st;
    return log_change(t, by, "delete_subject", of->one.uid, "", outcome, e);
}

/* The receipt of what has just been done, while the transaction is open. */
static void give_receipt(const struct log_txn *t, const struct log_act *by,
                         const struct store_subject *who, struct store_receipt *out)
{
    out->seq = t->changes.seq;
    (void)sodium_bin2hex(out->hash, sizeof out->hash, t->changes.hash, LOG_HASH);
    (void)sodium_bin2hex(out->uid, sizeof out->uid, who->uid, sizeof who->uid);
    memcpy(out->subject, who->id, sizeof out->subject);
    memcpy(out->at, by->at, sizeof out->at);
    sign(t->crypt, out);
}

static enum status erase_rows(struct log_txn *t, const struct log_act *by,
                              const char *subject, bool due, struct store_receipt *out,
                              struct errinfo *e)
{
    struct rows_subject of;
    enum status st = rows_subject_find(t, subject, &of, e);

    if (st == ST_OK && of.one.hold)
        st = errinfo_set(e, ST_EHELD, "subject %s is on hold", subject);
    if (st == ST_OK && due && !store_rules_past(of.one.expires, by->ms))
        st = errinfo_set(e, ST_ENOTFOUND, "subject %s has not expired", subject);
    if (st == ST_OK && (st = store_erase_rows(t, by, &of, "erased", out, e)) == ST_OK)
        give_receipt(t, by, &of.one, out);
    sodium_memzero(&of, sizeof of);
    return st;
}

static enum status erase(struct store *s, const char *actor, const char *subject,
                         bool due, struct store_receipt *out, struct errinfo *e)
{
    struct log_act by;
    struct log_txn t;
    enum status st;

    memset(out, 0, sizeof *out);
    if ((st = ident_subject(subject, e)) != ST_OK ||
        (st = store_act_begin(s, actor, SQL_WRITE, &by, &t, e)) != ST_OK)
        return st;
    st = store_end(s, &t, erase_rows(&t, &by, subject, due, out, e), e);
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
