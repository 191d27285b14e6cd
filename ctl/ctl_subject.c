/* Subjects: listed, described, changed; their failed verifications. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "describe.h"
#include "ctl_command.h"
#include "ctl_model.h"
#include "ctl_template.h"
#include "ctl_token.h"
#include "utc.h"

#define PAGE 500 /* subjects in memory at a time */

static const char *consent, *purpose; /* --consent, --purpose */
static const char *part, *state;      /* --match, --state */
static const char *group, *identify;  /* --group, --identify */
static const char *reset_token;       /* --token */

/* What stands beside an id in a list. */
static const char *state_of(const struct store_subject *one)
{
    static char out[40];
    const char *const word[] = {one->hold ? "hold" : NULL,
                                one->disabled ? "disabled" : NULL,
                                one->identify ? NULL : "opted out"};
    size_t n = 0;

    out[0] = '\0';
    for (size_t i = 0; i < sizeof word / sizeof *word; i++)
        if (word[i] != NULL)
            n += (size_t)snprintf(out + n, sizeof out - n, "%s%s", n > 0 ? ", " : "",
                                  word[i]);
    return out;
}

static void list_one(struct ctl *c, const struct store_subject *one)
{
    json_object(c->out, NULL);
    describe_subject_row(c->out, one);
    json_close(c->out);
    ctl_say(c, "%-32s %9u  %-24s  %-25s  %s\n", one->id, one->templates, one->created,
            state_of(one), one->groups);
}

static enum status ctl_run_subject_list(struct ctl *c)
{
    struct store_search what = {.group = group != NULL ? group : "",
                                .part = part != NULL ? part : "",
                                .limit = PAGE};
    struct store_subject *page;
    size_t n, all = 0;
    enum status st = ST_OK;

    if (state != NULL && (!store_subject_state(state, &what.state) ||
                          what.state == STORE_LOCKED)) /* attempts list has those */
        return ctl_usage(
            c, "--state is active, disabled, hold, expired, ending or no_consent");
    if (group != NULL && !groups_label(group))
        return ctl_usage(c, "--group is one group: 1 to %d characters of a-z 0-9 . _ -",
                         GROUPS_LABEL);
    json_array(c->out, "subjects");
    do {
        st = store_subject_search(c->store, c->actor, &what, &page, &n, &what.after,
                                  &c->e);
        if (n > 0 && all == 0)
            ctl_say(c, "%-32s %9s  %-24s  %-25s  %s\n", "SUBJECT", "TEMPLATES", "CREATED",
                    "STATE", "GROUPS");
        for (size_t i = 0; i < n; i++)
            list_one(c, &page[i]);
        all += n;
        free(page);
    } while (st == ST_OK && what.after != 0);
    json_close(c->out);
    if (st == ST_OK && all == 0)
        ctl_say(c, "no subjects\n");
    return st;
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
    if (one->groups[0] != '\0')
        (void)printf("  groups    %s\n", one->groups);
    if (!one->identify)
        (void)printf("  opted out no search finds the subject\n");
    if (one->hold)
        (void)printf("  on hold   cannot be erased\n");
    if (one->disabled)
        (void)printf("  disabled  is not verified\n");
}

static enum status ctl_run_subject_show(struct ctl *c)
{
    struct store_subject one;
    struct store_template *list = NULL;
    size_t n;
    enum status st = store_subject_get(c->store, c->actor, c->args[0], &one, &c->e);

    if (st != ST_OK ||
        (st = store_template_list(c->store, c->actor, one.id, &list, &n, &c->e)) != ST_OK)
        return st;
    describe_subject(c->out, &one);
    json_array(c->out, "templates");
    if (!c->json)
        print_subject(&one, n);
    for (size_t i = 0; i < n; i++) {
        json_object(c->out, NULL);
        ctl_template_tell(c, &list[i]);
        json_close(c->out);
    }
    json_close(c->out);
    free(list);
    return ST_OK;
}

/* ---- changes */

/* The subject after the change, as JSON or a line of text. */
static enum status ctl_subject_tell(struct ctl *c, const char *id, const char *done)
{
    struct store_subject one;
    enum status st = store_subject_get(c->store, c->actor, id, &one, &c->e);

