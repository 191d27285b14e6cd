#include "cors.h"

#include <stddef.h>
#include <string.h>

#include "app.h"
#include "request.h"

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
        "Capture-Signature, If-None-Match");
    add(arg, "Access-Control-Max-Age", "600");
}
