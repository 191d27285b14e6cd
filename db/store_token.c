/* Tokens, as store.h tells. */
#include <sodium.h>
#include <stdio.h>
#include <string.h>

#include "errinfo.h"
#include "store_engine.h"
#include "store_rules.h"

#define SECRET_BYTES 32
#define USED_MS      60000 /* a token's use is noted no more often */

/* ---- scopes */

static const char *const scope_name[] = {"enroll", "verify", "identify", /* bit 0 first */
                                         "read",   "delete", "manage",   "detail"};

#define SCOPES (sizeof scope_name / sizeof *scope_name)

bool store_scopes_read(const char *text, unsigned *out)
{
    *out = 0;
    for (;;) {
        const size_t n = strcspn(text, ",");
        size_t i = 0;

        while (i < SCOPES &&
               (strlen(scope_name[i]) != n || memcmp(scope_name[i], text, n) != 0))
            i++;
        if (i == SCOPES)
            return false;
        *out |= 1U << i;
        if (text[n] == '\0')
            return true;
        text += n + 1;
    }
}

void store_scopes_write(unsigned scopes, char out[STORE_SCOPES_MAX])
{
    size_t n = 0;

    out[0] = '\0';
    for (size_t i = 0; i < SCOPES; i++)
        if (scopes & (1U << i))
            n += (size_t)snprintf(out + n, STORE_SCOPES_MAX - n, "%s%s", n > 0 ? "," : "",
                                  scope_name[i]);
}

/* ---- secrets */

/* The hash that is kept of a secret.  Secrets are 256 random bits: there is nothing to
 * guess, so a fast hash is enough. */
static void hash_secret(const char *secret, unsigned char hash[STORE_HASH_LEN])
{
    (void)crypto_generichash(hash, STORE_HASH_LEN, (const unsigned char *)secret,
                             strlen(secret), NULL, 0);
}

static enum status need_life(int64_t s, const char *what, struct errinfo *e)
{
    if (s <= STORE_LIFE_MAX)
        return ST_OK;
    return errinfo_set(e, ST_EINVAL, "a token's %s is at most %lld days", what,
                       (long long)(STORE_LIFE_MAX / 86400));
}

/* When it is over; "" for never. */
static void set_life(const struct store_act *by, int64_t life_s, char expires[32])
{
    expires[0] = '\0';
    if (life_s > 0)
        store_rules_time(by->ms + life_s * 1000, expires);
}

enum status store_token_create(struct store *s, const char *actor, const char *name,
                               unsigned scopes, int64_t life_s, char secret[65],
                               struct store_token *t, struct errinfo *e)
{
    unsigned char hash[STORE_HASH_LEN];
    struct store_act by;
    enum status st;

    memset(t, 0, sizeof *t);
    secret[0] = '\0';
    if (!store_rules_printable(name, 1, STORE_NAME_MAX))
        return errinfo_set(e, ST_EINVAL, "a token's name is 1 to %d printable characters",
                           STORE_NAME_MAX);
    if (scopes == 0 || (scopes & ~(unsigned)STORE_SCOPE_ALL) != 0 || life_s < 0)
        return errinfo_set(e, ST_EINVAL, "a token without a scope or a life");
    if ((st = need_life(life_s, "life", e)) != ST_OK ||
        (st = store_rules_act(&by, actor, e)) != ST_OK)
        return st;
    store_rules_random(t->id, STORE_ID_LEN / 2);
    (void)snprintf(t->name, sizeof t->name, "%s", name);
    (void)snprintf(t->created, sizeof t->created, "%s", by.at);
    t->scopes = scopes;
    set_life(&by, life_s, t->expires);
    store_rules_random(secret, SECRET_BYTES);
    hash_secret(secret, hash);
    st = s->engine->token_add(s, &by, t, hash, e);
    if (st != ST_OK)
        sodium_memzero(secret, 65);
    return st;
}

enum status store_token_rotate(struct store *s, const char *actor, const char *id,
                               int64_t grace_s, int64_t life_s, char secret[65],
                               struct store_token *t, struct errinfo *e)
{
    unsigned char hash[STORE_HASH_LEN];
    struct store_act by;
    enum status st;

