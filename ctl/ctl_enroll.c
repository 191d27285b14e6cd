/* enroll: the files of a subject; or a folder or a table of many subjects' scans (corpus.h), on
 * all cores: the next run continues an interrupted one. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "corpus.h"
#include "corpus_read.h"
#include "describe.h"
#include "digest.h"
#include "enrolment.h"
#include "ctl_command.h"
#include "ctl_face.h"
#include "ctl_model.h"
#include "ctl_session.h"
#include "pool.h"

static bool force, each, unique;         /* --force, --each, --unique */
static struct gallery *gallery;          /* with --unique: of all people */
static const char *label, *kind, *group; /* --label, --kind, --group */

/* The scans of a subject that are enrolled together. */
struct burst {
    struct ctl_session files; /* the files and the session */
    struct surface_face *face[ENROLMENT_SAMPLES];
    struct sample_found found[ENROLMENT_SAMPLES];
    struct enrolment_result each[ENROLMENT_SAMPLES];
    size_t n; /* number of faces: that of the files, or 1 for a fused session */
};

/* ---- enrolling them */

/* The database is the user's own: he learns whose face it is. */
static enum status name_twin(enum status st, const struct enrolment_outcome *out,
                             struct errinfo *e)
{
    return st == ST_EEXISTS && out->twin[0] != '\0'
               ? errinfo_set(e, st, "this face is enrolled already, as subject %s",
                             out->twin)
               : st;
}

static enum status ctl_enroll_add(struct ctl *c, struct burst *b,
                                  const struct store_sample *sample)
{
    const struct enrolment x = {.actor = c->actor,
                                .subject = c->args[0],
                                .label = label != NULL ? label : "",
                                .sample = sample,
                                .n = b->n,
                                .manager = true,
                                .groups = group,
                                .gallery = gallery,
                                .force = force};
    struct templates_context with = ctl_face_context(c, c->work);
    struct enrolment_outcome out;
    const enum status st = enrolment_add(&with, &x, NULL, b->each, &out, &c->e);

    return out.none ? ST_OK : name_twin(st, &out, &c->e);
}

static enum status enroll_each(struct ctl *c, struct burst *b)
{
    struct store_sample sample[ENROLMENT_SAMPLES] = {{.face = NULL}};

    b->n = b->files.n;
    for (size_t i = 0; i < b->n; i++) { /* one bad scan does not stop the others */
        const enum status st =
            ctl_face_read(c, b->files.path[i], true, c->work, &b->face[i], &b->found[i]);

        if (st == ST_ENOMEM)
            return st;
        if (st == ST_OK)
            sample[i] =
                (struct store_sample){.face = b->face[i], .read = b->found[i].digest};
        else
            b->each[i].why = c->e;
    }
    return ctl_enroll_add(c, b, sample);
}

static enum status enroll_fused(struct ctl *c, struct burst *b)
{
    const struct sample_options o = {.enrolment = true};
    struct session *s = &b->files.session;
    struct store_sample sample = {.face = NULL};
    enum status st = ctl_session_read(c, &b->files);

    b->n = 1;
    if (st == ST_OK)
        st = session_build(s, &o, c->work, &b->face[0], &c->e);
    b->found[0] = s->found;
    ctl_session_tell(c, s);
    session_describe(c->out, s);
    if (st != ST_OK)
        return st;
    sample = (struct store_sample){.face = b->face[0], .read = s->read};
    return ctl_enroll_add(c, b, &sample);
}

