/* Subjects, as store.h tells. */
#include <string.h>

#include "errinfo.h"
#include "store_engine.h"
#include "store_rules.h"

#define SEEN_MS 60000 /* that a subject was seen is noted no more often */

static bool time_valid(const char *at)
{
    return strlen(at) == 24 && at[10] == 'T' && at[19] == '.' && at[23] == 'Z';
}

static enum status need_note(const char *text, struct errinfo *e)
{
    if (text == NULL || store_rules_text(text, STORE_NOTE_MAX))
        return ST_OK;
    return errinfo_set(e, ST_EINVAL,
                       "a reference or a purpose is up to %d bytes of UTF-8 without "
                       "control characters",
                       STORE_NOTE_MAX);
}

/* What may be known of a subject; NULL: nothing is said of it. */
static enum status need_about(const char *reference, const char *purpose,
                              const char *expires, struct errinfo *e)
{
    enum status st;

    if ((st = need_note(reference, e)) != ST_OK || (st = need_note(purpose, e)) != ST_OK)
        return st;
    if (expires != NULL && expires[0] != '\0' && !time_valid(expires))
        return errinfo_set(e, ST_EINVAL, "the end is not a time");
    return ST_OK;
}

enum status store_subject_add(struct store *s, const char *actor,
                              struct store_subject *about, struct errinfo *e)
{
    struct store_act by;
    enum status st;

    if ((st = store_rules_subject(about->id, e)) != ST_OK ||
        (st = need_about(about->reference, about->purpose, about->expires, e)) != ST_OK ||
        (st = store_rules_act(&by, actor, e)) != ST_OK)
        return st;
    memcpy(about->created, by.at, sizeof about->created);
    return s->engine->subject_add(s, &by, about, e);
}

enum status store_subject_get(struct store *s, const char *subject,
                              struct store_subject *out, struct errinfo *e)
{
    enum status st = store_rules_subject(subject, e);

    return st != ST_OK ? st : s->engine->subject_get(s, subject, out, e);
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

enum status store_subject_set(struct store *s, const char *actor, const char *subject,
                              const char *reference, const char *purpose,
                              const char *expires, struct errinfo *e)
{
    const struct store_edit what = {.event = "set_subject",
                                    .outcome = "set",
                                    .reference = reference,
                                    .purpose = purpose,
                                    .expires = expires};
    const enum status st = need_about(reference, purpose, expires, e);

    return st != ST_OK ? st : edit(s, actor, subject, &what, e);
}

enum status store_subject_rename(struct store *s, const char *actor, const char *subject,
                                 const char *to, struct errinfo *e)
{
    const struct store_edit what = {
        .event = "rename_subject", .outcome = "renamed", .id = to};
    const enum status st = store_rules_subject(to, e);

    return st != ST_OK ? st : edit(s, actor, subject, &what, e);
}

enum status store_subject_hold(struct store *s, const char *actor, const char *subject,
                               bool hold, struct errinfo *e)
{
    const struct store_edit what = {.event = hold ? "hold_subject" : "release_subject",
                                    .outcome = hold ? "held" : "released",
                                    .hold = &hold};

    return edit(s, actor, subject, &what, e);
}

enum status store_subject_disable(struct store *s, const char *actor, const char *subject,
                                  bool disabled, struct errinfo *e)
{
    const struct store_edit what = {.event =
                                        disabled ? "disable_subject" : "enable_subject",
                                    .outcome = disabled ? "disabled" : "enabled",
                                    .disabled = &disabled};

    return edit(s, actor, subject, &what, e);
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
