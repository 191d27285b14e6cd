#include "ctl_enroll_folder.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "codec.h"
#include "corpus.h"
#include "corpus_read.h"
#include "pool.h"
#include "ctl.h"
#include "ctl_model.h"
#include "ctl_face.h"
#include "ctl_sample.h"

enum result { UNDONE, ENROLLED, PRESENT, FAILED };

struct outcome { /* of a scan */
    enum result result;
    struct errinfo e; /* FAILED: why */
};

struct folder {
    struct ctl *c;
    const char *kind; /* NULL: all */
    bool force;
    const struct corpus *corpus;
    uint32_t *scan;  /* [corpus->nscan] those that are enrolled, a subject's together */
    uint32_t *first; /* [corpus->nsubject + 2] each subject's first, of scan */
    struct outcome *outcome; /* [corpus->nscan] */
};

/* ---- what is enrolled */

static bool wanted(const struct folder *w, const struct corpus_scan *scan)
{
    return w->kind == NULL || strcmp(w->corpus->kind[scan->kind], w->kind) == 0;
}

/* The scans by subject, each one's in the order of the collection: by counting. */
static uint32_t sort_scans(struct folder *w)
{
    const struct corpus *k = w->corpus;

    for (uint32_t i = 0; i < k->nscan; i++)
        if (wanted(w, &k->scan[i]))
            w->first[k->scan[i].subject + 2]++;
    for (uint32_t i = 0; i <= k->nsubject; i++)
        w->first[i + 1] += w->first[i]; /* a subject's first stands one place too far */
    for (uint32_t i = 0; i < k->nscan; i++)
        if (wanted(w, &k->scan[i]))
            w->scan[w->first[k->scan[i].subject + 1]++] =
                i; /* and is the next one's then */
    return w->first[k->nsubject];
}

/* ---- one subject after the other */

/* Has the subject this very cloud?  Nobody of that id: no. */
static enum status is_there(struct ctl *c, const char *subject, const struct face *f,
                            bool *there)
{
    struct store_template *t = NULL;
    char digest[65];
    size_t n = 0;
    enum status st = store_template_list(c->store, subject, &t, &n, &c->e);

    *there = false;
    if (st == ST_ENOTFOUND)
        return ST_OK;
    if (st == ST_OK && codec_digest(&f->surface.mesh, digest) != ST_OK)
        st = errinfo_set(&c->e, ST_ENOMEM, "out of memory");
    for (size_t i = 0; st == ST_OK && i < n; i++)
        *there = *there || strcmp(t[i].digest, digest) == 0;
    free(t);
    return st;
}

/* A scan's own fault, which does not stop the others; else the machine's. */
static bool is_fault(enum status st, bool stored)
{
    return stored ? st == ST_EMISMATCH || st == ST_EFULL || st == ST_EINVAL ||
                        st == ST_EDENIED
                  : st != ST_ENOMEM;
}

/* c: of this thread. */
static enum status enroll_scan(const struct folder *w, struct ctl *c, uint32_t i,
                               struct face_work *work, struct face *f)
{
    const struct corpus_scan *scan = &w->corpus->scan[i];
    struct scan_found found;
    const struct enrolment x = {
        .actor = c->actor,
        .subject = w->corpus->subject[scan->subject].id,
        .label = c->label != NULL ? c->label : w->corpus->kind[scan->kind],
        .sample = &(struct store_sample){.face = f, .read = found.digest},
        .n = 1,
        .manager = true,
        .force = w->force};
    struct outcome *o = &w->outcome[i];
    struct enrolment_result one = {.created = false};
    struct enrolment_outcome out;
    bool there = false, stored = false;
    char where[104];
    enum status st;

    (void)snprintf(where, sizeof where, "%.100s: ", scan->path);
    if ((st = ctl_face_subject(c, x.subject, where)) == ST_OK)
        st = ctl_sample_read(c, scan->path, true, work, f, &found);
    if (st == ST_OK) {
        stored = true;
        st = is_there(c, x.subject, f, &there);
    }
    if (st == ST_OK && !there)
        st = ctl_face_enroll(c, &x, work, &one, &out);
    if (st == ST_OK) {
        o->result = one.created ? ENROLLED : PRESENT;
        return ST_OK;
    }
    if (st == ST_EMISMATCH)
        (void)errinfo_set(&c->e, st, "%s%s", where, one.why.msg);
    o->e = c->e;
    o->e.code = st;
    if (!is_fault(st, stored))
        return st;
    o->result = FAILED;
    return ST_OK;
}

/* All of a subject's scans, since the later have to fit the earlier. */
static enum status enroll_subject(void *arg, size_t i, struct face_work *work,
                                  struct errinfo *e)
{
    const struct folder *w = arg;
    struct ctl mine = *w->c; /* with an errinfo of its own */
    struct face f = {0};
    enum status st = ST_OK;

    for (uint32_t k = w->first[i]; st == ST_OK && k < w->first[i + 1]; k++)
        if ((st = enroll_scan(w, &mine, w->scan[k], work, &f)) != ST_OK && e != NULL)
            *e = mine.e;
    face_free(&f);
    return st;
}

