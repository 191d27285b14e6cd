#include "logs.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app.h"
#include "audit.h"
#include "errinfo.h"
#include "errmap.h"
#include "json.h"
#include "params.h"
#include "request.h"

#define PAGE_DEFAULT 100
#define PAGE_MAX     1000
#define LOOKED       50000 /* entries that a request looks at, at most: some 100 ms */
#define PLACE_MAX    40    /* bytes of one */

/* What is asked for, as texts that a filter points to. */
struct asked {
    struct store_audit_filter filter;
    char subject[STORE_SUBJECT_MAX + 1], kind[257], actor[LOG_TEXT + 1];
    char since[32], until[32];
};

static bool take(struct request *r, const char *name, char *to, size_t size,
                 const char **out)
{
    if (!params_text(r, name, to, size))
        return false;
    *out = to[0] != '\0' ? to : NULL;
    return true;
}

static bool ask(struct request *r, struct asked *a)
{
    struct store_audit_filter *f = &a->filter;

    memset(a, 0, sizeof *a);
    f->names = true;
    return take(r, "subject", a->subject, sizeof a->subject, &f->subject) &&
           take(r, "kind", a->kind, sizeof a->kind, &f->kind) &&
           take(r, "actor", a->actor, sizeof a->actor, &f->actor) &&
           take(r, "since", a->since, sizeof a->since, &f->since) &&
           take(r, "until", a->until, sizeof a->until, &f->until);
}

static bool take_place(struct request *r, const char *name, uint64_t least,
                       struct store_audit_place *out, bool *given)
{
    char text[PLACE_MAX] = "", again[PLACE_MAX];
    uint64_t *const seq = out->seq;

    if (!params_text(r, name, text, sizeof text))
        return false;
    if (!(*given = text[0] != '\0'))
        return true;
    if (strspn(text, "0123456789-") == strlen(text) && strlen(text) < 2 * 18 + 2 &&
        sscanf(text, "%18" SCNu64 "-%18" SCNu64, &seq[LOG_CHANGES], &seq[LOG_ACCESSES]) ==
            2 &&
        seq[LOG_CHANGES] >= least && seq[LOG_ACCESSES] >= least) {
        (void)snprintf(again, sizeof again, "%" PRIu64 "-%" PRIu64, seq[LOG_CHANGES],
                       seq[LOG_ACCESSES]);
        if (strcmp(again, text) == 0)
            return true;
    }
    request_problem(r, ERRMAP_PARAMETER, "%s is not the next_cursor of a page", name);
    return false;
}

static char *write_page(const struct store_audit_entry *a, size_t n,
                        const struct store_audit_place *next, bool more)
{
    struct json *j = json_new();
    char place[2 * PLACE_MAX];

    json_array(j, "entries");
    for (size_t i = 0; i < n; i++) {
        json_object(j, NULL);
        audit_describe(j, &a[i]);
        json_close(j);
    }
    json_close(j);
    (void)snprintf(place, sizeof place, "%" PRIu64 "-%" PRIu64, next->seq[LOG_CHANGES],
                   next->seq[LOG_ACCESSES]);
    json_text(j, "next_cursor", more ? place : NULL);
    return json_compact(j);
}

void logs_list(struct request *r, struct worker *w)
{
    struct store_audit_entry *list = NULL;
    struct store_audit_place next;
    struct errinfo e = {0};
    struct asked a;
    size_t n = 0, limit = PAGE_DEFAULT;
    bool before, after;

    (void)w;
    if (!ask(r, &a) || !params_count(r, "limit", PAGE_MAX, &limit) ||
        !take_place(r, "before", 1, &a.filter.from, &before) ||
        !take_place(r, "after", 0, &a.filter.from, &after))
        return;
    if (before && after) {
        request_problem(r, ERRMAP_PARAMETER, "before and after: one of them");
        return;
    }
    a.filter.limit = limit;
    a.filter.most = LOOKED;
    a.filter.newest = !after;
    if (store_audit_list(r->app->store, &a.filter, &list, &n, &next, &e) != ST_OK)
        request_fail(r, &e);
    else
        request_respond(r, 200, write_page(list, n, &next, after || !next.end));
    free(list);
}
