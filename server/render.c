#include "render.h"

#include <stdio.h>

#include "describe.h"
#include "errmap.h"
#include "json.h"

char *render_comparison(const struct describe_comparison *c)
{
    struct json *j = json_new();

    describe_comparison(j, c);
    return json_compact(j);
}

char *render_asymmetry(const struct asymmetry *a, const struct face *f,
                       const struct scan_found *scan, const char *engine,
                       const struct describe_times *times)
{
    struct json *j = json_new();

    describe_scan(j, "scan", scan);
    describe_asymmetry(j, a, f, engine, times);
    return json_compact(j);
}

char *render_trial(const struct trial *t, const struct face *f,
                   const struct describe_times *times)
{
    struct json *j = json_new();

    describe_trial(j, t, f, times);
    return json_compact(j);
}

struct json *render_problem_begin(const struct errmap *m, const char *detail,
                                  const char *request_id)
{
    struct json *j = json_new();
    char type[96];

    (void)snprintf(type, sizeof type, "urn:surfaced:problem:%s", m->code);
    json_text(j, "type", type);
    json_text(j, "title", m->title);
    json_number(j, "status", m->http);
    json_text(j, "detail", detail);
    json_text(j, "code", m->code);
    json_text(j, "request_id", request_id);
    return j;
}

char *render_problem(const struct errmap *m, const char *detail, const char *request_id)
{
    return json_compact(render_problem_begin(m, detail, request_id));
}

char *render_enrolled(const struct store_template *t, const struct frame *frame,
                      const struct scan_found *scan, bool how)
{
    struct json *j = json_new();

    describe_template(j, t, frame, how);
    describe_scan(j, "scan", scan);
    return json_compact(j);
}

char *render_template(const struct store_template *t, bool how)
{
    struct json *j = json_new();

    describe_template(j, t, NULL, how);
    return json_compact(j);
}

char *render_subject(const struct store_subject *s, const struct store_template *t,
                     size_t n, bool how)
{
    struct json *j = json_new();

    describe_subject(j, s);
    json_array(j, "templates");
    for (size_t i = 0; i < n; i++) {
        json_object(j, NULL);
        describe_template(j, &t[i], NULL, how);
        json_close(j);
    }
    return json_compact(j);
}

char *render_subjects(const struct store_subject *s, size_t n, bool more)
{
    struct json *j = json_new();
    char cursor[24] = "";

    json_array(j, "subjects");
    for (size_t i = 0; i < n; i++) {
        json_object(j, NULL);
        json_text(j, "subject", s[i].id);
        json_text(j, "created", s[i].created);
        json_number(j, "templates", s[i].templates);
        json_close(j);
    }
    json_close(j);
    if (more && n > 0)
        (void)snprintf(cursor, sizeof cursor, "%lld", (long long)s[n - 1].key);
    json_text(j, "next_cursor", cursor[0] != '\0' ? cursor : NULL);
    return json_compact(j);
}

char *render_erased(const struct store_receipt *r)
{
    struct json *j = json_new();

    describe_receipt(j, r);
    return json_compact(j);
}

char *render_state(const char *state)
{
    struct json *j = json_new();

    json_text(j, "status", state);
    return json_compact(j);
}

char *render_challenge(const char *nonce, const char *expires)
{
    struct json *j = json_new();

    json_text(j, "nonce", nonce);
    json_text(j, "expires_at", expires);
    return json_compact(j);
}

char *render_version(const char *version)
{
    struct json *j = json_new();

    json_text(j, "version", version);
    return json_compact(j);
}
