#include "store.h"

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "rows_attempts.h"
#include "rows_token.h"
#include "store_txn.h"

#define SECRET_BYTES 32

/* ---- secrets */

/* The hash that is kept of a secret.  Secrets are 256 random bits: there is nothing to
 * guess, so a fast hash is enough. */
static void hash_secret(const char *secret, unsigned char hash[ROWS_TOKEN_HASH])
{
    (void)crypto_generichash(hash, ROWS_TOKEN_HASH, (const unsigned char *)secret,
                             strlen(secret), NULL, 0);
}

/* Is end_ms a time to come, or one of the words instead? */
static enum status check_end(int64_t end_ms, struct errinfo *e)
{
    int64_t now;
    enum status st = store_rules_now(&now, e);

    if (st != ST_OK || end_ms == STORE_NEVER || end_ms == STORE_SAME_END)
        return st;
    if (end_ms <= now)
        return errinfo_set(e, ST_EINVAL, "the token's end is in the past");
    if (end_ms - now > STORE_LIFE_MAX * 1000)
        return errinfo_set(e, ST_EINVAL, "a token's life is at most %lld days",
                           (long long)(STORE_LIFE_MAX / 86400));
    return ST_OK;
}

static void print_end(int64_t end_ms, char out[UTC_TEXT])
{
    out[0] = '\0';
    if (end_ms != STORE_NEVER)
        utc_print(end_ms, out);
}

/* A new secret and its hash. */
static void new_secret(char secret[65], unsigned char hash[ROWS_TOKEN_HASH])
{
    store_rules_random(secret, SECRET_BYTES);
    hash_secret(secret, hash);
}

/* ---- changes */

static enum status give_groups(const struct log_txn *x, struct store_token *t,
                               struct errinfo *e)
{
    const enum status st = store_rules_groups(x, t->groups, e);

    if (st != ST_OK || rows_token_may_have(t->scopes, t->groups))
        return st;
    return errinfo_set(e, ST_EINVAL,
                       "a token that is bound to groups cannot have the scope audit: the "
                       "log and the statistics are about all subjects");
}

enum status store_token_create(struct store *s, const char *actor, const char *name,
                               unsigned scopes, const char *groups, int64_t end_ms,
                               char secret[65], struct store_token *t, struct errinfo *e)
{
    struct rows_token one = {.token = {.scopes = scopes}};
    struct log_txn x;
    enum status st;

    memset(t, 0, sizeof *t);
    secret[0] = '\0';
    if (!ident_printable(name, 1, STORE_NAME_MAX))
        return errinfo_set(e, ST_EINVAL, "a token's name is 1 to %d printable characters",
                           STORE_NAME_MAX);
    if (scopes == 0 || (scopes & ~(unsigned)STORE_SCOPE_ALL) != 0 || end_ms < 0)
        return errinfo_set(e, ST_EINVAL, "a token without a scope or an end");
    if ((st = check_end(end_ms, e)) != ST_OK ||
        (st = groups_read(groups, one.token.groups, e)) != ST_OK ||
        (st = store_act_begin(s, actor, SQL_WRITE, &x, e)) != ST_OK)
        return st;
    store_rules_random(one.token.id, STORE_ID_LEN / 2);
    (void)snprintf(one.token.name, sizeof one.token.name, "%s", name);
    memcpy(one.token.created, x.by.at, sizeof x.by.at);
    print_end(end_ms, one.token.expires);
    new_secret(secret, one.hash);
    if ((st = give_groups(&x, &one.token, e)) == ST_OK &&
        (st = rows_token_add(&x, &one, e)) == ST_OK)
        st = log_change(&x, "create_token", NULL, one.token.id, name, e);
    st = store_end(s, &x, st, e);
    *t = one.token;
    if (st != ST_OK)
        sodium_memzero(secret, 65);
    return st;
}

static enum status store_token_rotate_row(struct log_txn *x, const char *id,
                                          int64_t grace_s, int64_t end_ms,
                                          const unsigned char hash[ROWS_TOKEN_HASH],
                                          struct store_token *t, struct errinfo *e)
{
    struct rows_token one;
    enum status st = rows_token_get(x, id, &one, e);

