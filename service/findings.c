#include "findings.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drift.h"
#include "store.h"
#include "json.h"

#define MANY_TRIED    10 /* subjects in a day */
#define MANY_FAILURES 3  /* in a row, by one token: as many lock it out */
#define FIND_ALL      "surfacectl check-database lists all damage"
#define DAY_MS        INT64_C(86400000)

void findings_say(struct findings *x, enum findings_severity severity, const char *about,
                  const char *todo, const char *format, ...)
{
    char what[400];
    va_list args;

    va_start(args, format);
    (void)vsnprintf(what, sizeof what, format, args);
    va_end(args);
    x->errors += severity == FINDINGS_ERROR;
    x->tell(x->arg, &(struct finding){severity, about, what,
                                      severity == FINDINGS_OK ? "" : todo});
}

const char *findings_word(enum findings_severity severity)
{
    static const char *const word[] = {"ok", "warning", "error"};

    return word[severity];
}

void findings_describe(struct json *j, const struct finding *f)
{
    json_text(j, "severity", findings_word(f->severity));
    json_text(j, "about", f->about);
    json_text(j, "what", f->what);
    json_text_or_null(j, "do", f->todo);
}

const char *findings_count(char out[FINDINGS_COUNT], uint64_t n)
{
    size_t at = FINDINGS_COUNT - 1;
    int digits = 0;

    out[at] = '\0';
    do {
        if (digits > 0 && digits % 3 == 0)
            out[--at] = ',';
        out[--at] = (char)('0' + n % 10);
        digits++;
    } while ((n /= 10) > 0);
    return &out[at];
}

static void look_at_templates(struct findings *x, struct store *s)
{
    struct store_stats all;
    struct errinfo e;
    char some[FINDINGS_COUNT], of[FINDINGS_COUNT];
    size_t others = 0;
    enum status st = store_stats(s, false, &all, &e);

    if (st == ST_OK)
        st = store_reencode_due(s, NULL, &others, &e);
    if (st != ST_OK)
        findings_say(x, FINDINGS_ERROR, "templates", FIND_ALL, "%s", e.msg);
    else if (others > 0)
        findings_say(x, FINDINGS_ERROR, "templates",
                     "surfacectl template reencode, or name their model with --model",
                     "%s of %s were made by another engine than %s",
                     findings_count(some, others), findings_count(of, all.templates),
                     store_made_by(s));
    else
        findings_say(x, FINDINGS_OK, "templates", "", "%s, made by this engine",
                     findings_count(of, all.templates));
}

static void look_at_tokens(struct findings *x, struct store *s)
{
    struct store_token *t = NULL;
    struct errinfo e;
    size_t n = 0, soon = 0;
    const enum status st = store_token_list(s, "", &t, &n, &e);

    for (size_t i = 0; i < n; i++) {
        const int64_t left = store_token_left(&t[i]);

        if (left == 0 || left > STORE_TOKEN_SOON_S)
            continue;
        soon++;
        findings_say(x, FINDINGS_WARNING, "token",
                     "surfacectl token rotate ID --expires TIME", "%s (%s) expires at %s",
                     t[i].id, t[i].name, t[i].expires);
    }
    free(t);
    if (st != ST_OK)
        findings_say(x, FINDINGS_ERROR, "tokens", FIND_ALL, "%s", e.msg);
    else if (soon == 0)
        findings_say(x, FINDINGS_OK, "tokens", "", "none expires within 30 days");
}

/* Who fails: of one token, in the list from a[i] on (all of it are looked at). */
static void look_at_token(struct findings *x, const struct store_attempts *a, size_t n,
                          size_t i)
{
    const char *token = a[i].token;
    char text[FINDINGS_COUNT];
    size_t tried = 0;

    for (size_t j = 0; j < n; j++)
        if (a[j].age_ms < STORE_FAILED_MS && strcmp(a[j].token, token) == 0) {
            if (j < i)
                return; /* was reported */
            tried++;
        }
    if (tried >= MANY_TRIED)
        findings_say(
            x, FINDINGS_WARNING, "attempts",
            "find out who uses it: surfacectl audit show, attempts list; token revoke ends it",
            "token %s tried %s subjects without a match within a day",
            token[0] != '\0' ? token : "(none)", findings_count(text, tried));
}

static void look_at_attempts(struct findings *x, struct store *s)
{
    struct store_attempts *a = NULL;
    struct errinfo e;
    char text[FINDINGS_COUNT];
    size_t n = 0, locked = 0;

    if (store_attempts_list(s, &a, &n, &e) != ST_OK) {
        findings_say(x, FINDINGS_ERROR, "attempts", FIND_ALL, "%s", e.msg);
        n = 0;
    }
    for (size_t i = 0; i < n; i++) {
        locked += a[i].failures >= MANY_FAILURES && a[i].age_ms < DAY_MS;
        if (a[i].age_ms < STORE_TRIED_MS)
            look_at_token(x, a, n, i);
    }
    if (locked > 0)
        findings_say(x, FINDINGS_WARNING, "attempts", "see surfacectl attempts list",
                     "%s times in the last day %d verifications or more in a row failed",
                     findings_count(text, locked), MANY_FAILURES);
    free(a);
}

static void look_at_calibration(struct findings *x, struct store *s)
{
    struct store_calibration k;
    struct errinfo e;

    if (store_calibration_current(s, &k, &e) != ST_OK)
        findings_say(x, FINDINGS_ERROR, "calibration", FIND_ALL, "%s", e.msg);
    else if (k.ignored)
        findings_say(
            x, FINDINGS_WARNING, "calibration", "surfacectl calibrate",
            "the newest was made by another measure or model, and does not decide");
}

static void look_at_scans_of(void *arg, const struct drift_token *t)
{
    char text[DRIFT_TEXT];

    drift_say(&t->drift, text);
    if (t->drift.of != DRIFT_NONE)
        findings_say(arg, FINDINGS_WARNING, "scans",
                     "look at its scanner (dirt, light, distance, settings): surfacectl "
                     "scan FILE says what is wrong with a scan",
                     "%s: %s", t->name, text);
}

static void look_at_scans(struct findings *x, struct store *s)
{
    struct errinfo e;

    if (drift_each(s, look_at_scans_of, x, &e) != ST_OK)
        findings_say(x, FINDINGS_ERROR, "scans", FIND_ALL, "%s", e.msg);
}

void findings_store(struct findings *x, struct store *s)
{
    look_at_templates(x, s);
    look_at_tokens(x, s);
    look_at_attempts(x, s);
    look_at_scans(x, s);
    look_at_calibration(x, s);
}
