#include "stream.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "errmap.h"
#include "event.h"
#include "logger.h"
#include "mem.h"
#include "place.h"
#include "request.h"
#include "utc.h"

#define LINE_MAX (2 * PLACE_MAX + 1024) /* bytes of an event */

/* ---- the buffer of a stream */

size_t stream_held(const struct events_stream *s)
{
    return s->len - s->from;
}

static bool put(struct events_stream *s, const char *text, size_t n)
{
    if (stream_held(s) + n > STREAM_BUFFER ||
        (s->buf == NULL && (s->buf = mem_array(STREAM_BUFFER, 1)) == NULL))
        return false;
    if (s->len + n > STREAM_BUFFER) {
        memmove(s->buf, s->buf + s->from, stream_held(s));
        s->len -= s->from;
        s->from = 0;
    }
    memcpy(s->buf + s->len, text, n);
    s->len += n;
    s->wrote_ms = logger_clock_ms();
    return true;
}

static void resume(struct events_stream *s)
{
    if (!s->suspended)
        return;
    s->suspended = false;
    s->to.resume(s->to.conn);
}

void stream_end(struct events_stream *s)
{
    s->ended = true;
    resume(s);
}

/* An event at the stream's place.  text: of event_text().  False: there is no room. */
static bool put_event(struct events_stream *s, const char *type, const char *text)
{
    char cursor[PLACE_MAX], line[LINE_MAX];
    int n;

    place_print(&s->place, cursor);
    if (s->r != NULL)
        n = snprintf(line, sizeof line, "%s{\"cursor\":\"%s\",%s", s->n > 0 ? "," : "",
                     cursor, text + 1);
    else
        n = snprintf(line, sizeof line,
                     "id: %s\nevent: %s\ndata: {\"cursor\":\"%s\",%s\n\n", cursor, type,
                     cursor, text + 1);
    if (n < 0 || (size_t)n >= sizeof line || (s->r != NULL && s->n == s->limit) ||
        !put(s, line, (size_t)n))
        return false;
    s->n++;
    ++*s->sent;
    resume(s);
    return true;
}

/* An id without data: a client that was sent nothing else goes on from there. */
void stream_put_place(struct events_stream *s, const char *comment)
{
    char cursor[PLACE_MAX], line[PLACE_MAX + 32];
    int n;

    place_print(&s->place, cursor);
    n = snprintf(line, sizeof line, "%sid: %s\n\n", comment, cursor);
    if (s->r == NULL && put(s, line, (size_t)n))
        resume(s);
}

/* ---- entries for streams */

static uint64_t *stream_place_of(struct store_audit_place *p,
                                 const struct log_entry *entry, uint32_t **mark)
{
    if (entry->log == LOG_CHANGES) {
        *mark = &p->change_mark;
        return &p->changes;
    }
    if (p->daemons <= entry->daemon)
        p->daemons = entry->daemon + 1;
    *mark = &p->access_mark[entry->daemon];
    return &p->accesses[entry->daemon];
}

static bool give_gap(struct events_stream *s, const struct log_entry *entry,
                     uint64_t *seq, uint32_t *mark)
{
    const uint64_t was = *seq;
    const uint32_t was_mark = *mark;
    char *text = event_gap(entry->at);
    bool ok;

    *seq = entry->seq - 1;
    *mark = 0;
    ok = text != NULL && put_event(s, "gap", text);
    free(text);
    if (!ok) {
        *seq = was;
        *mark = was_mark;
    }
    return ok;
}

/* text: of the event; NULL: the entry is none.  False: there was no room, and s is where it was. */
bool stream_give(struct events_stream *s, const struct store_audit_entry *a,
                 const char *text)
{
    const struct log_entry *entry = &a->entry;
    uint32_t *mark, was_mark;
    uint64_t *seq = stream_place_of(&s->place, entry, &mark), was;

    if (entry->seq <= *seq)
        return true;
    if (entry->seq > *seq + 1 && !give_gap(s, entry, seq, mark))
        return false;
    was = *seq;
    was_mark = *mark;
    *seq = entry->seq;
    *mark = store_audit_mark(entry);
    if (text == NULL || !event_visible(a, s->token, s->groups) ||
        put_event(s, event_type(entry), text))
        return true;
    *seq = was;
    *mark = was_mark;
    return false;
}

