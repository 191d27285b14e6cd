#include "routes.h"

#include "capture.h"
#include "metrics.h"
#include "route.h"
#include "store.h"

#define TEMPLATE "/v1/templates/{template_id}"
#define SUBJECT  "/v1/subjects/{subject}"
#define TOKEN    "/v1/tokens/{token_id}"

/* The query parameters of a cloud, and of a comparison with one. */
#define CLOUD     "units, axes, fx, fy, cx, cy, depth_scale, width, height"
#define COMPARING CLOUD ", detail"
#define ENTRIES   "subject, subject_uid, kind, actor, since, until"

enum { /* who may: those whose token has the scope */
       ANYBODY = 0,
       ENROLL = STORE_SCOPE_ENROLL,
       VERIFY = STORE_SCOPE_VERIFY,
       IDENTIFY = STORE_SCOPE_IDENTIFY,
       CHECK = ENROLL | VERIFY | IDENTIFY, /* any of them */
       READ = STORE_SCOPE_READ,
       DELETE = STORE_SCOPE_DELETE,
       MANAGE = STORE_SCOPE_MANAGE,
       TOKENS = STORE_SCOPE_TOKENS,
       AUDIT = STORE_SCOPE_AUDIT,
       EVENTS = STORE_SCOPE_EVENTS,
       DETAIL = STORE_SCOPE_DETAIL,
       EVERY = STORE_SCOPE_ALL
};

