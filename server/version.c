#include "version.h"

#include <string.h>

#include "app.h"
#include "render.h"
#include "request.h"
#include "store.h"

void version_handle(struct request *r, struct worker *w)
{
    /* "surfaced/VERSION measure/N model/HHHHHHHH" */
    const char *engine = store_made_by(r->app->store), *from = strchr(engine, '/') + 1;
    char version[32] = "";

    (void)w;
    memcpy(version, from, strcspn(from, " "));
    request_respond(r, 200, render_version(version, engine, __VERSION__));
}
