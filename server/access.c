#include "access.h"

#include <stdio.h>

#include "log.h"
#include "request.h"
#include "route.h"

void access_log(const struct request *r, int http, double ms)
{
    struct log_entry l;
    char key[32];

    log_begin(&l, r->fault[0] == '\0' ? "info" : "error", "request");
    log_text(&l, "request_id", r->id);
    log_text(&l, "method", route_method(r->route));
    log_text(&l, "route", route_pattern(r->route));
    log_count(&l, "status", (uint64_t)http);
    log_real(&l, "ms", ms, 3);
    for (enum request_stage i = 0; i < REQUEST_STAGES; i++) {
        if ((r->stages >> i & 1) == 0)
            continue;
        (void)snprintf(key, sizeof key, "%s_ms", request_stage_name(i));
        log_real(&l, key, r->stage_ms[i], 3);
    }
    if (r->actor[0] != '\0')
        log_text(&l, "token", r->actor);
    if (r->fault[0] != '\0')
        log_text(&l, "fault", r->fault);
    log_end(&l);
}
