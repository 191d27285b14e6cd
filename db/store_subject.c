#define _GNU_SOURCE /* strcasestr */
#include "store.h"

#include <math.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "rows_subject.h"
#include "rows_template.h"
#include "store_txn.h"
#include "utf8.h"

static enum status need_note(const char *text, struct errinfo *e)
{
    if (text == NULL || utf8_is_text(text, STORE_NOTE_MAX))
        return ST_OK;
    return errinfo_set(e, ST_EINVAL,
                       "a consent or a purpose is up to %d bytes of UTF-8 without "
                       "control characters, also those that are not seen or change the "
                       "order of others",
                       STORE_NOTE_MAX);
}

/* An end as it is stored; NULL: it does not change. */
static enum status read_end(const char *text, char out[UTC_TEXT], struct errinfo *e)
{
    int64_t ms, now;
    enum status st;

    out[0] = '\0';
    if (text == NULL || text[0] == '\0')
        return ST_OK;
    if (!utc_read_end(text, &ms))
        return errinfo_set(e, ST_EINVAL,
                           "expires_at must be a time such as 2027-01-31T14:30:00Z, or a "
                           "day, 2027-01-31, at whose end (UTC) it expires");
    if ((st = store_rules_now(&now, e)) != ST_OK)
        return st;
    if (ms <= now)
        return errinfo_set(e, ST_EINVAL,
                           "expires_at %.40s is in the past; to stop verifying a subject "
                           "now, disable it",
                           text);
    utc_print(ms, out);
    return ST_OK;
}

/* ---- reading */

enum status store_subject_get(struct store *s, const char *actor, const char *subject,
                              struct store_subject *out, struct errinfo *e)
{
    struct rows_subject p;
    struct log_txn t;
    enum status st;

    memset(out, 0, sizeof *out);
    if ((st = ident_subject(subject, e)) != ST_OK ||
        (st = store_act_begin(s, actor, SQL_READ, &t, e)) != ST_OK)
        return st;
    if ((st = store_end(s, &t, rows_subject_find(&t, subject, &p, e), e)) == ST_OK) {
        *out = p.one;
        store_rules_shown(&t, out);
        out->expired = store_rules_past(out->expires, t.by.ms);
    }
    sodium_memzero(&p, sizeof p);
    return st;
}

enum status store_subject_list(struct store *s, int64_t after, size_t limit,
                               struct store_subject **out, size_t *n, struct errinfo *e)
{
    struct log_txn t;
    enum status st;

    *out = NULL;
    *n = 0;
    if ((st = store_begin(s, SQL_READ, &t, e)) != ST_OK)
        return st;
    return store_end(s, &t, rows_subject_list(&t, after, limit, out, n, e), e);
}

enum status store_subject_due(struct store *s, struct store_subject **out, size_t *n,
                              struct errinfo *e)
{
    struct log_txn t;
    enum status st;

    *out = NULL;
    *n = 0;
    if ((st = store_begin(s, SQL_READ, &t, e)) != ST_OK)
        return st;
    return store_end(s, &t, rows_subject_due(&t, t.by.at, out, n, e), e);
}

/* ---- searching */

bool store_subject_state(const char *word, enum store_state *out)
{
    static const char *const name[] = {"active", "disabled", "hold",      "expired",
                                       "ending", "locked",   "no_consent"};

    for (size_t i = 0; i < sizeof name / sizeof *name; i++)
        if (strcmp(word, name[i]) == 0) {
            *out = (enum store_state)((size_t)STORE_ACTIVE + i);
            return true;
        }
    return false;
}

#define BATCH 500 /* rows in memory at a time */

struct store_subject_searching {
    const struct store_search *what;
    struct log_txn t;
    int64_t now;
    char soon[UTC_TEXT]; /* what expires by then is STORE_ENDING */
    struct store_subject *out;
    size_t n, looked;
    int64_t next, last; /* keys of the last row read, and of the page's end */
    bool done;
};

static bool is_wanted(const struct store_subject_searching *x, struct store_subject *one)
{
    if (!groups_meet(x->t.groups, one->groups))
        return false;
    one->expired = store_rules_past(one->expires, x->now);
    store_rules_shown(&x->t, one);
    if (x->what->group[0] != '\0' && !groups_meet(x->what->group, one->groups))
        return false;
    if (x->what->part[0] != '\0' && strcasestr(one->id, x->what->part) == NULL)
        return false;
    switch (x->what->state) {
    case STORE_ANY:
    case STORE_LOCKED: /* is_locked() */
        break;
    case STORE_NO_CONSENT:
        return one->reference[0] == '\0';
    case STORE_ACTIVE:
        return !one->disabled && !one->expired;
    case STORE_DISABLED:
        return one->disabled;
    case STORE_HELD:
        return one->hold;
    case STORE_EXPIRED:
        return one->expired;
    case STORE_ENDING:
        return one->expires[0] != '\0' && !one->expired &&
               strcmp(one->expires, x->soon) <= 0;
    }
    return true;
}

