#include "subjects.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app.h"
#include "auth.h"
#include "cache.h"
#include "errinfo.h"
#include "errmap.h"
#include "intake.h"
#include "parse.h"
#include "render.h"
#include "params.h"
#include "request.h"

#define PAGE_DEFAULT 100
#define PAGE_MAX     1000

#define SUBJECTS_CURSOR 24 /* digits of a key */

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
    char cursor[SUBJECTS_CURSOR];
    struct store_subject *s = NULL;
    struct errinfo e = {0};
    size_t n = 0, limit = PAGE_DEFAULT;
    int64_t after = 0;
    enum status st = request_query(r, "cursor", cursor, sizeof cursor);

    (void)w;
    if (st == ST_OK)
        st = read_cursor(cursor, &after);
    if (st != ST_OK && st != ST_ENOTFOUND) {
        request_problem(r, ERRMAP_PARAMETER, "cursor is not the next_cursor of a page");
        return;
    }
    if (!params_count(r, "limit", PAGE_MAX, &limit))
        return;
    /* One more than asked for tells whether another page follows. */
    if (store_subject_list(r->app->store, after, limit + 1, &s, &n, &e) != ST_OK)
        request_fail(r, &e);
    else
        request_respond(r, 200, render_subjects(s, n > limit ? limit : n, n > limit));
    free(s);
}

/* 200 with the subject as it is now; respond: request_respond() or request_written(). */
static void show(struct request *r, void (*respond)(struct request *, int, char *))
{
    struct store_subject s;
    struct store_template *t = NULL;
    struct errinfo e = {0};
    size_t n = 0;

    if (store_subject_get(r->app->store, r->subject, &s, &e) != ST_OK ||
        store_template_list(r->app->store, r->subject, &t, &n, &e) != ST_OK)
        request_fail(r, &e);
    else
        respond(r, 200, render_subject(&s, t, n, auth_exact(r)));
    free(t);
}

void subjects_show(struct request *r, struct worker *w)
{
    (void)w;
    show(r, request_respond);
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
    if (!intake_admit(r, 1))
        return;
    if (store_subject_add(r->app->store, r->actor, &s, &e) != ST_OK) {
        intake_give(r->app->intake, r->actor, 1);
        request_fail(r, &e);
        return;
    }
    request_written(r, 201, render_subject(&s, NULL, 0, false));
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
        show(r, request_written);
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
    for (uint32_t i = 0; i < receipt.templates; i++)
        cache_forget(r->app->cache, receipt.template_id[i]);
    request_written(r, 200, render_erased(&receipt));
out:
    store_receipt_free(&receipt);
}

void subjects_template(struct request *r, struct worker *w)
{
    struct store_template t;
    struct errinfo e = {0};

    (void)w;
    if (store_template_get(r->app->store, r->template_id, &t, &e) != ST_OK)
        request_fail(r, &e);
    else
        request_respond(r, 200, render_template(&t, auth_exact(r)));
}

void subjects_template_delete(struct request *r, struct worker *w)
{
    struct errinfo e = {0};

    (void)w;
    if (store_template_delete(r->app->store, r->actor, r->template_id, &e) != ST_OK) {
        request_fail(r, &e);
        return;
    }
    cache_forget(r->app->cache, r->template_id);
    r->response.http = 204;
    r->response.minimal = r->minimal;
}
