#include "routes.h"

#include <stdio.h>
#include <string.h>

#include "compare.h"
#include "docs.h"
#include "enroll.h"
#include "errmap.h"
#include "health.h"
#include "meta.h"
#include "subjects.h"
#include "symmetry.h"
#include "verify.h"

#define TEMPLATE "/v1/templates/{template_id}"
#define SUBJECT  "/v1/subjects/{subject}"

#define COMPARING "units, detail" /* the query parameters of a comparison */

enum { /* who may: those whose token has the scope */
       ANYBODY = 0,
       ENROLL = STORE_SCOPE_ENROLL,
       VERIFY = STORE_SCOPE_VERIFY,
       READ = STORE_SCOPE_READ,
       DELETE = STORE_SCOPE_DELETE,
       MANAGE = STORE_SCOPE_MANAGE
};

static const struct routes_route table[] = {
    {REQUEST_GET, "/healthz", ROUTES_NO_BODY, ANYBODY, "", health_live, true},
    {REQUEST_GET, "/readyz", ROUTES_NO_BODY, ANYBODY, "", health_ready, false},
    {REQUEST_GET, "/metrics", ROUTES_NO_BODY, ANYBODY, "", meta_metrics, true},
    {REQUEST_GET, "/openapi.json", ROUTES_NO_BODY, ANYBODY, "", meta_openapi, true},
    {REQUEST_GET, "/docs", ROUTES_NO_BODY, ANYBODY, "", docs_page, true},
    {REQUEST_GET, "/docs/style.css", ROUTES_NO_BODY, ANYBODY, "", docs_style, true},
    {REQUEST_GET, "/docs/script.js", ROUTES_NO_BODY, ANYBODY, "", docs_script, true},
    {REQUEST_GET, "/version", ROUTES_NO_BODY, ANYBODY, "", meta_version, true},
    {REQUEST_POST, SUBJECT "/templates", ROUTES_CLOUD, ENROLL, "units, label, force",
     enroll_handle, false},
    {REQUEST_POST, SUBJECT "/verify", ROUTES_CLOUD, VERIFY, COMPARING, verify_subject,
     false},
    {REQUEST_POST, TEMPLATE "/verify", ROUTES_CLOUD, VERIFY, COMPARING, verify_template,
     false},
    {REQUEST_POST, "/v1/compare", ROUTES_JSON, VERIFY, COMPARING, compare_handle, false},
    {REQUEST_POST, "/v1/asymmetry", ROUTES_CLOUD, VERIFY, "units", symmetry_handle,
     false},
    {REQUEST_GET, "/v1/subjects", ROUTES_NO_BODY, READ, "limit, cursor", subjects_list,
     false},
    {REQUEST_POST, "/v1/subjects", ROUTES_JSON, ENROLL, "", subjects_add, false},
    {REQUEST_GET, SUBJECT, ROUTES_NO_BODY, READ, "", subjects_show, false},
    {REQUEST_PATCH, SUBJECT, ROUTES_MERGE, MANAGE, "", subjects_change, false},
    {REQUEST_DELETE, SUBJECT, ROUTES_NO_BODY, DELETE, "", subjects_delete, false},
    {REQUEST_GET, TEMPLATE, ROUTES_NO_BODY, READ, "", subjects_template, false},
    {REQUEST_DELETE, TEMPLATE, ROUTES_NO_BODY, DELETE, "", subjects_template_delete,
     false},
};
#define NROUTES (sizeof table / sizeof *table)

_Static_assert(NROUTES + 1 <= ROUTES_MAX, "room for every route and for none");

/* The end of the segment that begins at s. */
static const char *segment_end(const char *s)
{
    return s + strcspn(s, "/?");
}

/* Does the path fit the pattern?  A parameter's raw segment is returned by its place. */
static bool fits(const char *pattern, const char *path, const char **param)
{
    *param = NULL;
    for (;;) {
        const char *pe, *te;

        if (*pattern != '/' || *path != '/')
            return *pattern == '\0' && (*path == '\0' || *path == '?');
        pe = segment_end(++pattern);
        te = segment_end(++path);
        if (*pattern == '{') {
            if (te == path)
                return false;
            *param = path;
        } else if (pe - pattern != te - path ||
                   memcmp(pattern, path, (size_t)(te - path)) != 0) {
            return false;
        }
        pattern = pe;
        path = te;
    }
}