    if (st != ST_OK)
        return st;
    describe_subject(c->out, &one);
    ctl_say(c, "%s: %s\n", one.id, done);
    return ST_OK;
}

/* Returns the text of --expires; NULL: not given. */
static const char *expiry(const struct ctl *c, char text[UTC_TEXT])
{
    if (!c->expires.given)
        return NULL;
    text[0] = '\0';
    if (c->expires.end_ms != STORE_NEVER)
        utc_print(c->expires.end_ms, text);
    return text;
}

static enum status set(struct ctl *c)
{
    struct store_subject new = {.expired = false};
    char text[UTC_TEXT];
    const char *id = c->args[0], *expires = expiry(c, text);
    const struct store_subject_change what = {.reference = consent,
                                              .purpose = purpose,
                                              .expires = expires,
                                              .groups = group,
                                              .identify = identify != NULL ? &new.identify
                                                                           : NULL};
    enum status st;

    if (consent == NULL && purpose == NULL && expires == NULL && group == NULL &&
        identify == NULL)
        return ctl_usage(c,
                         "subject set needs --consent, --purpose, --expires, --group or "
                         "--identify");
    if (identify != NULL && strcmp(identify, "yes") != 0 && strcmp(identify, "no") != 0)
        return ctl_usage(c, "--identify is yes or no");
    new.identify = identify == NULL || strcmp(identify, "yes") == 0;
    if ((st = ctl_model_open(c, STORE_WRITE)) != ST_OK)
        return st;
    st = store_subject_set(c->store, c->actor, id, &what, &c->e);
    if (st == ST_OK)
        return ctl_subject_tell(c, id, "recorded");
    if (st != ST_ENOTFOUND)
        return st;
    (void)snprintf(new.id, sizeof new.id, "%s", id);
    if ((consent != NULL && strlen(consent) >= sizeof new.reference) ||
        (purpose != NULL && strlen(purpose) >= sizeof new.purpose))
        return errinfo_set(&c->e, ST_EINVAL,
                           "--consent and --purpose take up to %d bytes", STORE_NOTE_MAX);
    (void)snprintf(new.reference, sizeof new.reference, "%s",
                   consent != NULL ? consent : "");
    (void)snprintf(new.purpose, sizeof new.purpose, "%s", purpose != NULL ? purpose : "");
    (void)snprintf(new.expires, sizeof new.expires, "%s", expires != NULL ? expires : "");
    if (group != NULL && (st = groups_read(group, new.groups, &c->e)) != ST_OK)
        return st;
    st = store_subject_add(c->store, c->actor, &new, &c->e);
    return st == ST_OK ? ctl_subject_tell(c, id, "added") : st;
}

static enum status rename_it(struct ctl *c)
{
    const enum status st =
        store_subject_rename(c->store, c->actor, c->args[0], c->args[1], &c->e);

    return st == ST_OK ? ctl_subject_tell(c, c->args[1], "renamed") : st;
}

static enum status change(struct ctl *c, const struct store_subject_change *what,
                          const char *done)
{
    const enum status st = store_subject_set(c->store, c->actor, c->args[0], what, &c->e);

    return st == ST_OK ? ctl_subject_tell(c, c->args[0], done) : st;
}

static const bool yes = true, no = false;

static enum status disable(struct ctl *c)
{
    return change(c, &(struct store_subject_change){.disabled = &yes}, "disabled");
}

static enum status enable(struct ctl *c)
{
    return change(c, &(struct store_subject_change){.disabled = &no}, "enabled");
}

static enum status hold(struct ctl *c)
{
    return change(c, &(struct store_subject_change){.hold = &yes}, "on hold");
}

static enum status ctl_run_subject_release(struct ctl *c)
{
    return change(c, &(struct store_subject_change){.hold = &no}, "not on hold");
}

/* ---- failed verifications */

static int by_token(const void *a, const void *b)
{
    return strcmp(((const struct store_attempts *)a)->token,
                  ((const struct store_attempts *)b)->token);
}

struct tokens {
    struct store_token *token;
    size_t n;
};

static const char *label_of(const struct tokens *t, const char *id,
                            char out[CTL_TOKEN_LABEL])
{
    const char *name = "";

    for (size_t i = 0; i < t->n; i++)
        if (strcmp(t->token[i].id, id) == 0)
            name = t->token[i].name;
    ctl_token_label(out, name, id[0] != '\0' ? id : "-");
    return out;
}

