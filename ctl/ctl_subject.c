/* Subjects: listed, described, changed, erased. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "store_rules.h"
#include "describe.h"
#include "ctl.h"

#define PAGE 1000 /* subjects read at a time */

/* What stands beside an id in a list. */
static const char *state_of(const struct store_subject *one)
{
    return one->hold ? (one->disabled ? "hold, disabled" : "hold")
                     : (one->disabled ? "disabled" : "");
}

int ctl_subject_list(struct ctl *c)
{
    struct store_subject *page = NULL;
    struct store *s = NULL;
    int64_t after = 0;
    size_t n = 0, total = 0;
    enum status st = ctl_open(c, STORE_READ, &s);

    if (st != ST_OK)
        return ctl_fail(c, st);
    ctl_out_array(c->out, "subjects");
    while ((st = store_subject_list(s, after, PAGE, &page, &n, &c->e)) == ST_OK &&
           n > 0) {
        if (!c->json && total == 0)
            (void)printf("%-32s %9s  %-24s  %s\n", "SUBJECT", "TEMPLATES", "CREATED",
                         "STATE");
        for (size_t i = 0; i < n; i++) {
            ctl_out_object(c->out, NULL);
            describe_subject(ctl_out_document(c->out), &page[i]);
            ctl_out_number(c->out, "templates", page[i].templates);
            ctl_out_close(c->out);
            if (!c->json)
                (void)printf("%-32s %9u  %-24s  %s\n", page[i].id, page[i].templates,
                             page[i].created, state_of(&page[i]));
        }
        total += n;
        after = page[n - 1].key;
        free(page);
    }
    ctl_out_close(c->out);
    store_close(s);
    if (st != ST_OK)
        return ctl_fail(c, st);
    if (!c->json && total == 0)
        (void)printf("no subjects\n");
    return EXIT_FINE;
}

static void print_subject(const struct store_subject *one, size_t templates)
{
    (void)printf("subject   %s, since %s, %zu template%s\n", one->id, one->created,
                 templates, templates == 1 ? "" : "s");
    if (one->reference[0] != '\0')
        (void)printf("  consent   %s\n", one->reference);
    if (one->purpose[0] != '\0')
        (void)printf("  purpose   %s\n", one->purpose);
    if (one->expires[0] != '\0')
        (void)printf("  expires   %s\n", one->expires);
    if (one->seen[0] != '\0')
        (void)printf("  seen      %s\n", one->seen);
    if (one->hold)
        (void)printf("  on hold   cannot be erased\n");
    if (one->disabled)
        (void)printf("  disabled  is not verified\n");
}

enum status ctl_subject_tell(struct ctl *c, struct store *s,
                             const struct store_subject *one)
{
    struct store_template *list;
    size_t n;
    enum status st = store_template_list(s, one->id, &list, &n, &c->e);

    if (st != ST_OK)
        return st;
    describe_subject(ctl_out_document(c->out), one);
    ctl_out_array(c->out, "templates");
    if (!c->json)
        print_subject(one, n);
    for (size_t i = 0; i < n; i++) {
        ctl_out_object(c->out, NULL);
        ctl_template_tell(c, &list[i]);
        ctl_out_close(c->out);
    }
    ctl_out_close(c->out);
    free(list);
    return ST_OK;
}

int ctl_subject_show(struct ctl *c)
{
    struct store_subject one;
    struct store *s = NULL;
    enum status st = ctl_open(c, STORE_READ, &s);

    if (st == ST_OK && (st = store_subject_get(s, c->args[0], &one, &c->e)) == ST_OK)
        st = ctl_subject_tell(c, s, &one);
    store_close(s);
    return st == ST_OK ? EXIT_FINE : ctl_fail(c, st);
}

/* ---- changes */

/* Tell what the subject is now, in words too. */
static enum status tell(struct ctl *c, struct store *s, const char *id, const char *done)
{
    struct store_subject one;
    enum status st = store_subject_get(s, id, &one, &c->e);

    if (st != ST_OK)
        return st;
    describe_subject(ctl_out_document(c->out), &one);
    if (!c->json)
        (void)printf("%s: %s\n", one.id, done);
    return ST_OK;
}

/* The text of --expires: NULL where it is not given. */
static const char *expiry(const struct ctl *c, char text[STORE_RULES_TIME])
{
    if (!c->expires.given)
        return NULL;
    text[0] = '\0';
    if (c->expires.at_s > 0)
        store_rules_time(c->expires.at_s * 1000, text);
    return text;
}

