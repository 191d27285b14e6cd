/* Tokens: made, listed, rotated, revoked. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ctl.h"

static const char *state_of(const struct store_token *t)
{
    return t->revoked ? "revoked" : t->expired ? "expired" : "valid";
}

/* A token as fields of the JSON; a time that is not set is left out. */
static void out_token(struct ctl *c, const struct store_token *t)
{
    char name[STORE_SCOPES_MAX];

    ctl_out_text(c->out, "id", t->id);
    ctl_out_text(c->out, "name", t->name);
    ctl_out_array(c->out, "scopes");
    for (unsigned one = 1; one <= STORE_SCOPE_ALL; one <<= 1)
        if (t->scopes & one) {
            store_scopes_write(one, name);
            ctl_out_text(c->out, NULL, name);
        }
    ctl_out_close(c->out);
    ctl_out_text(c->out, "created", t->created);
    if (t->expires[0] != '\0')
        ctl_out_text(c->out, "expires", t->expires);
    if (t->used[0] != '\0')
        ctl_out_text(c->out, "last_used", t->used);
    if (t->old_until[0] != '\0')
        ctl_out_text(c->out, "old_secret_until", t->old_until);
    ctl_out_text(c->out, "state", state_of(t));
    ctl_out_flag(c->out, "revoked", t->revoked);
}

/* The secret on standard output, alone, for $(...); what is said of it elsewhere. */
static void out_secret(struct ctl *c, const struct store_token *t, const char *secret)
{
    char scopes[STORE_SCOPES_MAX];

    out_token(c, t);
    ctl_out_text(c->out, "token", secret);
    if (c->json)
        return;
    store_scopes_write(t->scopes, scopes);
    (void)fprintf(stderr, "token %s (%s) for %s, good %s%s; it is shown this once:\n",
                  t->id, t->name, scopes, t->expires[0] != '\0' ? "until " : "for ever",
                  t->expires);
    (void)printf("%s\n", secret);
}

static enum status create(struct ctl *c, struct store *s)
{
    struct store_token t;
    char secret[65];
    const char *name = c->nargs > 0 ? c->args[0] : "unnamed";
    enum status st = store_token_create(s, CTL_ACTOR, name,
                                        c->scopes != 0 ? c->scopes : STORE_SCOPE_ALL,
                                        c->expires.life_s, secret, &t, &c->e);

    if (st == ST_OK)
        out_secret(c, &t, secret);
    return st;
}

static enum status rotate(struct ctl *c, struct store *s)
{
    struct store_token t;
    char secret[65];
    enum status st =
        store_token_rotate(s, CTL_ACTOR, c->args[0], c->grace_s,
                           c->expires.given ? c->expires.life_s : -1, secret, &t, &c->e);

    if (st != ST_OK)
        return st;
    out_secret(c, &t, secret);
    if (!c->json && t.expired)
        (void)fprintf(stderr, "it has expired; give --expires too\n");
    return ST_OK;
}

/* A time to the minute, as one reads it. */
static void print_time(const char *time, const char *none)
{
    if (time[0] == '\0')
        (void)printf("  %-16s", none);
    else
        (void)printf("  %.10s %.5s", time, time + 11);
}

static enum status list(struct ctl *c, struct store *s)
{
    struct store_token *t;
    char scopes[STORE_SCOPES_MAX];
    size_t n;
    enum status st = store_token_list(s, &t, &n, &c->e);

    if (st != ST_OK)
        return st;
    ctl_out_array(c->out, "tokens");
    if (!c->json)
        (void)printf("%-32s  %-7s  %-16s  %-16s  %-16s  %-41s  %s\n", "TOKEN ID", "STATE",
                     "CREATED (UTC)", "EXPIRES", "LAST USED", "SCOPES", "NAME");
    for (size_t i = 0; i < n; i++) {
        ctl_out_object(c->out, NULL);
        out_token(c, &t[i]);
        ctl_out_close(c->out);
        if (c->json)
            continue;
        store_scopes_write(t[i].scopes, scopes);
        (void)printf("%-32s  %-7s", t[i].id, state_of(&t[i]));
        print_time(t[i].created, "");
        print_time(t[i].expires, "never");
        print_time(t[i].used, "never");
        (void)printf("  %-41s  %s\n", scopes, t[i].name);
    }
    ctl_out_close(c->out);
    free(t);
    return ST_OK;
}

static enum status revoke(struct ctl *c, struct store *s)
{
    enum status st = store_token_revoke(s, CTL_ACTOR, c->args[0], &c->e);

    if (st != ST_OK)
        return st;
    ctl_out_text(c->out, "id", c->args[0]);
    ctl_out_flag(c->out, "revoked", true);
    if (!c->json)
        (void)printf("revoked %s\n", c->args[0]);
    return ST_OK;
}

static int run(struct ctl *c, enum store_mode mode,
               enum status (*what)(struct ctl *, struct store *))
{
    struct store *s = NULL;
    enum status st;

    if (c->expires.at_s > 0 && c->expires.life_s <= 0)
        return ctl_usage(c, "--expires is in the past");
    if ((st = ctl_open(c, mode, &s)) == ST_OK)
        st = what(c, s);
    store_close(s);
    return st == ST_OK ? EXIT_FINE : ctl_fail(c, st);
}

int ctl_token_create(struct ctl *c)
{
    return run(c, STORE_WRITE, create);
}

int ctl_token_list(struct ctl *c)
{
    return run(c, STORE_READ, list);
}

int ctl_token_rotate(struct ctl *c)
{
    return run(c, STORE_WRITE, rotate);
}

int ctl_token_revoke(struct ctl *c)
{
    return run(c, STORE_WRITE, revoke);
}