    memset(t, 0, sizeof *t);
    secret[0] = '\0';
    if ((st = store_rules_id(id, "token", e)) != ST_OK ||
        (st = need_life(life_s, "life", e)) != ST_OK ||
        (st = need_life(grace_s, "grace", e)) != ST_OK ||
        (st = store_rules_act(&by, actor, e)) != ST_OK ||
        (st = s->engine->token_get(s, id, t, e)) != ST_OK)
        return st;
    if (t->revoked)
        return errinfo_set(e, ST_EDENIED, "token %s was revoked", id);
    if (life_s >= 0)
        set_life(&by, life_s, t->expires);
    t->expired = t->expires[0] != '\0' && strcmp(t->expires, by.at) <= 0;
    set_life(&by, grace_s, t->old_until);
    store_rules_random(secret, SECRET_BYTES);
    hash_secret(secret, hash);
    st = s->engine->token_rotate(s, &by, t, hash, e);
    if (st != ST_OK)
        sodium_memzero(secret, 65);
    return st;
}

enum status store_token_list(struct store *s, struct store_token **out, size_t *n,
                             struct errinfo *e)
{
    char now[STORE_RULES_TIME];
    int64_t ms;
    enum status st;

    *out = NULL;
    *n = 0;
    if ((st = store_rules_now(&ms, e)) != ST_OK ||
        (st = s->engine->token_list(s, out, n, e)) != ST_OK)
        return st;
    store_rules_time(ms, now);
    for (size_t i = 0; i < *n; i++) {
        struct store_token *t = &(*out)[i];

        t->expired = t->expires[0] != '\0' && strcmp(t->expires, now) <= 0;
    }
    return ST_OK;
}

enum status store_token_revoke(struct store *s, const char *actor, const char *id,
                               struct errinfo *e)
{
    struct store_act by;
    enum status st;

    if ((st = store_rules_id(id, "token", e)) != ST_OK ||
        (st = store_rules_act(&by, actor, e)) != ST_OK)
        return st;
    return s->engine->token_revoke(s, &by, id, e);
}

/* It is in use now.  Nobody is kept waiting for this to be noted: where it cannot be, the
 * next request does. */
static void note_use(struct store *s, struct store_token *t, int64_t now_ms)
{
    char now[STORE_RULES_TIME], before[STORE_RULES_TIME];

    store_rules_time(now_ms, now);
    store_rules_time(now_ms > USED_MS ? now_ms - USED_MS : 0, before);
    /* A time in the future is from before the clock was set back. */
    if (t->used[0] != '\0' && strcmp(t->used, before) > 0 && strcmp(t->used, now) <= 0)
        return;
    if (s->engine->token_use(s, t->id, now, NULL) == ST_OK)
        memcpy(t->used, now, sizeof now);
}

/* The row is found by the hash, of which a stranger can choose neither the bits nor, by
 * how long the search takes, learn any that would help to find a secret. */
enum status store_token_check(struct store *s, const char *secret, struct store_token *t,
                              struct errinfo *e)
{
    unsigned char hash[STORE_HASH_LEN], kept[STORE_HASH_LEN];
    char now[STORE_RULES_TIME];
    int64_t ms;
    bool old;
    enum status st;

    memset(t, 0, sizeof *t);
    if (!store_rules_consist(secret, "0123456789abcdef", 2 * SECRET_BYTES,
                             2 * SECRET_BYTES))
        return errinfo_set(e, ST_EDENIED, "not a token");
    hash_secret(secret, hash);
    if ((st = store_rules_now(&ms, e)) != ST_OK)
        return st;
    store_rules_time(ms, now);
    if ((st = s->engine->token_find(s, hash, t, kept, &old, e)) == ST_ENOTFOUND)
        st = errinfo_set(e, ST_EDENIED, "no such token");
    else if (st == ST_OK && sodium_memcmp(hash, kept, sizeof hash) != 0)
        st = errinfo_set(e, ST_EDENIED, "no such token");
    else if (st == ST_OK && t->revoked)
        st = errinfo_set(e, ST_EDENIED, "the token was revoked");
    else if (st == ST_OK && old && strcmp(t->old_until, now) <= 0)
        st = errinfo_set(e, ST_EDENIED, "the token was rotated");
    else if (st == ST_OK && t->expires[0] != '\0' && strcmp(t->expires, now) <= 0)
        st = errinfo_set(e, ST_EDENIED, "the token has expired");
    if (st == ST_OK)
        note_use(s, t, ms);
    else
        memset(t, 0, sizeof *t);
    return st;
}
