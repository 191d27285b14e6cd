#include "version.h"

#include <string.h>

#include "app.h"
#include "render.h"
#include "request.h"
#include "store.h"

void version_handle(struct request *r, struct worker *w)
{
    /* "surfaced/VERSION measure/N model/HHHHHHHH" */
    const char *from = strchr(store_made_by(r->app->store), '/') + 1;
    char version[32] = "";

    (void)w;
    memcpy(version, from, strcspn(from, " "));
    request_respond(r, 200, render_version(version));
}
