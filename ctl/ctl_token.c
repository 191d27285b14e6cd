/* Tokens: made, listed, rotated, revoked. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ctl_token.h"
#include "describe.h"
#include "ctl_command.h"
#include "ctl_model.h"

static unsigned scopes;   /* --scope; 0: not given */
static int64_t grace_s;   /* --grace */
static const char *group; /* --group */

/* Prints the secret alone on standard output, for $(...), and its description on standard error. */
static void out_secret(struct ctl *c, const struct store_token *t, const char *secret)
{
    char list[STORE_SCOPES_MAX];

    describe_token(c->out, t, secret);
    if (c->json)
        return;
    rows_scopes_write(t->scopes, list);
    (void)fprintf(
        stderr, "token %s (%s) for %s%s%s, valid %s%s; its secret is not shown again:\n",
        t->name, t->id, list, t->groups[0] != '\0' ? " in the groups " : "", t->groups,
        t->expires[0] != '\0' ? "until " : "forever", t->expires);
    (void)printf("%s\n", secret);
}

/* All scopes, or no end, have to be asked for. */
static enum status ctl_run_token_create(struct ctl *c)
{
    struct store_token t;
    char secret[65], all[STORE_SCOPES_MAX];
    const char *name = c->nargs > 0 ? c->args[0] : "unnamed";
    int64_t end_ms;
    enum status st;

    (void)utc_now(&end_ms);
    end_ms = c->expires.given ? c->expires.end_ms : end_ms + STORE_TOKEN_LIFE_S * 1000;
    if (scopes == 0) {
        rows_scopes_write(STORE_SCOPE_ALL, all);
        return ctl_usage(c, "token create needs --scope: one or more of %s", all);
    }
    if ((st = ctl_model_open(c, STORE_WRITE)) == ST_OK)
        st = store_token_create(c->store, c->actor, name, scopes,
                                group != NULL ? group : "", end_ms, secret, &t, &c->e);
    if (st == ST_OK)
        out_secret(c, &t, secret);
    return st;
}

enum status ctl_token_find(struct ctl *c, const char *name, bool revoked,
                           char id[STORE_ID_LEN + 1])
{
    struct store_token *t;
    char list[sizeof c->e.msg] = "";
    size_t n, found = 0, used = 0;
    enum status st;

    (void)snprintf(id, STORE_ID_LEN + 1, "%s", name);
    if (ident_id_valid(name))
        return ST_OK;
    if ((st = store_token_list(c->store, c->actor, &t, &n, &c->e)) != ST_OK)
        return st;
    for (size_t i = 0; i < n; i++) {
        if ((t[i].revoked[0] != '\0' && !revoked) || strcmp(t[i].name, name) != 0)
            continue;
        memcpy(id, t[i].id, sizeof t[i].id);
        found++;
        if (used < sizeof list)
            used += (size_t)snprintf(list + used, sizeof list - used, " %s", t[i].id);
    }
    free(t);
    if (found == 0)
        return errinfo_set(&c->e, ST_ENOTFOUND,
                           "there is no token %.80s, or it is revoked already", name);
    if (found > 1)
        return errinfo_set(&c->e, ST_EINVAL, "%zu tokens have this name, choose by id:%s",
                           found, list);
    return ST_OK;
}

static enum status ctl_run_token_rotate(struct ctl *c)
{
    struct store_token t;
    char id[STORE_ID_LEN + 1], secret[65];
    enum status st = ctl_model_open(c, STORE_WRITE);

    if (st == ST_OK && (st = ctl_token_find(c, c->args[0], false, id)) == ST_OK)
        st = store_token_rotate(c->store, c->actor, id, grace_s,
                                c->expires.given ? c->expires.end_ms : STORE_SAME_END,
                                secret, &t, &c->e);
    if (st != ST_OK)
        return st;
    out_secret(c, &t, secret);
    if (!c->json && t.expired)
        (void)fprintf(stderr, "the token has expired; give --expires too\n");
    return ST_OK;
}

void ctl_token_label(char out[CTL_TOKEN_LABEL], const char *name, const char *id)
{
    if (name[0] != '\0')
        (void)snprintf(out, CTL_TOKEN_LABEL, "%s (%.8s)", name, id);
    else
        (void)snprintf(out, CTL_TOKEN_LABEL, "%s", id);
}