/* How many subjects each token has failed at within the hour after which it may try others again. */
static void list_tokens(struct ctl *c, const struct tokens *tokens,
                        struct store_attempts *a, size_t n)
{
    char label[CTL_TOKEN_LABEL];
    bool any = false;

    if (n > 0)
        qsort(a, n, sizeof *a, by_token);
    json_array(c->out, "tokens");
    for (size_t i = 0, tried = 0; i < n; i++) {
        tried += a[i].age_ms < STORE_TRIED_MS;
        if (i + 1 < n && by_token(&a[i], &a[i + 1]) == 0)
            continue;
        if (tried > 0 && a[i].token[0] != '\0') {
            if (!any)
                ctl_say(c, "\n%-32s %s\n", "TOKEN", "SUBJECTS WITHIN AN HOUR");
            any = true;
            json_object(c->out, NULL);
            json_text(c->out, "token", a[i].token);
            json_number(c->out, "subjects", (double)tried);
            json_close(c->out);
            ctl_say(c, "%-32s %zu\n", label_of(tokens, a[i].token, label), tried);
        }
        tried = 0;
    }
    json_close(c->out);
}

static enum status list_attempts(struct ctl *c)
{
    struct store_attempts *a;
    struct tokens tokens;
    char label[CTL_TOKEN_LABEL];
    size_t n;
    enum status st =
        store_token_list(c->store, c->actor, &tokens.token, &tokens.n, &c->e);

    if (st != ST_OK)
        return st;
    if ((st = store_attempts_list(c->store, &a, &n, &c->e)) != ST_OK) {
        free(tokens.token);
        return st;
    }
    json_array(c->out, "attempts");
    if (n > 0)
        ctl_say(c, "%-32s %-32s %8s  %s\n", "SUBJECT", "TOKEN", "FAILURES", "LAST");
    for (size_t i = 0; i < n; i++) {
        json_object(c->out, NULL);
        json_text(c->out, "subject", a[i].subject);
        json_text(c->out, "token", a[i].token);
        json_number(c->out, "failures", a[i].failures);
        json_text(c->out, "last", a[i].at);
        json_close(c->out);
        ctl_say(c, "%-32s %-32s %8u  %s\n", a[i].subject,
                label_of(&tokens, a[i].token, label), a[i].failures, a[i].at);
    }
    json_close(c->out);
    list_tokens(c, &tokens, a, n);
    if (n == 0)
        ctl_say(c, "no failed verifications\n");
    free(a);
    free(tokens.token);
    return ST_OK;
}

static enum status reset_attempts(struct ctl *c)
{
    const char *of = c->args[0];
    char id[STORE_ID_LEN + 1];
    enum status st;

    if ((c->nargs > 0) == (reset_token != NULL))
        return ctl_usage(c, "attempts reset needs a subject or --token, not both");
    if (reset_token == NULL) {
        st = store_attempts_reset(c->store, c->actor, of, &c->e);
    } else if ((st = ctl_token_find(c, reset_token, false, id)) == ST_OK) {
        of = id;
        st = store_attempts_reset_token(c->store, c->actor, of, &c->e);
    }
    if (st != ST_OK)
        return st;
    json_text(c->out, reset_token != NULL ? "token" : "subject", of);
    json_number(c->out, "failures", 0);
    ctl_say(c, "%s: failed verifications cleared\n", of);
    return ST_OK;
}

/* ---- the commands */

#define ONE_SUBJECT(how) .args = "SUBJECT", .takes = {1, 1}, .database = how

const struct ctl_command ctl_subject_list = {
    .name = "subject list",
    .database = CTL_READS_DATABASE,
    .options = {CTL_OPTION("match", "TEXT", command_text, &part,
                           "only those whose id has this in it"),
                CTL_OPTION("state", "WORD", command_text, &state,
                           "only those that are active, disabled, on hold, expired,\n"
                           "ending (within 30 days) or without a consent: active,\n"
                           "disabled, hold, expired, ending, no_consent"),
                CTL_OPTION("group", "NAME", command_text, &group,
                           "only those of this group")},
    .run = ctl_run_subject_list,
    .summary = "list the subjects, or search them",
    .help = "In order of creation.",
    .example = "surfacectl --db faces.db subject list --match alice"};