/* Returns how many were refused, and the status of the last in *worst. */
static size_t report_burst(struct ctl *c, const struct burst *b, enum status *worst)
{
    size_t failed = 0;

    json_text(c->out, "subject", c->args[0]);
    json_array(c->out, "templates");
    for (size_t i = 0; i < b->n; i++) {
        const struct enrolment_result *x = &b->each[i];
        const struct surface_face *f = b->face[i];
        const struct session *session = &b->files.session;
        const char *path = b->files.path[session->n > 0 ? session->base : i];

        json_object(c->out, NULL);
        enrolment_describe(c->out, path, x, &b->found[i], f);
        json_close(c->out);
        if (x->why.code == ST_OK) {
            ctl_say(c, "%s  %s  %u points, quality %.2f%s", x->tmpl.id, path,
                    x->tmpl.points, x->tmpl.quality.score,
                    x->created ? "" : " (already enrolled)");
            if (!c->json)
                ctl_face_reasons(stdout, f);
            continue;
        }
        (void)fprintf(stderr, "surfacectl: %s%s%s\n",
                      x->why.code == ST_EMISMATCH ? path : "",
                      x->why.code == ST_EMISMATCH ? ": " : "", x->why.msg);
        *worst = x->why.code;
        failed++;
    }
    json_close(c->out);
    json_number(c->out, "failed", (double)failed);
    return failed;
}

static enum status enroll_files(struct ctl *c)
{
    struct burst *b;
    enum status st = ident_subject(c->args[0], &c->e), worst = ST_OK;
    size_t failed;

    if (st != ST_OK)
        return st;
    if ((b = calloc(1, sizeof *b)) == NULL)
        return errinfo_memory(&c->e);
    if ((st = ctl_session_list(c, 1, &b->files)) == ST_OK &&
        (st = ctl_model_open(c, STORE_WRITE)) == ST_OK)
        st = each || b->files.n == 1 ? enroll_each(c, b) : enroll_fused(c, b);
    if (st == ST_OK && (failed = report_burst(c, b, &worst)) > 0)
        st =
            errinfo_set(&c->e, worst, "%zu of %zu scans were not enrolled", failed, b->n);
    for (size_t i = 0; i < ENROLMENT_SAMPLES; i++)
        surface_face_free(b->face[i]);
    ctl_session_free(&b->files);
    free(b);
    return st;
}

/* ---- many subjects */

enum result { UNDONE, ENROLLED, PRESENT, FAILED };

struct outcome { /* of a scan */
    enum result result;
    struct errinfo e; /* FAILED: why */
};

struct folder {
    struct ctl *c;
    const struct corpus *corpus;
    struct outcome *outcome; /* [corpus->nscan] */
};

static bool wanted(const struct folder *w, const struct corpus_scan *scan)
{
    return kind == NULL || strcmp(w->corpus->kind[scan->kind], kind) == 0;
}

/* ---- one subject after the other */

/* Sets *there to true if a template of the subject has this face. */
static enum status is_there(struct ctl *c, const char *subject,
                            const struct surface_face *f, bool *there)
{
    struct store_template *t = NULL;
    char digest[65];
    size_t n = 0;
    enum status st = store_template_list(c->store, c->actor, subject, &t, &n, &c->e);

    *there = false;
    if (st == ST_ENOTFOUND)
        return ST_OK;
    if (st == ST_OK && digest_face(f, digest) != ST_OK)
        st = errinfo_memory(&c->e);
    for (size_t i = 0; st == ST_OK && i < n; i++)
        *there = *there || strcmp(t[i].digest, digest) == 0;
    free(t);
    return st;
}

/* A scan's own fault, which does not stop the others; else the machine's. */
static bool is_fault(enum status st, bool stored)
{
    return stored ? st == ST_EMISMATCH || st == ST_EEXISTS || st == ST_EFULL ||
                        st == ST_EINVAL || st == ST_EDENIED
                  : st != ST_ENOMEM;
}

/* c: of this thread. */
static enum status enroll_scan(const struct folder *w, struct ctl *c, uint32_t i,
                               struct surface_work *work, struct surface_face **f)
{
    const struct corpus_scan *scan = &w->corpus->scan[i];
    struct store_sample sample = {.face = NULL};
    struct sample_found found;
    const struct enrolment x = {.actor = c->actor,
                                .subject = w->corpus->subject[scan->subject].id,
                                .label =
                                    label != NULL ? label : w->corpus->kind[scan->kind],
                                .sample = &sample,
                                .n = 1,
                                .manager = true,
                                .groups = group,
                                .force = force};
    struct templates_context with = ctl_face_context(c, work);
    struct outcome *o = &w->outcome[i];
    struct enrolment_result one = {.created = false};
    struct enrolment_outcome out;
    bool there = false, stored = false;
    char where[104];
    enum status st;

