#include "routes.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app.h"
#include "audit.h"
#include "auth.h"
#include "errinfo.h"
#include "describe.h"
#include "errmap.h"
#include "intake.h"
#include "json.h"
#include "parse.h"
#include "params.h"
#include "request.h"

#define PAGE_DEFAULT 100
#define PAGE_MAX     1000

#define SUBJECTS_CURSOR 24 /* digits of a key */

/* ---- as JSON */

static char *write_template(const struct store_template *t, bool how)
{
    struct json *j = json_new();

    describe_template(j, t, NULL, how);
    return json_compact(j);
}

static char *write_subject(const struct store_subject *s, const struct store_worst *a,
                           const struct store_template *t, size_t n, bool how)
{
    struct json *j = json_new();

    describe_subject(j, s);
    describe_attempts(j, a);
    json_array(j, "templates");
    for (size_t i = 0; i < n; i++) {
        json_object(j, NULL);
        describe_template(j, &t[i], NULL, how);
        json_close(j);
    }
    return json_compact(j);
}

/* next: the last key that was looked at; 0: there are no more. */
static char *write_subjects(const struct store_subject *s, size_t n, int64_t next)
{
    struct json *j = json_new();
    char cursor[24] = "";

    json_array(j, "subjects");
    for (size_t i = 0; i < n; i++) {
        json_object(j, NULL);
        describe_subject_row(j, &s[i]);
        json_text_or_null(j, "locked_until", s[i].locked);
        json_close(j);
    }
    json_close(j);
    (void)snprintf(cursor, sizeof cursor, "%lld", (long long)next);
    json_text(j, "next_cursor", next != 0 ? cursor : NULL);
    return json_compact(j);
}

static char *write_erased(const struct store_receipt *r)
{
    struct json *j = json_new();

    audit_receipt(j, r);
    return json_compact(j);
}

/* ---- requests */

/* The key of the page's last subject; none at all is the first page. */
static enum status read_cursor(const char *text, int64_t *after)
{
    if (strspn(text, "0123456789") != strlen(text))
        return ST_EINVAL;
    errno = 0;
    *after = text[0] == '\0' ? 0 : strtoll(text, NULL, 10);
    return errno == 0 ? ST_OK : ST_EINVAL;
}

void subjects_list(struct request *r, struct worker *w)
{
    char cursor[SUBJECTS_CURSOR], part[STORE_SUBJECT_MAX + 1] = "", state[16] = "";
    char group[GROUPS_LABEL + 1] = "";
    struct store_search what = {
        .group = group, .part = part, .limits = &r->app->limits, .limit = PAGE_DEFAULT};
    struct store_subject *s = NULL;
    struct errinfo e = {0};
    enum status st;
    size_t n = 0;
    int64_t next;

    (void)w;
    if (!params_text(r, "q", part, sizeof part) ||
        !params_text(r, "state", state, sizeof state) || !params_group(r, group) ||
        !params_count(r, "limit", 1, PAGE_MAX, &what.limit))
        return;
    st = request_query(r, "cursor", cursor, sizeof cursor);
    if ((st != ST_OK && st != ST_ENOTFOUND) || read_cursor(cursor, &what.after) != ST_OK)
        request_problem(r, ERRMAP_PARAMETER,
                        "cursor must be the next_cursor of an "
                        "earlier response");
    else if (state[0] != '\0' && !store_subject_state(state, &what.state))
        request_problem(
            r, ERRMAP_PARAMETER,
            "state must be active, disabled, hold, expired, ending, locked or no_consent, "
            "not '%s'",
            state);
    else if (store_subject_search(r->app->store, r->actor, &what, &s, &n, &next, &e) !=
             ST_OK)
        request_fail(r, &e);
    else
        request_respond(r, 200, write_subjects(s, n, next));
    free(s);
}

/* 200 with the subject as it is now; respond: request_respond() or request_written(). */
static void subjects_show_one(struct request *r,
                              void (*respond)(struct request *, int, char *))
{
    struct store_subject s;
    struct store_template *t = NULL;
    struct store_worst a;
    struct errinfo e = {0};
    size_t n = 0;

    if (store_subject_get(r->app->store, r->actor, r->subject, &s, &e) != ST_OK ||
        store_attempts_worst(r->app->store, r->actor, r->subject, &r->app->limits, &a,
                             &e) != ST_OK ||
        store_template_list(r->app->store, r->actor, r->subject, &t, &n, &e) != ST_OK)
        request_fail(r, &e);
    else
        respond(r, 200, write_subject(&s, &a, t, n, auth_scores(r)));
    free(t);
}

void subjects_show(struct request *r, struct worker *w)
{
    (void)w;
    subjects_show_one(r, request_respond);
}

void subjects_add(struct request *r, struct worker *w)
{
    struct store_subject s;
    struct errinfo e = {0};

    (void)w;
    if (parse_newcomer((const char *)r->body, r->len, &s, &e) != ST_OK) {
        request_fail(r, &e);
        return;
    }
    if (!intake_admit(r))
        return;
    if (store_subject_add(r->app->store, r->actor, &s, &e) != ST_OK) {
        request_fail(r, &e);
        return;
    }
    request_written(
        r, 201, write_subject(&s, &(struct store_worst){.failures = 0}, NULL, 0, false));
    if (r->response.http == 201)
        (void)snprintf(r->response.location, sizeof r->response.location,
                       "/v1/subjects/%s", s.id);
}

void subjects_change(struct request *r, struct worker *w)
{
    struct parse_change to;
    struct errinfo e = {0};

    (void)w;
    if (parse_change((const char *)r->body, r->len, &to, &e) != ST_OK ||
        store_subject_set(r->app->store, r->actor, r->subject, &to.what, &e) != ST_OK)
        request_fail(r, &e);
    else
        subjects_show_one(r, request_written);
}

void subjects_delete(struct request *r, struct worker *w)
{
    struct store_receipt receipt;
    struct errinfo e = {0};

    (void)w;
    if (store_subject_erase(r->app->store, r->actor, r->subject, &receipt, &e) != ST_OK) {
        request_fail(r, &e);
        goto out;
    }
    request_written(r, 200, write_erased(&receipt));
out:
    store_receipt_free(&receipt);
}

void subjects_template(struct request *r, struct worker *w)
{
    struct store_template t;
    struct errinfo e = {0};

    (void)w;
    if (store_template_get(r->app->store, r->actor, r->template_id, &t, &e) != ST_OK)
        request_fail(r, &e);
    else
        request_respond(r, 200, write_template(&t, auth_scores(r)));
}

void subjects_template_delete(struct request *r, struct worker *w)
{
    struct errinfo e = {0};

    (void)w;
    if (store_template_delete(r->app->store, r->actor, r->template_id, &e) != ST_OK) {
        request_fail(r, &e);
        return;
    }
    r->response.http = 204;
    r->response.minimal = r->minimal;
}