    *t = one.token;
    if (st != ST_OK)
        return st;
    if (t->revoked[0] != '\0')
        return errinfo_set(e, ST_EDENIED, "token %s was revoked", id);
    if (end_ms != STORE_SAME_END)
        print_end(end_ms, t->expires);
    t->expired = store_rules_past(t->expires, x->by.ms);
    print_end(grace_s > 0 ? x->by.ms + grace_s * 1000 : STORE_NEVER, t->old_until);
    one.token = *t;
    memcpy(one.old_hash, one.hash, sizeof one.old_hash);
    memcpy(one.hash, hash, sizeof one.hash);
    if ((st = rows_token_write(x, &one, e)) != ST_OK)
        return st;
    return log_change(x, "rotate_token", NULL, id, t->name, e);
}

enum status store_token_rotate(struct store *s, const char *actor, const char *id,
                               int64_t grace_s, int64_t end_ms, char secret[65],
                               struct store_token *t, struct errinfo *e)
{
    unsigned char hash[ROWS_TOKEN_HASH];
    struct log_txn x;
    enum status st;

    memset(t, 0, sizeof *t);
    secret[0] = '\0';
    if (grace_s > STORE_LIFE_MAX)
        return errinfo_set(e, ST_EINVAL, "the old secret's grace is at most %lld days",
                           (long long)(STORE_LIFE_MAX / 86400));
    if ((st = ident_id(id, "token", e)) != ST_OK ||
        (st = check_end(end_ms, e)) != ST_OK ||
        (st = store_act_begin(s, actor, SQL_WRITE, &x, e)) != ST_OK)
        return st;
    new_secret(secret, hash);
    st = store_end(s, &x, store_token_rotate_row(&x, id, grace_s, end_ms, hash, t, e), e);
    if (st != ST_OK)
        sodium_memzero(secret, 65);
    return st;
}

static enum status revoke(struct log_txn *x, const char *id, struct errinfo *e)
{
    struct rows_token one;
    enum status st = rows_token_get(x, id, &one, e);

    if (st != ST_OK || one.token.revoked[0] != '\0')
        return st;
    memcpy(one.token.revoked, x->by.at, sizeof x->by.at);
    if ((st = rows_token_write(x, &one, e)) != ST_OK ||
        (st = store_lock_token(x, id, e)) != ST_OK ||
        (st = rows_attempts_revoke(x, id, e)) != ST_OK)
        return st;
    return log_change(x, "revoke_token", NULL, id, one.token.name, e);
}

enum status store_token_revoke(struct store *s, const char *actor, const char *id,
                               struct errinfo *e)
{
    struct log_txn x;
    enum status st;

    if ((st = ident_id(id, "token", e)) != ST_OK ||
        (st = store_act_begin(s, actor, SQL_WRITE, &x, e)) != ST_OK)
        return st;
    return store_end(s, &x, revoke(&x, id, e), e);
}

/* ---- reading */

enum status store_token_get(struct store *s, const char *actor, const char *id,
                            struct store_token *out, struct errinfo *e)
{
    struct rows_token one = {.revision = 0};
    struct log_txn x;
    enum status st;

    memset(out, 0, sizeof *out);
    if ((st = ident_id(id, "token", e)) != ST_OK ||
        (st = store_act_begin(s, actor, SQL_READ, &x, e)) != ST_OK ||
        (st = store_end(s, &x, rows_token_get(&x, id, &one, e), e)) != ST_OK)
        return st;
    *out = one.token;
    out->revision = one.revision;
    out->expired = store_rules_past(out->expires, x.by.ms);
    return ST_OK;
}

