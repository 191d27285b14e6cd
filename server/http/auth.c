#include "auth.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sodium.h>

#include "app.h"
#include "errinfo.h"
#include "errmap.h"
#include "logger.h"
#include "request.h"
#include "route.h"
#include "store.h"
#include "throttle.h"

bool auth_take(struct request *r, const char *header)
{
    unsigned wait_s;
    size_t len;

    if (header == NULL || strncasecmp(header, "Bearer ", 7) != 0) {
        request_problem(r, ERRMAP_NO_TOKEN, "send Authorization: Bearer TOKEN");
        return false;
    }
    header += 7;
    header += strspn(header, " ");
    len = strlen(header);
    if (len == 0 || len > REQUEST_TOKEN_MAX) {
        request_problem(r, ERRMAP_NO_TOKEN, "the token is not valid");
        r->response.bad_token = true;
        return false;
    }
    memcpy(r->token, header, len + 1);
    wait_s = throttle_wait(r->app->throttle, r->address, r->token, logger_clock_ms());
    if (wait_s == 0)
        return true;
    sodium_memzero(r->token, sizeof r->token);
    request_problem(r, ERRMAP_TOKENS, "too many wrong tokens came from this address");
    r->response.retry_after = wait_s;
    return false;
}

bool auth_has(const struct request *r, unsigned scopes)
{
    return (r->scopes & scopes) != 0;
}

bool auth_scores(const struct request *r)
{
    return auth_has(r, STORE_SCOPE_SCORE | STORE_SCOPE_DETAIL | STORE_SCOPE_MANAGE);
}

bool auth_may(struct request *r, unsigned scopes)
{
    char has[STORE_SCOPES_MAX], lacks[STORE_SCOPES_MAX];

    if (auth_has(r, scopes))
        return true;
    rows_scopes_write(r->scopes, has);
    rows_scopes_write(scopes, lacks);
    if (r->app->no_auth)
        request_problem(r, ERRMAP_SCOPE,
                        "a daemon without tokens (--no-auth) makes and revokes none: "
                        "surfacectl token does");
    else
        request_problem(r, ERRMAP_SCOPE,
                        "this request needs a token with %s %s; yours has "
                        "%s",
                        strchr(lacks, ',') != NULL ? "one of the scopes" : "the scope",
                        lacks, has);
    r->response.lacks = scopes;
    r->response.challenge = true;
    return false;
}

bool auth_gives(struct request *r, unsigned scopes)
{
    const unsigned lacks = scopes & ~r->scopes;
    char words[STORE_SCOPES_MAX];

    if (lacks == 0)
        return true;
    rows_scopes_write(lacks, words);
    request_problem(r, ERRMAP_SCOPE,
                    "a token makes, renews and revokes only tokens that may do no more "
                    "than it does: this one lacks %s",
                    words);
    r->response.lacks = lacks;
    r->response.challenge = true;
    return false;
}

bool auth_free(struct request *r)
{
    r->scopes = STORE_SCOPE_ALL & ~(unsigned)STORE_SCOPE_TOKENS;
    return r->route->scope == 0 || auth_may(r, r->route->scope);
}

void auth_check(struct request *r)
{
    struct errinfo e = {0};
    struct store_token t;
    enum status st = store_token_check(r->app->store, r->token, &t, &e);

    if (st == ST_OK || st == ST_EDENIED)
        throttle_note(r->app->throttle, r->address, r->token, st == ST_OK,
                      logger_clock_ms());
    sodium_memzero(r->token, sizeof r->token);
    if (st == ST_OK) {
        memcpy(r->actor, t.id, sizeof r->actor);
        r->scopes = t.scopes;
        r->token_revision = t.revision;
        memcpy(r->groups, t.groups, sizeof r->groups);
        memcpy(r->token_name, t.name, sizeof r->token_name);
        memcpy(r->token_expires, t.expires, sizeof r->token_expires);
        (void)auth_may(r, r->route->scope);
    } else if (st == ST_EDENIED) {
        request_problem(r, ERRMAP_NO_TOKEN, "the token is not valid");
        r->response.bad_token = true;
    } else if (!route_open(r->route)) {
        request_fail(r, &e);
    }
}

void auth_challenge(const struct response *a, char out[AUTH_CHALLENGE_MAX])
{
    char scope[STORE_SCOPES_MAX];

    rows_scopes_write(a->lacks, scope);
    for (char *comma = scope; (comma = strchr(comma, ',')) != NULL;) /* RFC 6750's list */
        *comma = ' ';
    if (a->lacks != 0)
        (void)snprintf(
            out, AUTH_CHALLENGE_MAX,
            "Bearer realm=\"surfaced\", error=\"insufficient_scope\", scope=\"%s\"",
            scope);
    else
        (void)snprintf(out, AUTH_CHALLENGE_MAX, "Bearer realm=\"surfaced\"%s",
                       a->bad_token ? ", error=\"invalid_token\"" : "");
}
