/* Subjects, as store.h tells. */
#include <string.h>

#include "errinfo.h"
#include "store_engine.h"
#include "store_rules.h"

#define SEEN_MS 60000 /* that a subject was seen is noted no more often */

static enum status need_note(const char *text, struct errinfo *e)
{
    if (text == NULL || store_rules_text(text, STORE_NOTE_MAX))
        return ST_OK;
    return errinfo_set(e, ST_EINVAL,
                       "a reference or a purpose is up to %d bytes of UTF-8 without "
                       "control characters",
                       STORE_NOTE_MAX);
}

/* An end as it is kept; NULL: nothing is said of it. */
static enum status read_end(const char *text, char out[STORE_RULES_TIME],
                            struct errinfo *e)
{
    int64_t ms;

    out[0] = '\0';
    if (text == NULL || text[0] == '\0')
        return ST_OK;
    if (!store_time_read(text, &ms))
        return errinfo_set(
            e, ST_EINVAL,
            "the end is not a time like 2027-01-31T14:30:00Z, from 1970 on");
    store_rules_time(ms, out);
    return ST_OK;
}

enum status store_subject_add(struct store *s, const char *actor,
                              struct store_subject *about, struct errinfo *e)
{
    char end[STORE_RULES_TIME];
    struct store_act by;
    enum status st;

    if ((st = store_rules_subject(about->id, e)) != ST_OK ||
        (st = need_note(about->reference, e)) != ST_OK ||
        (st = need_note(about->purpose, e)) != ST_OK ||
        (st = read_end(about->expires, end, e)) != ST_OK ||
        (st = store_rules_act(&by, actor, e)) != ST_OK)
        return st;
    memcpy(about->expires, end, sizeof about->expires);
    memcpy(about->created, by.at, sizeof about->created);
    memset(about->uid, 0, sizeof about->uid); /* a new one */
    return s->engine->subject_add(s, &by, about, e);
}

enum status store_subject_get(struct store *s, const char *subject,
                              struct store_subject *out, struct errinfo *e)
{
    char now[STORE_RULES_TIME];
    int64_t ms;
    enum status st;

    if ((st = store_rules_subject(subject, e)) != ST_OK ||
        (st = store_rules_now(&ms, e)) != ST_OK ||
        (st = s->engine->subject_get(s, subject, out, e)) != ST_OK)
        return st;
    store_rules_time(ms, now);
    out->expired = out->expires[0] != '\0' && strcmp(out->expires, now) <= 0;
    return ST_OK;
}

enum status store_subject_list(struct store *s, int64_t after, size_t limit,
                               struct store_subject **out, size_t *n, struct errinfo *e)
{
    *out = NULL;
    *n = 0;
    return s->engine->subject_list(s, after, limit, out, n, e);
}

/* ---- changes */

static enum status edit(struct store *s, const char *actor, const char *subject,
                        const struct store_edit *what, struct errinfo *e)
{
    struct store_act by;
    enum status st;

    if ((st = store_rules_subject(subject, e)) != ST_OK ||
        (st = store_rules_act(&by, actor, e)) != ST_OK)
        return st;
    return s->engine->subject_edit(s, &by, subject, what, e);
}

static void add_event(struct store_edit *what, const char *kind, const char *outcome)
{
    what->event[what->events].kind = kind;
    what->event[what->events++].outcome = outcome;
}

enum status store_subject_set(struct store *s, const char *actor, const char *subject,
                              const struct store_subject_change *what, struct errinfo *e)
{
    struct store_edit to = {.reference = what->reference,
                            .purpose = what->purpose,
                            .hold = what->hold,
                            .disabled = what->disabled};
    struct store_subject as_it_is;
    char end[STORE_RULES_TIME];
    enum status st;

    if ((st = need_note(what->reference, e)) != ST_OK ||
        (st = need_note(what->purpose, e)) != ST_OK ||
        (st = read_end(what->expires, end, e)) != ST_OK)
        return st;
    if (what->expires != NULL)
        to.expires = end;
    if (what->reference != NULL || what->purpose != NULL || what->expires != NULL)
        add_event(&to, "set_subject", "set");
    if (what->hold != NULL)
        add_event(&to, *what->hold ? "hold_subject" : "release_subject",
                  *what->hold ? "held" : "released");
    if (what->disabled != NULL)
        add_event(&to, *what->disabled ? "disable_subject" : "enable_subject",
                  *what->disabled ? "disabled" : "enabled");
    if (to.events == 0)
        return store_subject_get(s, subject, &as_it_is, e);
    return edit(s, actor, subject, &to, e);
}

enum status store_subject_rename(struct store *s, const char *actor, const char *subject,
                                 const char *to, struct errinfo *e)
{
    struct store_edit what = {.id = to};
    const enum status st = store_rules_subject(to, e);

    add_event(&what, "rename_subject", "renamed");
    return st != ST_OK ? st : edit(s, actor, subject, &what, e);
}

/* Nobody is kept waiting for this to be noted: where it cannot be, the next time does. */
void store_subject_seen(struct store *s, const struct store_subject *one)
{
    char now[STORE_RULES_TIME], before[STORE_RULES_TIME];
    int64_t ms;

    if (store_rules_now(&ms, NULL) != ST_OK)
        return;
    store_rules_time(ms, now);
    store_rules_time(ms > SEEN_MS ? ms - SEEN_MS : 0, before);
    /* A time in the future is from before the clock was set back. */
    if (one->seen[0] == '\0' || strcmp(one->seen, before) <= 0 ||
        strcmp(one->seen, now) > 0)
        (void)s->engine->subject_seen(s, one->id, now, NULL);
}

/* ---- erasing */

enum status store_subject_due(struct store *s, struct store_subject **out, size_t *n,
                              struct errinfo *e)
{
    char now[STORE_RULES_TIME];
    int64_t ms;
    enum status st = store_rules_now(&ms, e);

    *out = NULL;
    *n = 0;
    if (st != ST_OK)
        return st;
    store_rules_time(ms, now);
    return s->engine->subject_due(s, now, out, n, e);
}

static enum status erase(struct store *s, const char *actor, const char *subject,
                         bool due, struct store_receipt *out, struct errinfo *e)
{
    struct store_act by;
    enum status st;

    memset(out, 0, sizeof *out);
    if ((st = store_rules_subject(subject, e)) != ST_OK ||
        (st = store_rules_act(&by, actor, e)) != ST_OK)
        return st;
    return s->engine->subject_delete(s, &by, subject, due, out, e);
}

enum status store_subject_erase(struct store *s, const char *actor, const char *subject,
                                struct store_receipt *out, struct errinfo *e)
{
    return erase(s, actor, subject, false, out, e);
}

enum status store_subject_purge(struct store *s, const char *actor, const char *subject,
                                struct errinfo *e)
{
    struct store_receipt r;
    const enum status st = erase(s, actor, subject, true, &r, e);

    store_receipt_free(&r);
    return st;
}

enum status store_subject_delete(struct store *s, const char *actor, const char *subject,
                                 uint32_t *removed, struct errinfo *e)
{
    struct store_receipt r;
    const enum status st = store_subject_erase(s, actor, subject, &r, e);

    if (removed != NULL)
        *removed = st == ST_OK ? r.templates : 0;
    store_receipt_free(&r);
    return st;
}