    (void)snprintf(where, sizeof where, "%.100s: ", scan->path);
    if ((st = ident_subject(x.subject, &one.why)) != ST_OK)
        (void)errinfo_set(&c->e, st, "%s%s", where, one.why.msg);
    else
        st = ctl_face_read(c, scan->path, true, work, f, &found);
    if (st == ST_OK) {
        stored = true;
        sample = (struct store_sample){.face = *f, .read = found.digest};
        st = is_there(c, x.subject, *f, &there);
    }
    if (st == ST_OK && !there)
        st = name_twin(enrolment_add(&with, &x, NULL, &one, &out, &c->e), &out, &c->e);
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

/* Enrolls a subject's scans in the order of the collection: the later ones must match the earlier ones. */
static enum status enroll_subject(void *arg, size_t i, struct surface_work *work,
                                  struct errinfo *e)
{
    const struct folder *w = arg;
    struct ctl mine = *w->c; /* a copy for its errinfo */
    struct surface_face *f = NULL;
    enum status st = ST_OK;

    for (uint32_t k = 0; st == ST_OK && k < w->corpus->nscan; k++)
        if (w->corpus->scan[k].subject == i && wanted(w, &w->corpus->scan[k]) &&
            (st = enroll_scan(w, &mine, k, work, &f)) != ST_OK && e != NULL)
            *e = mine.e;
    surface_face_free(f);
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

/* Prints the number of scans that were not enrolled for each reason: statuses, then reasons of corpus.c. */
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
static uint32_t ctl_enroll_report(const struct folder *w, uint32_t n, double seconds)
{
    struct ctl *c = w->c;
    const uint32_t left = w->corpus->nleft;
    uint32_t count[FAILED + 1] = {0}, why[ST_COUNT] = {0};

    json_text(c->out, "collection", c->args[0]);
    json_array(c->out, "failures");
    for (uint32_t i = 0; i < w->corpus->nscan; i++) {
        const struct outcome *o = &w->outcome[i];

        if (!wanted(w, &w->corpus->scan[i]))
            continue;
        count[o->result]++;
        if (o->result == FAILED) {
            why[o->e.code]++;
            tell_failed(c, w->corpus, i, o);
        }
    }
    corpus_left_json(w->corpus, c->out);
    corpus_left_print(w->corpus, "surfacectl");
    json_number(c->out, "scans", n);
    json_number(c->out, "enrolled", count[ENROLLED]);
    json_number(c->out, "present", count[PRESENT]);
    json_number(c->out, "failed", count[FAILED]);
    json_number(c->out, "left_out", left);
    json_number(c->out, "undone", count[UNDONE]);
    json_number(c->out, "seconds", seconds);
    ctl_say(c, "%" PRIu64 " scan%s of %s: %u enrolled, %u already enrolled, %u failed",
            CTL_COUNT(n), c->args[0], count[ENROLLED], count[PRESENT], count[FAILED]);
    if (left > 0)
        ctl_say(c, "; %u other%s ignored", left, left == 1 ? "" : "s");
    if (count[UNDONE] > 0)
        ctl_say(c, "; %u not tried", count[UNDONE]);
    ctl_say(c, "; %.1f s\n", seconds);
    tell_reasons(c, why, w->corpus);
    return count[FAILED] + w->corpus->nleft_scan;
}

static enum status enroll_all(struct folder *w, uint32_t *failed, uint32_t *n)
{
    const double start = command_clock_ms();
    const struct corpus *k = w->corpus;
    enum status st;