enum status store_token_list(struct store *s, const char *actor, struct store_token **out,
                             size_t *n, struct errinfo *e)
{
    void *list = NULL;
    size_t all = 0;
    struct log_txn x;
    enum status st;

    *out = NULL;
    *n = 0;
    if ((st = store_act_begin(s, actor, SQL_READ, &x, e)) != ST_OK)
        return st;
    st = store_end(s, &x, rows_table_all(&x, &rows_tokens, sizeof **out, &list, &all, e),
                   e);
    *out = list;
    for (size_t i = 0; i < all; i++)
        if (groups_within(x.groups, (*out)[i].groups)) {
            (*out)[*n] = (*out)[i];
            (*out)[*n].expired = store_rules_past((*out)[*n].expires, x.by.ms);
            ++*n;
        }
    return st;
}

int64_t store_token_left(const struct store_token *t)
{
    int64_t now, end;

    if (t->revoked[0] != '\0' || !utc_now(&now))
        return 0;
    if (t->expires[0] == '\0')
        return INT64_MAX;
    return utc_read(t->expires, &end) && end > now ? (end - now + 999) / 1000 : 0;
}

/* No request waits for this: if it cannot be recorded at once, the next request records it. */
static void note_use(struct store *s, struct store_token *t, int64_t ms)
{
    char now[UTC_TEXT];
    struct log_txn x;

    if (store_rules_recent(t->used, ms) || store_begin(s, SQL_TRY, &x, NULL) != ST_OK)
        return;
    utc_print(ms, now);
    if (store_end(s, &x, rows_token_used(&x, t->id, now, NULL), NULL) == ST_OK)
        memcpy(t->used, now, sizeof now);
}

/* Is the secret of this hash still accepted?  The row is found by the hash, of which a stranger can
 * choose neither the bits nor, by how long the search takes, learn any that would help to find a
 * secret. */
static enum status accept(const struct rows_token *one,
                          const unsigned char hash[ROWS_TOKEN_HASH], int64_t ms,
                          struct errinfo *e)
{
    const bool old = sodium_memcmp(hash, one->hash, ROWS_TOKEN_HASH) != 0;

    if (old && (one->token.old_until[0] == '\0' ||
                sodium_memcmp(hash, one->old_hash, ROWS_TOKEN_HASH) != 0))
        return errinfo_set(e, ST_EDENIED, "no such token");
    if (one->token.revoked[0] != '\0')
        return errinfo_set(e, ST_EDENIED, "the token was revoked");
    if (old && store_rules_past(one->token.old_until, ms))
        return errinfo_set(e, ST_EDENIED, "the token was rotated");
    if (store_rules_past(one->token.expires, ms))
        return errinfo_set(e, ST_EDENIED, "the token has expired");
    return ST_OK;
}

struct search { /* for a token, by the hash of its secret */
    struct log_txn x;
    unsigned char hash[ROWS_TOKEN_HASH];
    struct rows_token one;
};

static enum status find_token(void *arg, struct errinfo *e)
{
    struct search *f = arg;

    return rows_token_find(&f->x, f->hash, &f->one, e);
}

enum status store_token_check(struct store *s, const char *secret, struct store_token *t,
                              struct errinfo *e)
{
    struct search f;
    enum status st;

    memset(t, 0, sizeof *t);
    if (!ident_consists(secret, "0123456789abcdef", 2 * SECRET_BYTES, 2 * SECRET_BYTES))
        return errinfo_set(e, ST_EDENIED, "not a token");
    hash_secret(secret, f.hash);
    if ((st = store_start(s, NULL, SQL_READ, NULL, &f.x, e)) != ST_OK)
        return st;
    store_read_ahead(&f.x, find_token, &f);
    if ((st = store_check(s, &f.x, e)) != ST_OK)
        return st;
    st = store_end(s, &f.x, find_token(&f, e), e);
    if (st == ST_ENOTFOUND)
        st = errinfo_set(e, ST_EDENIED, "no such token");
    if (st != ST_OK || (st = accept(&f.one, f.hash, f.x.by.ms, e)) != ST_OK)
        return st;
    *t = f.one.token;
    t->revision =
        f.one.revision - (sodium_memcmp(f.hash, f.one.hash, ROWS_TOKEN_HASH) != 0);
    note_use(s, t, f.x.by.ms);
    return ST_OK;
}