/* A time to the minute, as one reads it. */
static void print_time(const char *time, const char *none)
{
    if (time[0] == '\0')
        (void)printf("  %-16s", none);
    else
        (void)printf("  %.10s %.5s", time, time + 11);
}

static enum status ctl_run_token_list(struct ctl *c)
{
    struct store_token *t;
    char words[STORE_SCOPES_MAX];
    size_t n;
    enum status st = store_token_list(c->store, c->actor, &t, &n, &c->e);

    if (st != ST_OK)
        return st;
    json_array(c->out, "tokens");
    ctl_say(c, "%-20s  %-7s  %-16s  %-16s  %-16s  %-32s  %-16s  %s\n", "NAME", "STATE",
            "CREATED (UTC)", "EXPIRES", "LAST USED", "TOKEN ID", "GROUPS", "SCOPES");
    for (size_t i = 0; i < n; i++) {
        json_object(c->out, NULL);
        describe_token(c->out, &t[i], NULL);
        json_close(c->out);
        if (c->json)
            continue;
        rows_scopes_write(t[i].scopes, words);
        (void)printf("%-20s  %-7s", t[i].name, describe_token_state(&t[i]));
        print_time(t[i].created, "");
        print_time(t[i].expires, "never");
        print_time(t[i].used, "never");
        (void)printf("  %-32s  %-16s  %s\n", t[i].id,
                     t[i].groups[0] != '\0' ? t[i].groups : "all", words);
    }
    json_close(c->out);
    free(t);
    return ST_OK;
}

static enum status revoke(struct ctl *c)
{
    struct store_token t;
    char id[STORE_ID_LEN + 1];
    enum status st = ctl_token_find(c, c->args[0], false, id);

    if (st != ST_OK ||
        (st = store_token_revoke(c->store, c->actor, id, &c->e)) != ST_OK ||
        (st = store_token_get(c->store, c->actor, id, &t, &c->e)) != ST_OK)
        return st;
    json_text(c->out, "id", id);
    json_text(c->out, "name", t.name);
    json_flag(c->out, "revoked", true);
    ctl_say(c, "revoked %s (%s)\n", t.name, id);
    return ST_OK;
}

/* ---- the commands */

const struct ctl_command ctl_token_create = {
    .name = "token create",
    .args = "[NAME]",
    .takes = {0, 1},
    .database = CTL_NEEDS_DATABASE,
    .shared = CTL_EXPIRES,
    .options =
        {CTL_OPTION("scope", "LIST", ctl_option_scopes, &scopes,
                    "what the token may do: some of verify,enroll,identify,read,delete,\n"
                    "manage,tokens,audit,events,score,detail"),
         CTL_OPTION("group", "LIST", command_text, &group,
                    "bind it to these groups of subjects: door-3,staff (all subjects)")},
    .run = ctl_run_token_create,
    .summary = "make a Bearer token for the daemon",
    .help = "Its secret is printed once. It is valid for a year, or until --expires.",
    .example =
        "surfacectl --db faces.db token create front-door --scope verify --expires 90d"};

const struct ctl_command ctl_token_list = {
    .name = "token list",
    .database = CTL_READS_DATABASE,
    .run = ctl_run_token_list,
    .summary = "list the tokens",
    .help = "Scopes, groups, end and last use of each.",
    .example = "surfacectl --db faces.db token list"};

const struct ctl_command ctl_token_rotate = {
    .name = "token rotate",
    .args = "NAME|ID",
    .takes = {1, 1},
    .database = CTL_NEEDS_DATABASE,
    .shared = CTL_EXPIRES,
    .options = {CTL_OPTION(
        "grace", "TIME", ctl_option_duration, &grace_s,
        "how long the old secret stays valid: 1d, 12h, 30m (not at all)")},
    .run = ctl_run_token_rotate,
    .summary = "replace a token's secret",
    .help = "The new secret is printed once. A running daemon accepts it at once.",
    .example = "surfacectl --db faces.db token rotate front-door --grace 1h"};

const struct ctl_command ctl_token_revoke = {
    .name = "token revoke",
    .args = "NAME|ID",
    .takes = {1, 1},
    .database = CTL_WRITES_DATABASE,
    .run = revoke,
    .summary = "revoke a token",
    .help = "A running daemon refuses it at once.",
    .example = "surfacectl --db faces.db token revoke front-door"};
