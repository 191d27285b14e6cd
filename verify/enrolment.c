#include "enrolment.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "trial.h"
#include "verdict.h"

static enum status mismatch(const struct nearest *n, struct errinfo *e)
{
    const char *why =
        "the sample does not fit: it matches none of the subject's templates";

    if (nearest_judge(n, e) != ST_OK)
        return e->code = ST_EMISMATCH;
    if (n->result.decision == FACE_INCONCLUSIVE)
        why =
            "the sample has too little in common with any of the subject's templates to "
            "tell whether it fits";
    return errinfo_set(e, ST_EMISMATCH, "%s; only with force is it enrolled", why);
}

/* What asks may(). */
struct asking {
    const struct enrolment *x;
    struct enrolment_outcome *out;
};

static bool may(void *arg, const struct store_attempts *now)
{
    const struct asking *a = arg;

    a->out->locked = a->x->may != NULL && !a->x->may(a->x->arg, now);
    return !a->out->locked;
}

/* Without a template there is nothing to try. */
static enum status admitted(void *arg, const struct store_admission *a, struct errinfo *e)
{
    return a->n == 0 || may(arg, &a->attempts)
               ? ST_OK
               : errinfo_set(e, ST_EDENIED, "the subject is locked out");
}

/* Not told before it is counted and recorded: there would be no limit. */
static enum status settle(struct admission_context *c, const struct admission *a,
                          struct asking *ask, struct errinfo *e)
{
    const struct enrolment *x = ask->x;
    const struct nearest *n = &ask->out->nearest;
    char outcome[STORE_NAME_MAX + 1];
    struct store_settled out = {.lost = &ask->out->lost};
    const struct store_settle what = {.subject = &a->of.subject,
                                      .as = x->may != NULL ? STORE_SETTLE_FAILED
                                                           : STORE_SETTLE_UNCOUNTED,
                                      .actor = x->actor,
                                      .kind = "enroll_mismatch",
                                      .template_id = a->of.t[n->index].id,
                                      .outcome = outcome,
                                      .may = may,
                                      .arg = ask,
                                      .warn_failures = x->warn_failures,
                                      .warn_tried = x->warn_tried};
    enum status st;

    (void)snprintf(outcome, sizeof outcome, "%s%s", verdict_decision(n->result.decision),
                   x->captured != NULL ? x->captured : "");
    st = store_settle(c->store, &what, &out, e);
    ask->out->locked_out |= out.locked_out;
    ask->out->many_subjects |= out.many_subjects;
    if (st == ST_OK && !out.may)
        return errinfo_set(e, ST_EDENIED, "the subject is locked out");
    return st == ST_OK ? mismatch(n, e) : st;
}

/* newest: the id of the last template that it was compared with, "" where there is none.  A
 * subject that is not there yet is made with its first template. */
static enum status check_fit(struct admission_context *c, const struct enrolment *x,
                             const struct face *f, char newest[STORE_ID_LEN + 1],
                             struct enrolment_outcome *out, struct errinfo *e)
{
    struct asking ask = {x, out};
    const struct admission_request what = {
        .subject = x->subject, .token = x->actor, .admitted = admitted, .arg = &ask};
    struct admission a;
    enum status st = admission_read(c, &what, &a, e);

    newest[0] = '\0';
    out->nearest = (struct nearest){0};
    out->admit = a.admit;
    if (st == ST_OK && a.of.n > 0) {
        memcpy(newest, a.of.t[a.of.n - 1].id, STORE_ID_LEN + 1);
        st = nearest_find(c, &a, f, &out->nearest, e);
        if (st == ST_OK && out->nearest.result.decision != FACE_MATCH)
            st = settle(c, &a, &ask, e);
    }
    admission_free(c, &a);
    return st == ST_ENOTFOUND ? ST_OK
                              : st; /* of the subject, or of its templates by now */
}

/* All that is asked before an enrolment by force. */
static enum status look_at_subject(struct store *s, const char *subject, enum admit *out,
                                   struct errinfo *e)
{
    struct store_subject one;
    const enum status st = store_subject_get(s, subject, &one, e);

