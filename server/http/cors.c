#include "cors.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "app.h"
#include "errmap.h"
#include "request.h"
#include "route.h"

void cors_take(struct request *r)
{
    const size_t n = strlen(r->origin);

    if (r->app->cors_origin == NULL)
        return;
    r->response.origin = ""; /* others get another response, also from a cache */
    for (const char *p = r->app->cors_origin; n > 0 && *p != '\0';
         p += strcspn(p, ","), p += *p == ',')
        if (strcspn(p, ",") == n && memcmp(p, r->origin, n) == 0)
            r->response.origin = r->origin;
}

/* Host is this machine's own name or address: a page of another site cannot make it so, though it can
 * have its site's name mean this machine (DNS rebinding). */
static bool is_loopback(const char *host)
{
    static const char *const name[] = {"localhost", "[::1]"};
    unsigned a, b, c;
    size_t n = strcspn(host, ":");
    int end = -1;

    if (host[0] == '[')
        n = strcspn(host, "]") + 1;
    for (size_t i = 0; i < sizeof name / sizeof *name; i++)
        if (strlen(name[i]) == n && strncasecmp(name[i], host, n) == 0)
            return true;
    return sscanf(host, "127.%3u.%3u.%3u%n", &a, &b, &c, &end) == 3 && end == (int)n;
}

static bool is_own(const struct request *r)
{
    const char *at = strstr(r->origin, "://");

    return at != NULL && strcasecmp(at + 3, r->host) == 0;
}

bool cors_refuse(struct request *r)
{
    const bool named = r->response.origin != NULL && r->response.origin[0] != '\0';
    const bool foreign =
        !named && (r->cross_site || (r->origin[0] != '\0' && !is_own(r)));

    if (!r->app->no_auth || r->route->scope == 0 || strcmp(r->client, "unix") == 0 ||
        (!foreign && (r->host[0] == '\0' || is_loopback(r->host))))
        return false;
    request_problem(
        r, ERRMAP_OTHER_SITE,
        "a daemon without tokens (--no-auth) serves programs and its own console: "
        "%s",
        foreign
            ? "this comes from a page of another site (--cors-origin names those that may)"
            : "Host is not localhost or a loopback address");
    return true;
}

void cors_headers(const struct response *a,
                  void (*add)(void *arg, const char *name, const char *value), void *arg)
{
    if (a->origin == NULL)
        return;
    add(arg, "Vary", "Origin");
    if (a->origin[0] == '\0')
        return;
    add(arg, "Access-Control-Allow-Origin", a->origin);
    if (!a->preflight) {
        add(arg, "Access-Control-Expose-Headers",
            "X-Request-Id, Location, Retry-After, WWW-Authenticate, Allow, ETag, "
            "Content-Disposition, Preference-Applied");
        return;
    }
    add(arg, "Access-Control-Allow-Methods", a->allow);
    add(arg, "Access-Control-Allow-Headers",
        "Authorization, Content-Type, Content-Encoding, Prefer, X-Request-Id, "
        "Capture-Signature, If-None-Match, Last-Event-ID");
    add(arg, "Access-Control-Max-Age", "600");
}