static enum status set(struct ctl *c, struct store *s)
{
    struct store_subject new = {0};
    char text[STORE_RULES_TIME];
    const char *id = c->args[0], *expires = expiry(c, text);
    const struct store_subject_change what = {
        .reference = c->reference, .purpose = c->purpose, .expires = expires};
    enum status st = store_subject_set(s, CTL_ACTOR, id, &what, &c->e);

    if (st != ST_ENOTFOUND)
        return st;
    (void)snprintf(new.id, sizeof new.id, "%s", id);
    if ((c->reference != NULL && strlen(c->reference) >= sizeof new.reference) ||
        (c->purpose != NULL && strlen(c->purpose) >= sizeof new.purpose))
        return errinfo_set(&c->e, ST_EINVAL, "a reference or a purpose is up to %d bytes",
                           STORE_NOTE_MAX);
    (void)snprintf(new.reference, sizeof new.reference, "%s",
                   c->reference != NULL ? c->reference : "");
    (void)snprintf(new.purpose, sizeof new.purpose, "%s",
                   c->purpose != NULL ? c->purpose : "");
    (void)snprintf(new.expires, sizeof new.expires, "%s", expires != NULL ? expires : "");
    return store_subject_add(s, CTL_ACTOR, &new, &c->e);
}

static enum status rename_it(struct ctl *c, struct store *s)
{
    return store_subject_rename(s, CTL_ACTOR, c->args[0], c->args[1], &c->e);
}

static enum status set_disabled(struct ctl *c, struct store *s, bool disabled)
{
    return store_subject_set(s, CTL_ACTOR, c->args[0],
                             &(struct store_subject_change){.disabled = &disabled},
                             &c->e);
}

static enum status disable(struct ctl *c, struct store *s)
{
    return set_disabled(c, s, true);
}

static enum status enable(struct ctl *c, struct store *s)
{
    return set_disabled(c, s, false);
}

static enum status set_hold(struct ctl *c, struct store *s, bool held)
{
    return store_subject_set(s, CTL_ACTOR, c->args[0],
                             &(struct store_subject_change){.hold = &held}, &c->e);
}

static enum status hold(struct ctl *c, struct store *s)
{
    return set_hold(c, s, true);
}

static enum status release(struct ctl *c, struct store *s)
{
    return set_hold(c, s, false);
}

/* Make a change of the subject that the last argument names when it is made. */
static int change(struct ctl *c, enum status (*make)(struct ctl *, struct store *),
                  const char *done)
{
    struct store *s = NULL;
    enum status st = ctl_open(c, STORE_WRITE, &s);

    if (st == ST_OK && (st = make(c, s)) == ST_OK)
        st = tell(c, s, c->args[c->nargs - 1], done);
    store_close(s);
    return st == ST_OK ? EXIT_FINE : ctl_fail(c, st);
}

int ctl_subject_set(struct ctl *c)
{
    if (c->reference == NULL && c->purpose == NULL && !c->expires.given)
        return ctl_usage(c, "subject set needs --reference, --purpose or --expires");
    return change(c, set, "noted");
}

int ctl_subject_rename(struct ctl *c)
{
    return change(c, rename_it, "is its id now");
}

int ctl_subject_disable(struct ctl *c)
{
    return change(c, disable, "disabled");
}

int ctl_subject_enable(struct ctl *c)
{
    return change(c, enable, "enabled");
}

int ctl_subject_hold(struct ctl *c)
{
    return change(c, hold, "on hold");
}

int ctl_subject_release(struct ctl *c)
{
    return change(c, release, "not on hold");
}

/* ---- erasing */

static void out_receipt(struct ctl_out *o, const struct store_receipt *r)
{
    ctl_out_text(o, "subject", r->subject);
    ctl_out_number(o, "templates_deleted", r->templates);
    ctl_out_array(o, "template_ids");
    for (uint32_t i = 0; i < r->templates; i++)
        ctl_out_text(o, NULL, r->template_id[i]);
    ctl_out_close(o);
    ctl_out_text(o, "erased_at", r->at);
    ctl_out_text(o, "digest", r->digest);
    ctl_out_object(o, "audit");
    ctl_out_number(o, "seq", (double)r->seq);
    ctl_out_text(o, "hash", r->hash);
    ctl_out_close(o);
    ctl_out_text(o, "signature", r->signature);
    ctl_out_text(o, "public_key", r->public_key);
}

int ctl_subject_would(struct ctl *c, const struct store_subject *one, uint32_t templates,
                      const char *what)
{
    if (one->hold)
        return ctl_fail(c,
                        errinfo_set(&c->e, ST_EHELD, "subject %s is on hold", one->id));
    ctl_out_text(c->out, "subject", one->id);
    ctl_out_number(c->out, "templates", templates);
    ctl_out_flag(c->out, "deleted", false);
    if (!c->json)
        (void)printf("this %s; nothing was changed\n", what);
    return EXIT_FINE;
}