    if (st != ST_OK)
        return st == ST_ENOTFOUND ? ST_OK : st;
    *out = admit_subject(&one, e);
    return *out == ADMIT_YES ? ST_OK : ST_EDENIED;
}

/* From *first on, the first sample that may become a template. */
static enum status find_first(struct admission_context *c, const struct enrolment *x,
                              size_t *first, char newest[STORE_ID_LEN + 1],
                              struct enrolment_result *each,
                              struct enrolment_outcome *out, struct errinfo *e)
{
    for (; *first < x->n; ++*first) {
        const struct face *f = x->sample[*first].face;
        enum status st;

        if (f == NULL)
            continue;
        st = x->force ? look_at_subject(c->store, x->subject, &out->admit, e)
                      : check_fit(c, x, f, newest, out, e);
        each[*first].why.code = st;
        if (st != ST_EMISMATCH)
            return st;
        each[*first].why = *e;
    }
    out->none = true;
    *e = each[0].why;
    return e->code;
}

/* The samples behind the first, against that one. */
static enum status fit_others(struct admission_context *c, const struct enrolment *x,
                              size_t first, struct enrolment_result *each,
                              struct errinfo *e)
{
    enum status st = ST_OK;

    if (!x->force && first + 1 < x->n)
        st = admission_calibrate(c, e);
    for (size_t i = first + 1; st == ST_OK && !x->force && i < x->n; i++) {
        const struct face *f = x->sample[i].face;
        struct face_result r;

        if (f == NULL)
            continue;
        if ((st = face_compare(x->sample[first].face, f, (double)NAN, NULL, c->work,
                               &r)) != ST_OK)
            return errinfo_set(e, st, "comparing: %s", status_message(st));
        each[i].why = (struct errinfo){.code = ST_OK};
        if (r.decision != FACE_MATCH)
            (void)errinfo_set(
                &each[i].why, ST_EMISMATCH, "%s; only with force is it enrolled",
                r.decision == FACE_NO_MATCH
                    ? "the sample does not fit: it does not match the first that was taken"
                    : "the sample has too little in common with the first that was taken "
                      "to tell whether it fits");
    }
    return st;
}

static enum status store_fitting(struct admission_context *c, const struct enrolment *x,
                                 const char *newest, struct enrolment_result *each,
                                 struct errinfo *e)
{
    struct store_sample sample[ENROLMENT_SAMPLES];
    struct store_template t[ENROLMENT_SAMPLES];
    bool created[ENROLMENT_SAMPLES];
    struct store_enroll what = {.actor = x->actor,
                                .subject = x->subject,
                                .label = x->label,
                                .sample = sample,
                                .newest = x->force ? NULL : newest,
                                .captured = x->captured};
    enum status st;

    for (size_t i = 0; i < x->n; i++)
        if (each[i].why.code == ST_OK)
            sample[what.n++] = x->sample[i];
    st = store_enroll(c->store, &what, t, created, e);
    for (size_t i = 0, k = 0; st == ST_OK && i < x->n; i++)
        if (each[i].why.code == ST_OK) {
            each[i].tmpl = t[k];
            each[i].created = created[k++];
        }
    return st;
}

enum status enrolment_add(struct admission_context *c, const struct enrolment *x,
                          struct enrolment_result *each, struct enrolment_outcome *out,
                          struct errinfo *e)
{
    char newest[STORE_ID_LEN + 1];
    size_t first = 0;
    enum status st;

    *out = (struct enrolment_outcome){0};
    do { /* again only when another enrolment came in between */
        if ((st = find_first(c, x, &first, newest, each, out, e)) != ST_OK ||
            (st = fit_others(c, x, first, each, e)) != ST_OK)
            return st;
        st = store_fitting(c, x, newest, each, e);
    } while (st == ST_EEXISTS);
    return st;
}

const char *enrolment_code(enum status st)
{
    return st == ST_EMISMATCH ? "sample_mismatch" : trial_code(st);
}