    if ((w->outcome = calloc(k->nscan, sizeof *w->outcome)) == NULL)
        return errinfo_memory(&w->c->e);
    for (uint32_t i = 0; i < k->nscan; i++)
        *n += wanted(w, &k->scan[i]);
    if (*n == 0)
        return errinfo_set(&w->c->e, ST_ENOTFOUND, "%.120s has no scan of kind %.40s",
                           w->c->args[0], kind);
    st = pool_run("enroll", w->c->threads, w->c->model, k->nsubject, enroll_subject, w,
                  &w->c->e);
    *failed = ctl_enroll_report(w, *n, (command_clock_ms() - start) / 1e3);
    return st;
}

static enum status enroll_collection(struct ctl *c)
{
    struct folder w = {.c = c};
    struct corpus *corpus = NULL;
    uint32_t failed = 0, n = 0;
    enum status st = corpus_read(c->args[0], &corpus, &c->e);

    w.corpus = corpus;
    if (st == ST_OK && (st = ctl_model_open(c, STORE_WRITE)) == ST_OK)
        st = enroll_all(&w, &failed, &n);
    if (st == ST_OK && failed > 0)
        st = errinfo_set(&c->e, ST_EINVAL, "%u of %u scans were not enrolled", failed,
                         n + corpus->nleft_scan);
    corpus_free(corpus);
    free(w.outcome);
    return st;
}

/* ---- the command */

static enum status enroll(struct ctl *c)
{
    struct stat sb;

    if (c->nargs == 1) {
        const bool there = stat(c->args[0], &sb) == 0;

        if (!there || corpus_is_scan(c->args[0]))
            return ctl_usage(c,
                             "%s%.80s%s; usage: surfacectl enroll SUBJECT FILE..., or "
                             "surfacectl enroll DIR|MANIFEST",
                             there ? "" : "there is no folder or table ", c->args[0],
                             there ? " is one scan, and its subject is missing" : "");
        return enroll_collection(c);
    }
    if (kind != NULL || c->threads != 0)
        return ctl_usage(c, "--kind and --threads are for a folder or a table");
    return enroll_files(c);
}

static enum status ctl_enroll_run(struct ctl *c)
{
    enum status st;

    if (unique && (gallery = gallery_new(SIZE_MAX)) == NULL)
        return errinfo_memory(&c->e);
    st = enroll(c);
    gallery_free(gallery);
    gallery = NULL;
    return st;
}

const struct ctl_command ctl_enroll = {
    .name = "enroll",
    .args = "SUBJECT FILE... | DIR | MANIFEST",
    .takes = {1, CTL_MANY},
    .database = CTL_NEEDS_DATABASE,
    .shared = CTL_SCANS | CTL_MODEL | CTL_THREADS,
    .options = {CTL_OPTION("force", NULL, command_flag, &force,
                           "enroll scans that do not match the subject's other samples"),
                CTL_OPTION("each", NULL, command_flag, &each,
                           "make each file a template of its own"),
                CTL_OPTION("unique", NULL, command_flag, &unique,
                           "refuse a new subject whose face another subject has"),
                CTL_OPTION("label", "TEXT", command_text, &label,
                           "a note stored with each template"),
                CTL_OPTION("group", "LIST", command_text, &group,
                           "groups of a subject that is new, such as door-3,staff"),
                CTL_OPTION("kind", "WORD", command_text, &kind,
                           "enroll only the scans of this kind (folder or table)")},
    .run = ctl_enroll_run,
    .summary = "enroll scans of one subject, or of many subjects",
    .help =
        "The FILEs (-: standard input; a folder: the scans in it) are frames of one capture\n"
        "session, at most 20, and become one template; with --each a template each. A face that\n"
        "does not match the subject's templates is refused without --force.\n"
        "DIR holds scans named SUBJECT_KIND.ply, or an index.csv; MANIFEST is such a table with\n"
        "the columns file and subject. Refused scans are listed, and do not stop the others; an\n"
        "interrupted run continues when it is started again.",
    .example = "surfacectl --db faces.db enroll alice alice-1.ply alice-2.ply"};
