#include "routes.h"

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app.h"
#include "auth.h"
#include "describe.h"
#include "errinfo.h"
#include "errmap.h"
#include "json.h"
#include "parse.h"
#include "request.h"

void tokens_own(struct request *r, struct worker *w)
{
    struct json *j = json_new();

    (void)w;
    json_text(j, "id", r->app->no_auth ? NULL : r->actor);
    json_text(j, "name", r->app->no_auth ? NULL : r->token_name);
    describe_scopes(j, r->scopes);
    describe_groups(j, r->groups);
    json_text_or_null(j, "expires_at", r->token_expires);
    request_respond(r, 200, json_compact(j));
}

void tokens_list(struct request *r, struct worker *w)
{
    struct store_token *t = NULL;
    struct errinfo e = {0};
    struct json *j;
    size_t n = 0;

    (void)w;
    if (store_token_list(r->app->store, r->actor, &t, &n, &e) != ST_OK) {
        request_fail(r, &e);
        return;
    }
    j = json_new();
    json_array(j, "tokens");
    for (size_t i = 0; i < n; i++) {
        json_object(j, NULL);
        describe_token(j, &t[i], NULL);
        json_close(j);
    }
    free(t);
    request_respond(r, 200, json_compact(j));
}

/* With its secret, which is wiped. */
static void tokens_respond(struct request *r, int http, const struct store_token *t,
                           char secret[65])
{
    struct json *j = json_new();

    describe_token(j, t, secret);
    sodium_memzero(secret, 65);
    request_respond(r, http, json_compact(j));
}

void tokens_create(struct request *r, struct worker *w)
{
    struct parse_token what;
    struct store_token t;
    struct errinfo e = {0};
    char secret[65];

    (void)w;
    if (parse_token((const char *)r->body, r->len, &what, &e) != ST_OK) {
        request_fail(r, &e);
        return;
    }
    if (!auth_gives(r, what.scopes))
        return;
    if (store_token_create(r->app->store, r->actor, what.name, what.scopes, what.groups,
                           what.end_ms, secret, &t, &e) != ST_OK) {
        request_fail(r, &e);
        return;
    }
    tokens_respond(r, 201, &t, secret);
    if (r->response.http == 201)
        (void)snprintf(r->response.location, sizeof r->response.location, "/v1/tokens/%s",
                       t.id);
}

/* The token of the path, where r's may change it. */
static bool own_or_less(struct request *r, struct store_token *t)
{
    struct errinfo e = {0};

    if (store_token_get(r->app->store, r->actor, r->token_id, t, &e) != ST_OK) {
        request_fail(r, &e);
        return false;
    }
    return auth_gives(r, t->scopes); /* which never change */
}

void tokens_rotate(struct request *r, struct worker *w)
{
    struct store_token t;
    struct errinfo e = {0};
    char secret[65];
    int64_t grace_s;

    (void)w;
    if (parse_rotation((const char *)r->body, r->len, &grace_s, &e) != ST_OK) {
        request_fail(r, &e);
        return;
    }
    if (!own_or_less(r, &t))
        return;
    if (store_token_rotate(r->app->store, r->actor, r->token_id, grace_s, STORE_SAME_END,
                           secret, &t, &e) == ST_OK)
        tokens_respond(r, 200, &t, secret);
    else if (e.code == ST_EDENIED)
        request_problem(r, ERRMAP_REVOKED, "%s", e.msg);
    else
        request_fail(r, &e);
}

void tokens_revoke(struct request *r, struct worker *w)
{
    struct store_token t;
    struct errinfo e = {0};

    (void)w;
    if (strcmp(r->token_id, r->actor) == 0) {
        request_problem(r, ERRMAP_OWN_TOKEN,
                        "a token does not revoke itself: use another one, or surfacectl "
                        "token revoke");
        return;
    }
    if (!own_or_less(r, &t))
        return;
    if (store_token_revoke(r->app->store, r->actor, r->token_id, &e) == ST_OK)
        r->response.http = 204;
    else
        request_fail(r, &e);
}
