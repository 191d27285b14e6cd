#include "auth.h"

#include <string.h>
#include <strings.h>
#include <sodium.h>

#include "app.h"
#include "errinfo.h"
#include "errmap.h"
#include "request.h"

void auth_take(struct request *r, const char *header)
{
    size_t len;

    if (header == NULL || strncasecmp(header, "Bearer ", 7) != 0) {
        request_problem(r, ERRMAP_NO_TOKEN, "send Authorization: Bearer TOKEN");
        return;
    }
    header += 7;
    header += strspn(header, " ");
    len = strlen(header);
    if (len == 0 || len > REQUEST_TOKEN_MAX) {
        request_problem(r, ERRMAP_NO_TOKEN, "the token is not valid");
        r->answer.bad_token = true;
        return;
    }
    memcpy(r->token, header, len + 1);
}

void auth_check(struct request *r)
{
    struct errinfo e = {0};
    enum status st = store_token_check(r->app->store, r->token, r->actor, &e);

    sodium_memzero(r->token, sizeof r->token);
    if (st == ST_EDENIED) {
        request_problem(r, ERRMAP_NO_TOKEN, "the token is not valid");
        r->answer.bad_token = true;
    } else if (st != ST_OK) {
        request_fail(r, &e);
    }
}
