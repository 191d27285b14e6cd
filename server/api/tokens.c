#include "tokens.h"

#include "app.h"
#include "json.h"
#include "request.h"

/* The names of scopes, in the order of their bits. */
static void scopes(struct json *j, unsigned of)
{
    char name[STORE_SCOPES_MAX];

    json_array(j, "scopes");
    for (unsigned bit = 1; bit <= STORE_SCOPE_ALL; bit <<= 1)
        if (of & bit) {
            rows_scopes_write(bit, name);
            json_text(j, NULL, name);
        }
    json_close(j);
}

void tokens_own(struct request *r, struct worker *w)
{
    struct json *j = json_new();

    (void)w;
    json_text(j, "id", r->app->no_auth ? NULL : r->actor);
    json_text(j, "name", r->app->no_auth ? NULL : r->token_name);
    scopes(j, r->app->no_auth ? STORE_SCOPE_ALL : r->scopes);
    json_text(j, "expires_at", r->token_expires[0] != '\0' ? r->token_expires : NULL);
    request_respond(r, 200, json_compact(j));
}