const struct ctl_command ctl_subject_show = {
    .name = "subject show",
    ONE_SUBJECT(CTL_READS_DATABASE),
    .shared = CTL_MODEL,
    .run = ctl_run_subject_show,
    .summary = "describe a subject and its templates",
    .help = "Consent, purpose, expiry, groups, when it was last seen, and each template.",
    .example = "surfacectl --db faces.db subject show alice"};

const struct ctl_command ctl_subject_set = {
    .name = "subject set",
    ONE_SUBJECT(CTL_NEEDS_DATABASE),
    .shared = CTL_EXPIRES,
    .options = {CTL_OPTION("consent", "TEXT", command_text, &consent,
                           "place of the consent: a number, a file; '' for none"),
                CTL_OPTION("purpose", "TEXT", command_text, &purpose,
                           "what the consent is for; '' for none"),
                CTL_OPTION("group", "LIST", command_text, &group,
                           "all groups of the subject: door-3,staff; '' for none"),
                CTL_OPTION("identify", "yes|no", command_text, &identify,
                           "no: searches among all subjects do not find it (yes)")},
    .run = set,
    .summary = "record a subject's consent, expiry and groups",
    .help =
        "Values that are not given are kept. A subject that does not exist is created without a\n"
        "template. An expired subject is not verified, and purge erases it.",
    .example =
        "surfacectl --db faces.db subject set alice --consent C-17 --expires 2027-01-31"};

const struct ctl_command ctl_subject_rename = {
    .name = "subject rename",
    .args = "SUBJECT NEW",
    .takes = {2, 2},
    .database = CTL_WRITES_DATABASE,
    .run = rename_it,
    .summary = "change a subject's id",
    .help = "Templates and records are kept. An id that another subject has is refused.",
    .example = "surfacectl --db faces.db subject rename alice alice.b"};

const struct ctl_command ctl_subject_disable = {
    .name = "subject disable",
    ONE_SUBJECT(CTL_WRITES_DATABASE),
    .run = disable,
    .summary = "stop verifying a subject",
    .help = "Nothing is deleted; `subject enable` undoes this.",
    .example = "surfacectl --db faces.db subject disable alice"};

const struct ctl_command ctl_subject_enable = {
    .name = "subject enable",
    ONE_SUBJECT(CTL_WRITES_DATABASE),
    .run = enable,
    .summary = "verify a disabled subject again",
    .help = "A running daemon follows at once.",
    .example = "surfacectl --db faces.db subject enable alice"};

const struct ctl_command ctl_subject_hold = {
    .name = "subject hold",
    ONE_SUBJECT(CTL_WRITES_DATABASE),
    .run = hold,
    .summary = "protect a subject from being erased",
    .help =
        "Neither it nor a template can be deleted until subject release, even after its expiry.",
    .example = "surfacectl --db faces.db subject hold alice"};

const struct ctl_command ctl_subject_release = {
    .name = "subject release",
    ONE_SUBJECT(CTL_WRITES_DATABASE),
    .run = ctl_run_subject_release,
    .summary = "end a subject's hold",
    .help = "The subject can be erased again; this command erases nothing.",
    .example = "surfacectl --db faces.db subject release alice"};

const struct ctl_command ctl_subject_attempts_list = {
    .name = "attempts list",
    .database = CTL_READS_DATABASE,
    .run = list_attempts,
    .summary = "list subjects with failed verifications",
    .help =
        "For each subject and token the failures in a row and the last; for each token the\n"
        "subjects that it failed on within an hour.",
    .example = "surfacectl --db faces.db attempts list"};

const struct ctl_command ctl_subject_attempts_reset = {
    .name = "attempts reset",
    .args = "[SUBJECT]",
    .takes = {0, 1},
    .database = CTL_WRITES_DATABASE,
    .options = {CTL_OPTION("token", "NAME", command_text, &reset_token,
                           "of this token (its name or id), on all subjects")},
    .run = reset_attempts,
    .summary = "end a lock-out, of a subject or of a token",
    .help = "Clears the failures on the subject by all tokens, or those by --token.",
    .example = "surfacectl --db faces.db attempts reset alice"};