static const char *const method_name[] = {
    [REQUEST_GET] = "GET",
    [REQUEST_POST] = "POST",
    [REQUEST_PATCH] = "PATCH",
    [REQUEST_DELETE] = "DELETE",
};

/* The value of Allow for the methods that a path has, a bit each. */
static void write_allow(unsigned methods, char *out, size_t size)
{
    size_t n = 0;

    for (int m = 0; m < REQUEST_OTHER; m++)
        if (methods >> m & 1)
            n += (size_t)snprintf(out + n, size - n, "%s%s%s", n > 0 ? ", " : "",
                                  method_name[m], m == REQUEST_GET ? ", HEAD" : "");
}

void routes_find(struct request *r)
{
    unsigned methods = 0;
    const char *param;

    for (size_t i = 0; i < NROUTES; i++) {
        if (!fits(table[i].pattern, r->target, &param))
            continue;
        methods |= 1u << table[i].method;
        if (table[i].method == r->method) {
            r->route = &table[i];
            return;
        }
    }
    if (methods != 0) {
        write_allow(methods, r->answer.allow, sizeof r->answer.allow);
        request_problem(r, ERRMAP_METHOD, "this path has the methods %s",
                        r->answer.allow);
    } else {
        request_problem(r, ERRMAP_ROUTE, "there is no such path");
    }
}

const char *routes_wants(const struct request *r)
{
    switch (r->route->body) {
    case ROUTES_CLOUD:
        return r->media == REQUEST_NO_MEDIA || r->media == REQUEST_MERGE ||
                       r->media == REQUEST_OTHER_MEDIA
                   ? "application/json, model/x-ply, application/x-ply, model/obj, "
                     "text/plain or application/octet-stream"
                   : NULL;
    case ROUTES_JSON:
        return r->media == REQUEST_JSON ? NULL : "application/json";
    case ROUTES_MERGE:
        return r->media == REQUEST_MERGE || r->media == REQUEST_JSON
                   ? NULL
                   : "application/merge-patch+json or application/json";
    case ROUTES_NO_BODY:
        break;
    }
    return NULL;
}

void routes_read_id(struct request *r)
{
    const char *param;
    enum status st;
    size_t len;

    if (!fits(r->route->pattern, r->target, &param) || param == NULL)
        return;
    len = (size_t)(segment_end(param) - param);
    if (strstr(r->route->pattern, "{subject}") != NULL) {
        st = request_decode(param, len, false, r->subject, sizeof r->subject);
        if (st != ST_OK || !store_subject_valid(r->subject))
            request_problem(r, ERRMAP_PARAMETER,
                            "the subject id is not 1-%d characters of "
                            "A-Z a-z 0-9 . _ - @ :",
                            STORE_SUBJECT_MAX);
    } else {
        st = request_decode(param, len, false, r->template_id, sizeof r->template_id);
        if (st != ST_OK || !store_id_valid(r->template_id))
            request_problem(r, ST_ENOTFOUND, "there is no such template");
    }
}

/* Is this one of the names in a list with ", " between? */
static bool is_listed(const char *list, const char *name, size_t len)
{
    while (*list != '\0') {
        const size_t n = strcspn(list, ",");

        if (n == len && memcmp(list, name, n) == 0)
            return true;
        list += n;
        list += strspn(list, ", ");
    }
    return false;
}

void routes_check_query(struct request *r)
{
    const char *p = strchr(r->target, '?'), *has = r->route->query;

    while (p != NULL && *p != '\0') {
        const size_t len = strcspn(++p, "&"), name = strcspn(p, "=&");

        if (len > 0 && !is_listed(has, p, name)) {
            request_problem(r, ERRMAP_PARAMETER,
                            "there is no query parameter %.*s here: this path has %s",
                            name > 64 ? 64 : (int)name, p, *has != '\0' ? has : "none");
            return;
        }
        p += len;
    }
}

size_t routes_index(const struct routes_route *route)
{
    return route == NULL ? 0 : (size_t)(route - table) + 1;
}

const char *routes_name(size_t index, const char **method)
{
    *method = "-";
    if (index == 0)
        return "none";
    if (index > NROUTES)
        return NULL;
    *method = method_name[table[index - 1].method];
    return table[index - 1].pattern;
}