/* Whether a token is locked out of it, for what is wanted otherwise. */
static enum status find_lock(struct store_subject_searching *x, struct store_subject *one,
                             bool *wanted, struct errinfo *e)
{
    struct store_worst worst = {.failures = 0};
    enum status st = ST_OK;

    if (*wanted && x->what->limits != NULL)
        st = store_attempts_longest(&x->t, one, x->what->limits, x->now, &worst, e);
    memcpy(one->locked, worst.until, sizeof one->locked);
    if (x->what->state == STORE_LOCKED)
        *wanted = worst.until[0] != '\0';
    return st;
}

/* Those of a batch; one more than wanted tells that there are more.  The page ends with the last one that is
 * wanted: what lies behind may be no subject of the actor's. */
static enum status store_subject_choose(struct store_subject_searching *x,
                                        struct store_subject *list, size_t n,
                                        struct errinfo *e)
{
    enum status st = ST_OK;

    for (size_t i = 0; i < n && !x->done && st == ST_OK; i++) {
        bool wanted = is_wanted(x, &list[i]);

        if ((x->done = x->looked == STORE_SEARCH_ROWS)) {
            x->last = x->next;
            return ST_OK;
        }
        x->looked++;
        st = find_lock(x, &list[i], &wanted, e);
        if (wanted && !(x->done = x->n == x->what->limit)) {
            x->out[x->n++] = list[i];
            x->last = list[i].key;
        }
        x->next = list[i].key;
    }
    return st;
}

static enum status store_subject_look(struct store_subject_searching *x,
                                      struct errinfo *e)
{
    enum status st = ST_OK;

    while (st == ST_OK && !x->done) {
        struct store_subject *list = NULL;
        size_t n = 0;

        if ((st = rows_subject_list(&x->t, x->next, BATCH, &list, &n, e)) != ST_OK)
            return st;
        st = store_subject_choose(x, list, n, e);
        if (!x->done && n < BATCH) {
            x->last = 0;
            x->done = true;
        }
        free(list);
    }
    return st;
}

/* A damaged template counts as none: an operator who looks for the damage must see the subject. */
static enum status store_subject_rate(struct log_txn *t, struct store_subject *one,
                                      struct errinfo *e)
{
    struct rows_template *row = NULL;
    struct rows_subject of;
    size_t n = 0;
    enum status st = rows_subject_get(t, one->uid, &of, e);

    one->quality = (double)NAN;
    if (st == ST_OK)
        st = rows_template_list(t, &of, &row, &n, e);
    sodium_memzero(&of, sizeof of);
    for (size_t i = 0; st == ST_OK && i < n; i++)
        one->quality = fmax(one->quality, row[i].one.quality.score);
    free(row);
    return st == ST_ECORRUPT ? ST_OK : st;
}

enum status store_subject_search(struct store *s, const char *actor,
                                 const struct store_search *what,
                                 struct store_subject **out, size_t *n, int64_t *next,
                                 struct errinfo *e)
{
    struct store_subject_searching x = {.what = what, .next = what->after};
    enum status st;

    *out = NULL;
    *n = 0;
    if ((x.out = calloc(what->limit, sizeof *x.out)) == NULL)
        return errinfo_memory(e);
    if ((st = store_act_begin(s, actor, SQL_READ, &x.t, e)) == ST_OK) {
        x.now = x.t.by.ms;
        utc_print(x.now + STORE_ENDING_MS, x.soon);
        st = store_subject_look(&x, e);
        for (size_t i = 0; i < x.n && st == ST_OK; i++)
            st = store_subject_rate(&x.t, &x.out[i], e);
        st = store_end(s, &x.t, st, e);
    }
    if (st != ST_OK) {
        free(x.out);
        return st;
    }
    *out = x.out;
    *n = x.n;
    *next = x.last;
    return ST_OK;
}

/* ---- adding */

/* There must be none yet. */
static enum status add_row(struct log_txn *t, struct store_subject *about,
                           struct errinfo *e)
{
    struct rows_subject p;
    enum status st;

    if ((st = store_rules_groups(t, about->groups, e)) != ST_OK ||
        (st = rows_subject_free(t, about->id, e)) != ST_OK ||
        (st = rows_subject_add(t, about, &p, e)) != ST_OK)
        return st;
    st = log_change(t, "add_subject", p.one.uid, "", "created", e);
    if (st == ST_OK && !about->identify)
        st = log_change(t, "opt_out", p.one.uid, "", "opted out", e);
    sodium_memzero(&p, sizeof p);
    return st;
}

enum status store_subject_add(struct store *s, const char *actor,
                              struct store_subject *about, struct errinfo *e)
{
    char end[UTC_TEXT], groups[GROUPS_SIZE];
    struct log_txn t;
    enum status st;

    if ((st = ident_subject(about->id, e)) != ST_OK ||
        (st = groups_read(about->groups, groups, e)) != ST_OK ||
        (st = need_note(about->reference, e)) != ST_OK ||
        (st = need_note(about->purpose, e)) != ST_OK ||
        (st = read_end(about->expires, end, e)) != ST_OK ||
        (st = store_act_begin(s, actor, SQL_WRITE, &t, e)) != ST_OK)
        return st;
    memcpy(about->expires, end, sizeof about->expires);
    memcpy(about->groups, groups, sizeof about->groups);
    memcpy(about->created, t.by.at, sizeof about->created);
    memset(about->uid, 0, sizeof about->uid); /* a new one */
    about->templates = 0;
    return store_end(s, &t, add_row(&t, about, e), e);
}