/* ---- the place and the token */

bool stream_covers(const struct store_audit_place *a, const struct store_audit_place *b)
{
    for (uint32_t i = 0; i < b->daemons; i++)
        if (a->accesses[i] < b->accesses[i])
            return false;
    return a->changes >= b->changes;
}

/* Moves p on to q: p has all that lies between. */
void stream_pass(struct store_audit_place *p, const struct store_audit_place *q)
{
    if (p->changes < q->changes) {
        p->changes = q->changes;
        p->change_mark = q->change_mark;
    }
    if (p->daemons < q->daemons)
        p->daemons = q->daemons;
    for (uint32_t i = 0; i < q->daemons; i++)
        if (p->accesses[i] < q->accesses[i]) {
            p->accesses[i] = q->accesses[i];
            p->access_mark[i] = q->access_mark[i];
        }
}

static void shorten(struct events_stream *s, const char *until)
{
    int64_t ms;

    if (!utc_read(until, &ms))
        s->until_ms = 0;
    else if (ms < s->until_ms)
        s->until_ms = ms;
}

/* A rotation leaves the secret of s valid for a while, a second one does not. */
void stream_judge(struct events_stream *s, const struct store_token *t)
{
    if (t->revoked[0] != '\0' || t->revision > s->revision + 1)
        s->until_ms = 0;
    else if (t->revision != s->revision)
        shorten(s, t->old_until);
}

/* ---- the response */

void stream_respond(struct events_stream *s, bool valid, bool failed)
{
    const size_t len = stream_held(s), room = len + PLACE_MAX + 64;
    char cursor[PLACE_MAX], *text;

    if (!valid) {
        request_problem(s->r, ERRMAP_NO_TOKEN, "the token is not valid any more");
        s->r->response.bad_token = true;
    } else if (failed) {
        request_problem(s->r, ST_EBUSY, "the log cannot be read");
    } else {
        place_print(&s->place, cursor);
        if ((text = malloc(room)) != NULL)
            (void)snprintf(text, room, "{\"events\":[%.*s],\"next_cursor\":\"%s\"}",
                           (int)len, len > 0 ? s->buf + s->from : "", cursor);
        request_respond(s->r, 200, text);
    }
}

/* Takes what there is, or suspends the connection. */
ssize_t stream_take(struct events_stream *s, char *to, size_t max)
{
    const size_t n = stream_held(s) < max ? stream_held(s) : max;

    if (n > 0) {
        memcpy(to, s->buf + s->from, n);
        s->from += n;
    } else if (s->gone || s->ended) {
        return s->gone ? STREAM_GONE : STREAM_END;
    } else {
        s->to.suspend(s->to.conn);
        s->suspended = true;
    }
    if (stream_held(s) == 0) {
        mem_free(s->buf);
        s->buf = NULL;
        s->from = s->len = 0;
    }
    return (ssize_t)n;
}

/* ---- begin and end */

struct events_stream *stream_new(struct events *ev, const struct request *r,
                                 const struct store_audit_place *place)
{
    struct events_stream *s = calloc(1, sizeof *s);

    if (s == NULL)
        return NULL;
    s->of = ev;
    s->place = *place;
    s->unchecked = true;
    s->until_ms = INT64_MAX;
    if (r->token_expires[0] != '\0')
        shorten(s, r->token_expires);
    s->wrote_ms = logger_clock_ms();
    memcpy(s->token, r->actor, sizeof s->token);
    memcpy(s->groups, r->groups, sizeof s->groups);
    s->revision = r->token_revision;
    return s;
}

void stream_free(struct events_stream *s)
{
    mem_free(s->buf);
    free(s);
}