/* ---- the report */

static void tell_failed(struct ctl *c, const struct corpus *k, uint32_t i,
                        const struct outcome *o)
{
    json_object(c->out, NULL);
    json_text(c->out, "file", k->scan[i].file);
    json_text(c->out, "subject", k->subject[k->scan[i].subject].id);
    json_text(c->out, "reason", status_message(o->e.code));
    json_text(c->out, "detail", o->e.msg);
    json_close(c->out);
    (void)fprintf(stderr, "surfacectl: %s\n", o->e.msg);
}

/* How many were not taken for which reason: the statuses, then those of corpus.c. */
static void tell_reasons(struct ctl *c, const uint32_t why[ST_COUNT],
                         const struct corpus *k)
{
    for (int st = 0; st < ST_COUNT; st++)
        if (why[st] > 0)
            ctl_say(c, "  %6u  %s\n", why[st], status_message((enum status)st));
    for (uint32_t i = 0; i < k->nleft; i++) {
        uint32_t before = 0, n = 0;

        while (k->left[before].why != k->left[i].why)
            before++;
        if (before < i)
            continue;
        for (uint32_t j = i; j < k->nleft; j++)
            n += k->left[j].why == k->left[i].why;
        ctl_say(c, "  %6u  %s\n", n, k->left[i].why);
    }
}

/* Returns how many scans failed or were left out. */
static uint32_t report(const struct folder *w, uint32_t n, double seconds)
{
    struct ctl *c = w->c;
    const uint32_t left = w->corpus->nleft;
    uint32_t count[FAILED + 1] = {0}, why[ST_COUNT] = {0};

    json_text(c->out, "collection", c->args[0]);
    json_array(c->out, "failures");
    for (uint32_t k = 0; k < n; k++) {
        const struct outcome *o = &w->outcome[w->scan[k]];

        count[o->result]++;
        if (o->result == FAILED) {
            why[o->e.code]++;
            tell_failed(c, w->corpus, w->scan[k], o);
        }
    }
    ctl_sample_left(c->out, w->corpus);
    ctl_sample_print_left(w->corpus);
    json_number(c->out, "scans", n);
    json_number(c->out, "enrolled", count[ENROLLED]);
    json_number(c->out, "present", count[PRESENT]);
    json_number(c->out, "failed", count[FAILED]);
    json_number(c->out, "left_out", left);
    json_number(c->out, "undone", count[UNDONE]);
    json_number(c->out, "seconds", seconds);
    ctl_say(c, "%" PRIu64 " scan%s of %s: %u enrolled, %u were there already, %u failed",
            CTL_COUNT(n), c->args[0], count[ENROLLED], count[PRESENT], count[FAILED]);
    if (left > 0)
        ctl_say(c, "; %u other%s left out", left, left == 1 ? "" : "s");
    if (count[UNDONE] > 0)
        ctl_say(c, "; %u not tried", count[UNDONE]);
    ctl_say(c, "; %.1f s\n", seconds);
    tell_reasons(c, why, w->corpus);
    return count[FAILED] + w->corpus->nleft_scan;
}

static enum status enroll(struct folder *w, uint32_t *failed, uint32_t *n)
{
    const double start = ctl_clock_ms();
    const struct corpus *k = w->corpus;
    enum status st;

    w->scan = calloc(k->nscan, sizeof *w->scan);
    w->first = calloc((size_t)k->nsubject + 2, sizeof *w->first);
    w->outcome = calloc(k->nscan, sizeof *w->outcome);
    if (w->scan == NULL || w->first == NULL || w->outcome == NULL)
        return errinfo_set(&w->c->e, ST_ENOMEM, "out of memory");
    if ((*n = sort_scans(w)) == 0)
        return errinfo_set(&w->c->e, ST_ENOTFOUND, "%.120s has no scan of kind %.40s",
                           w->c->args[0], w->kind);
    st = pool_run("enroll", w->c->threads, w->c->model, k->nsubject, enroll_subject, w,
                  &w->c->e);
    *failed = report(w, *n, (ctl_clock_ms() - start) / 1e3);
    return st;
}

enum status ctl_enroll_folder(struct ctl *c, const char *kind, bool force)
{
    struct folder w = {.c = c, .kind = kind, .force = force};
    struct corpus *corpus = NULL;
    uint32_t failed = 0, n = 0;
    enum status st = corpus_read(c->args[0], &corpus, &c->e);

    w.corpus = corpus;
    if (st == ST_OK && (st = ctl_model_open(c, STORE_WRITE)) == ST_OK)
        st = enroll(&w, &failed, &n);
    if (st == ST_OK && failed > 0)
        st = errinfo_set(&c->e, ST_EINVAL, "%u of %u scans were not enrolled", failed,
                         n + corpus->nleft_scan);
    corpus_free(corpus);
    free(w.scan);
    free(w.first);
    free(w.outcome);
    return st;
}