/* ---- changes */

static void copy(char *to, size_t size, const char *from)
{
    if (from != NULL)
        (void)snprintf(to, size, "%s", from);
}

static void copy_flag(bool *to, const bool *from)
{
    if (from != NULL)
        *to = *from;
}

static enum status change(const struct log_txn *t,
                          const struct store_subject_change *what,
                          struct store_subject *one, struct errinfo *e)
{
    char groups[GROUPS_SIZE];
    enum status st;

    copy(one->reference, sizeof one->reference, what->reference);
    copy(one->purpose, sizeof one->purpose, what->purpose);
    copy(one->expires, sizeof one->expires, what->expires);
    copy_flag(&one->hold, what->hold);
    copy_flag(&one->disabled, what->disabled);
    copy_flag(&one->identify, what->identify);
    if (what->groups == NULL)
        return ST_OK;
    st = groups_replace(t->groups, one->groups, what->groups, groups, e);
    memcpy(one->groups, groups, sizeof one->groups);
    return st;
}

/* The texts of *what are as they are stored. */
static enum status set_row(struct log_txn *t, const char *subject,
                           const struct store_subject_change *what, struct errinfo *e)
{
    const bool text =
        what->reference != NULL || what->purpose != NULL || what->expires != NULL;
    const bool hold = what->hold != NULL && *what->hold;
    const bool disabled = what->disabled != NULL && *what->disabled;
    const bool in = what->identify != NULL && *what->identify;
    const struct {
        bool wanted;
        const char *kind, *outcome;
    } event[] = {
        {text, "set_subject", "set"},
        {what->hold != NULL, hold ? "hold_subject" : "release_subject",
         hold ? "held" : "released"},
        {what->disabled != NULL, disabled ? "disable_subject" : "enable_subject",
         disabled ? "disabled" : "enabled"},
        {what->groups != NULL, "set_groups", "set"},
        {what->identify != NULL, in ? "opt_in" : "opt_out",
         in ? "opted in" : "opted out"},
    };
    struct rows_subject p;
    bool wanted = false;
    enum status st;

    /* Before the subject is looked for: the answer must not depend on it. */
    if (what->groups != NULL && (st = store_rules_within(t, what->groups, e)) != ST_OK)
        return st;
    if ((st = rows_subject_find(t, subject, &p, e)) == ST_OK)
        st = change(t, what, &p.one, e);
    for (size_t i = 0; i < sizeof event / sizeof *event; i++)
        wanted = wanted || event[i].wanted;
    if (st == ST_OK && wanted)
        st = rows_subject_write(t, &p, e);
    for (size_t i = 0; st == ST_OK && i < sizeof event / sizeof *event; i++)
        if (event[i].wanted)
            st = log_change(t, event[i].kind, p.one.uid, "", event[i].outcome, e);
    sodium_memzero(&p, sizeof p);
    return st;
}

enum status store_subject_set(struct store *s, const char *actor, const char *subject,
                              const struct store_subject_change *what, struct errinfo *e)
{
    char end[UTC_TEXT], groups[GROUPS_SIZE] = "";
    struct store_subject_change to = *what;
    struct log_txn t;
    enum status st;

    to.expires = what->expires != NULL ? end : NULL;
    to.groups = what->groups != NULL ? groups : NULL;
    if ((st = need_note(what->reference, e)) != ST_OK ||
        (st = need_note(what->purpose, e)) != ST_OK ||
        (what->groups != NULL && (st = groups_read(what->groups, groups, e)) != ST_OK) ||
        (st = read_end(what->expires, end, e)) != ST_OK ||
        (st = ident_subject(subject, e)) != ST_OK ||
        (st = store_act_begin(s, actor, SQL_WRITE, &t, e)) != ST_OK)
        return st;
    return store_end(s, &t, set_row(&t, subject, &to, e), e);
}

enum status store_subject_rename(struct store *s, const char *actor, const char *subject,
                                 const char *to, struct errinfo *e)
{
    struct rows_subject p = {.revision = 0};
    struct log_txn t;
    enum status st;

    if ((st = ident_subject(to, e)) != ST_OK ||
        (st = ident_subject(subject, e)) != ST_OK ||
        (st = store_act_begin(s, actor, SQL_WRITE, &t, e)) != ST_OK)
        return st;
    if ((st = rows_subject_find(&t, subject, &p, e)) == ST_OK &&
        (st = rows_subject_free(&t, to, e)) == ST_OK) {
        copy(p.one.id, sizeof p.one.id, to);
        if ((st = rows_subject_write(&t, &p, e)) == ST_OK)
            st = log_change(&t, "rename_subject", p.one.uid, "", "renamed", e);
    }
    sodium_memzero(&p, sizeof p);
    return store_end(s, &t, st, e);
}