static const struct route table[] = {
    {REQUEST_GET, "/", ROUTE_NO_BODY, ANYBODY, "", pages_root, ROUTE_QUICK},
    {REQUEST_GET, "/healthz", ROUTE_NO_BODY, ANYBODY, "", health_live, ROUTE_QUICK},
    {REQUEST_GET, "/readyz", ROUTE_NO_BODY, ANYBODY, "", health_ready, ROUTE_WORKER},
    {REQUEST_GET, "/metrics", ROUTE_NO_BODY, AUDIT | ROUTE_OR_LESS, "", metrics_handle,
     ROUTE_QUICK},
    {REQUEST_GET, "/openapi.json", ROUTE_NO_BODY, ANYBODY, "", pages_handle, ROUTE_QUICK},
    {REQUEST_GET, "/docs", ROUTE_NO_BODY, ANYBODY, "", pages_handle, ROUTE_QUICK},
    {REQUEST_GET, "/docs/style.css", ROUTE_NO_BODY, ANYBODY, "", pages_handle,
     ROUTE_QUICK},
    {REQUEST_GET, "/docs/script.js", ROUTE_NO_BODY, ANYBODY, "", pages_handle,
     ROUTE_QUICK},
    {REQUEST_GET, "/console", ROUTE_NO_BODY, ANYBODY, "", pages_console, ROUTE_QUICK},
    {REQUEST_GET, "/console/{file}", ROUTE_NO_BODY, ANYBODY, "", pages_console,
     ROUTE_QUICK},
    {REQUEST_GET, "/version", ROUTE_NO_BODY, ANYBODY, "", health_version, ROUTE_QUICK},
    {REQUEST_POST, SUBJECT "/templates", ROUTE_CLOUDS, ENROLL,
     CLOUD ", label, force, unique, fuse", enroll_handle, ROUTE_WORKER},
    {REQUEST_POST, SUBJECT "/verify", ROUTE_FRAMES, VERIFY, COMPARING, compare_subject,
     ROUTE_WORKER},
    {REQUEST_POST, TEMPLATE "/verify", ROUTE_FRAMES, VERIFY, COMPARING, compare_template,
     ROUTE_WORKER},
    {REQUEST_POST, "/v1/identify", ROUTE_FRAMES, IDENTIFY, CLOUD ", group, candidates",
     identify_scan, ROUTE_WORKER},
    {REQUEST_POST, "/v1/compare", ROUTE_PAIR, VERIFY, "units, axes, detail",
     compare_scans, ROUTE_WORKER},
    {REQUEST_POST, "/v1/challenge", ROUTE_NO_BODY, ENROLL | VERIFY, "", capture_challenge,
     ROUTE_WORKER},
    {REQUEST_GET, "/v1/recent", ROUTE_NO_BODY, AUDIT, "after, limit", live_recent,
     ROUTE_WORKER},
    {REQUEST_GET, "/v1/events", ROUTE_NO_BODY, EVENTS, "after, last, limit, wait",
     watch_events, ROUTE_WORKER},
    {REQUEST_DELETE, SUBJECT "/attempts", ROUTE_NO_BODY, MANAGE, "", live_reset,
     ROUTE_WORKER},
    {REQUEST_DELETE, TOKEN "/attempts", ROUTE_NO_BODY, MANAGE, "", live_reset_token,
     ROUTE_WORKER},
    {REQUEST_GET, "/v1/audit", ROUTE_NO_BODY, AUDIT, ENTRIES ", before, after, limit",
     logs_list, ROUTE_WORKER},
    {REQUEST_POST, "/v1/audit/verify", ROUTE_NO_BODY, AUDIT, "", logs_verify, ROUTE_SLOW},
    {REQUEST_GET, "/v1/audit/export", ROUTE_NO_BODY, AUDIT, "format, " ENTRIES,
     logs_export, ROUTE_SLOW},
    {REQUEST_GET, "/v1/token", ROUTE_NO_BODY, EVERY, "", tokens_own, ROUTE_WORKER},
    {REQUEST_GET, "/v1/stats", ROUTE_NO_BODY, AUDIT, "", health_stats, ROUTE_WORKER},
    {REQUEST_GET, "/v1/tokens", ROUTE_NO_BODY, TOKENS, "", tokens_list, ROUTE_WORKER},
    {REQUEST_POST, "/v1/tokens", ROUTE_JSON, TOKENS, "", tokens_create, ROUTE_WORKER},
    {REQUEST_DELETE, TOKEN, ROUTE_NO_BODY, TOKENS, "", tokens_revoke, ROUTE_WORKER},
    {REQUEST_POST, TOKEN "/rotate", ROUTE_JSON, TOKENS, "", tokens_rotate, ROUTE_WORKER},
    {REQUEST_POST, "/v1/check", ROUTE_CLOUD, CHECK, CLOUD ", detail", scans_check,
     ROUTE_WORKER},
    {REQUEST_POST, "/v1/asymmetry", ROUTE_CLOUD, VERIFY, CLOUD, scans_asymmetry,
     ROUTE_WORKER},
    {REQUEST_GET, "/v1/subjects", ROUTE_NO_BODY, READ, "q, state, group, limit, cursor",
     subjects_list, ROUTE_WORKER},
    {REQUEST_POST, "/v1/subjects", ROUTE_JSON, ENROLL, "", subjects_add, ROUTE_WORKER},
    {REQUEST_GET, SUBJECT, ROUTE_NO_BODY, READ, "", subjects_show, ROUTE_WORKER},
    {REQUEST_GET, SUBJECT "/templates/compare", ROUTE_NO_BODY, READ, "",
     compare_templates, ROUTE_WORKER},
    {REQUEST_PATCH, SUBJECT, ROUTE_MERGE, MANAGE, "", subjects_change, ROUTE_WORKER},
    {REQUEST_DELETE, SUBJECT, ROUTE_NO_BODY, DELETE, "", subjects_delete, ROUTE_WORKER},
    {REQUEST_GET, TEMPLATE, ROUTE_NO_BODY, READ, "", subjects_template, ROUTE_WORKER},
    {REQUEST_GET, TEMPLATE "/surface", ROUTE_NO_BODY, DETAIL, "format", scans_template,
     ROUTE_WORKER},
    {REQUEST_DELETE, TEMPLATE, ROUTE_NO_BODY, DELETE, "", subjects_template_delete,
     ROUTE_WORKER},
};

const struct route *routes_table(size_t *n)
{
    *n = sizeof table / sizeof *table;
    return table;
}
