#include "route.h"

#include <stdio.h>
#include <string.h>

#include "errmap.h"
#include "request.h"

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

    for (int m = 0; m < REQUEST_OPTIONS; m++)
        if (methods >> m & 1)
            n += (size_t)snprintf(out + n, size - n, "%s%s%s", n > 0 ? ", " : "",
                                  method_name[m], m == REQUEST_GET ? ", HEAD" : "");
    (void)snprintf(out + n, size - n, ", OPTIONS");
}

void route_find(const struct route *table, size_t n, struct request *r)
{
    unsigned methods = 0;
    const char *param;

    for (size_t i = 0; i < n; i++) {
        if (!fits(table[i].pattern, r->target, &param))
            continue;
        methods |= 1u << table[i].method;
        if (table[i].method == r->method) {
            r->route = &table[i];
            return;
        }
    }
    if (r->method == REQUEST_OPTIONS && strcmp(r->target, "*") == 0)
        methods = (1u << REQUEST_OPTIONS) - 1; /* methods of the whole server */
    if (methods != 0) {
        write_allow(methods, r->response.allow, sizeof r->response.allow);
        if (r->method == REQUEST_OPTIONS) {
            r->response.http = 204;
            r->response.preflight = r->preflight;
            return;
        }
        request_problem(r, ERRMAP_METHOD, "this path accepts %s", r->response.allow);
    } else {
        request_problem(
            r, ERRMAP_ROUTE,
            "no such path: /docs lists the API's routes, /openapi.json describes them, "
            "/console is the console");
    }
}

void route_read_id(struct request *r)
{
    const char *param;
    enum status st;
    size_t len;

    if (!fits(r->route->pattern, r->target, &param) || param == NULL)
        return;
    len = (size_t)(segment_end(param) - param);
    if (strstr(r->route->pattern, "{subject}") != NULL) {
        st = request_decode(param, len, false, r->subject, sizeof r->subject);
        if (st != ST_OK || !ident_subject_valid(r->subject))
            request_problem(r, ERRMAP_PARAMETER, "%s", REQUEST_SUBJECT_ID);
    } else if (strstr(r->route->pattern, "{template_id}") != NULL) {
        st = request_decode(param, len, false, r->template_id, sizeof r->template_id);
        if (st != ST_OK || !ident_id_valid(r->template_id))
            request_problem(r, ST_ENOTFOUND, "there is no such template");
    } else if (strstr(r->route->pattern, "{token_id}") != NULL) {
        st = request_decode(param, len, false, r->token_id, sizeof r->token_id);
        if (st != ST_OK || !ident_id_valid(r->token_id))
            request_problem(r, ST_ENOTFOUND, "there is no such token");
    }
}

/* Which of the names in a list with ", " between it is, a bit each; 0: none of them. */
static unsigned listed(const char *list, const char *name, size_t len)
{
    for (unsigned bit = 1; *list != '\0'; bit <<= 1) {
        const size_t n = strcspn(list, ",");

        if (n == len && memcmp(list, name, n) == 0)
            return bit;
        list += n;
        list += strspn(list, ", ");
    }
    return 0;
}

void route_check_query(struct request *r)
{
    const char *p = strchr(r->target, '?'), *has = r->route->query;
    unsigned seen = 0;

    while (p != NULL && *p != '\0') {
        const size_t len = strcspn(++p, "&"), name = strcspn(p, "=&");
        const unsigned which = listed(has, p, name);
        const int shown = name > 64 ? 64 : (int)name;

        if (len > 0 && which == 0) {
            request_problem(r, ERRMAP_PARAMETER,
                            "unknown query parameter %.*s; this path accepts %s", shown,
                            p, *has != '\0' ? has : "none");
            return;
        }
        if ((seen & which) != 0) {
            request_problem(r, ERRMAP_PARAMETER,
                            "the query parameter %.*s is given "
                            "twice",
                            shown, p);
            return;
        }
        seen |= which;
        p += len;
    }
}

bool route_open(const struct route *route)
{
    return route->scope == 0 || (route->scope & ROUTE_OR_LESS) != 0;
}

const char *route_method(const struct route *route)
{
    return route == NULL ? "-" : method_name[route->method];
}

const char *route_pattern(const struct route *route)
{
    return route == NULL ? "none" : route->pattern;
}