int ctl_subject_remove(struct ctl *c, struct store *s, const struct store_subject *one)
{
    char what[256];
    struct store_receipt r;
    enum status st;

    (void)snprintf(what, sizeof what, "deletes subject %s with %u template%s", one->id,
                   one->templates, one->templates == 1 ? "" : "s");
    if (c->dry_run)
        return ctl_subject_would(c, one, one->templates, what);
    if (!ctl_confirmed(c, what, one->id))
        return EXIT_USAGE;
    st = store_subject_erase(s, CTL_ACTOR, one->id, &r, &c->e);
    if (st == ST_OK) {
        out_receipt(c->out, &r);
        if (!c->json)
            (void)printf("deleted subject %s with %u template%s, at %s\n"
                         "  receipt   %s\n"
                         "  audit     entry %llu\n",
                         one->id, r.templates, r.templates == 1 ? "" : "s", r.at,
                         r.digest, (unsigned long long)r.seq);
    }
    store_receipt_free(&r);
    return st == ST_OK ? EXIT_FINE : ctl_fail(c, st);
}

int ctl_subject_erase(struct ctl *c)
{
    struct store_subject one;
    struct store *s = NULL;
    enum status st = ctl_open(c, c->dry_run ? STORE_READ : STORE_WRITE, &s);
    int code;

    if (st == ST_OK)
        st = store_subject_get(s, c->args[0], &one, &c->e);
    code = st == ST_OK ? ctl_subject_remove(c, s, &one) : ctl_fail(c, st);
    store_close(s);
    return code;
}

/* Those that can be erased, or are kept: in the JSON, and as text. */
static void tell_due(struct ctl *c, const char *key, bool hold,
                     const struct store_subject *due, size_t n)
{
    ctl_out_array(c->out, key);
    for (size_t i = 0; i < n; i++) {
        if (due[i].hold != hold)
            continue;
        ctl_out_text(c->out, NULL, due[i].id);
        if (!c->json)
            (void)printf("%-32s %9u  %.16s  %s\n", due[i].id, due[i].templates,
                         due[i].expires, hold ? "on hold: kept" : "");
    }
    ctl_out_close(c->out);
}

static enum status erase_due(struct ctl *c, struct store *s,
                             const struct store_subject *due, size_t n, size_t *erased)
{
    for (size_t i = 0; i < n; i++) {
        enum status st;

        if (due[i].hold)
            continue;
        st = store_subject_purge(s, CTL_ACTOR, due[i].id, &c->e);
        if (st == ST_OK)
            ++*erased;
        else if (st != ST_ENOTFOUND && st != ST_EHELD)
            return st; /* those: changed since they were listed */
    }
    return ST_OK;
}

static int purge(struct ctl *c, struct store *s, const struct store_subject *due,
                 size_t n)
{
    char what[64], count[32];
    size_t most = 0, erased = 0;
    enum status st;

    for (size_t i = 0; i < n; i++)
        most += !due[i].hold;
    if (!c->json && n > 0)
        (void)printf("%-32s %9s  %-16s\n", "SUBJECT", "TEMPLATES", "EXPIRED");
    tell_due(c, "due", false, due, n);
    tell_due(c, "kept", true, due, n);
    (void)snprintf(what, sizeof what, "erases %zu subject%s", most, most == 1 ? "" : "s");
    (void)snprintf(count, sizeof count, "%zu", most);
    if (!c->dry_run && most > 0) {
        if (!ctl_confirmed(c, what, count))
            return EXIT_USAGE;
        st = erase_due(c, s, due, n, &erased);
        if (st != ST_OK)
            return ctl_fail(c, st);
    }
    ctl_out_number(c->out, "erased", (double)erased);
    if (!c->json)
        (void)printf("%zu due, %zu on hold, %zu erased\n", most, n - most, erased);
    return EXIT_FINE;
}

int ctl_purge(struct ctl *c)
{
    struct store_subject *due = NULL;
    struct store *s = NULL;
    size_t n = 0;
    enum status st;
    int code;

    if (!c->due)
        return ctl_usage(c, "it is: surfacectl purge --due");
    st = ctl_open(c, c->dry_run ? STORE_READ : STORE_WRITE, &s);
    if (st == ST_OK)
        st = store_subject_due(s, &due, &n, &c->e);
    code = st == ST_OK ? purge(c, s, due, n) : ctl_fail(c, st);
    store_close(s);
    free(due);
    return code;
}
