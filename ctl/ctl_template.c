/* Templates: listed, described, written as a scan, encoded again. */
#include "ctl_template.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "ctl_command.h"
#include "ctl_face.h"
#include "ctl_model.h"
#include "describe.h"
#include "pairs.h"
#include "pool.h"

static bool wants_compare; /* --compare */

void ctl_template_tell(struct ctl *c, const struct store_template *t)
{
    const bool other = !surface_same_engine(t->engine, c->engine);

    describe_template(c->out, t, NULL, true);
    json_flag(c->out, "to_reencode", other);
    ctl_say(c, "template  %s\n", t->id);
    ctl_say(c, "  subject   %s\n", t->subject);
    if (t->label[0] != '\0')
        ctl_say(c, "  label     %s\n", t->label);
    ctl_say(c, "  created   %s by %s%s\n", t->created, t->engine,
            other ? " (needs re-encoding)" : "");
    ctl_say(c, "  points    %u, %u triangles, %.2f mm apart\n", t->points, t->triangles,
            t->quality.density_mm);
    ctl_say(c, "  quality   %.2f (coverage %.0f %%, noise %.3f mm)\n", t->quality.score,
            100 * t->quality.coverage, t->quality.noise_mm);
    ctl_say(c, "  enrolled  %s; score against the oldest template then: ",
            t->manager ? "with scope manage" : "without scope manage");
    if (t->first_score != 0)
        ctl_say(c, "%.2f\n", t->first_score);
    else
        ctl_say(c, "none, it was the first\n");
    ctl_say(c, "  digest    %s\n", t->digest);
}

struct ctl_template_listing {
    struct ctl *c;
    size_t n;
};

/* A subject's templates as lines of a list. */
static enum status list_subject(struct ctl_template_listing *l, const char *subject)
{
    struct ctl *c = l->c;
    struct store_template *t = NULL;
    size_t n;
    enum status st = store_template_list(c->store, c->actor, subject, &t, &n, &c->e);

    for (size_t i = 0; st == ST_OK && i < n; i++) {
        if (c->json) {
            json_object(c->out, NULL);
            ctl_template_tell(c, &t[i]);
            json_close(c->out);
        }
        if (l->n++ == 0)
            ctl_say(c, "%-32s  %-24s  %7s  %7s  %7s  %s\n", "TEMPLATE", "CREATED",
                    "POINTS", "QUALITY", "FIRST", "SUBJECT");
        ctl_say(c, "%-32s  %-24s  %7u  %7.2f  %7.2f  %s%s%s%s%s\n", t[i].id, t[i].created,
                t[i].points, t[i].quality.score, t[i].first_score, t[i].subject,
                t[i].manager ? "  (manager)" : "", t[i].label[0] != '\0' ? "  " : "",
                t[i].label,
                surface_same_engine(t[i].engine, c->engine) ? ""
                                                            : "  (needs re-encoding)");
    }
    free(t);
    return st;
}

static enum status list_one(void *arg, const struct store_subject *one, struct errinfo *e)
{
    (void)e;
    return list_subject(arg, one->id);
}

/* Which of the templates fits how many of the others, and which two do not match. */
static void print_pairs(const struct pairs *p)
{
    static const char *const fit[] = {[PAIRS_UNKNOWN] = "cannot be told",
                                      [PAIRS_FITS] = "",
                                      [PAIRS_MISFIT] = "does not fit"};
    const struct store_template *t = p->templates.of.t;

    (void)printf("%-32s  %-24s  %7s\n", "TEMPLATE", "CREATED", "MATCHES");
    for (size_t i = 0; i < p->templates.of.n; i++)
        (void)printf("%-32s  %-24s  %7u  %s%s%s\n", t[i].id, t[i].created, p->matches[i],
                     t[i].label, t[i].label[0] != '\0' ? "  " : "", fit[p->fit[i]]);
    for (uint32_t i = 0; i < p->n; i++)
        if (p->one[i].result.decision != SURFACE_MATCH)
            (void)printf("%-12s  %s  %s  %.2f\n",
                         templates_decision(p->one[i].result.decision), t[p->one[i].a].id,
                         t[p->one[i].b].id, p->one[i].result.score);
}

static enum status compare_templates(struct ctl *c)
{
    struct templates_context with = ctl_face_context(c, c->work);
    const char *subject = c->args[0];
    struct pairs p = {.n = 0};
    enum status st = pairs_run(&with, subject, c->actor, NULL, &p, &c->e);

    if (st == ST_OK)
        st = store_event(c->store, "compare_templates", c->actor, subject, "", "written",
                         &c->e);
    if (st == ST_OK) {
        pairs_describe(c->out, &p, true, c->engine);
        if (!c->json)
            print_pairs(&p);
        c->code = EXIT_FINE;
        for (size_t i = 0; i < p.templates.of.n; i++)
            if (p.fit[i] == PAIRS_MISFIT)
                c->code = EXIT_NO;
    }
    pairs_free(&p);
    return st;
}

static enum status list_templates(struct ctl *c)
{
    struct ctl_template_listing l = {.c = c};
    enum status st;

    json_array(c->out, "templates");
    st = c->nargs > 0 ? list_subject(&l, c->args[0])
                      : ctl_model_each(c->store, list_one, &l, &c->e);
    json_close(c->out);
    if (st == ST_OK && l.n == 0)
        ctl_say(c, "no templates\n");
    return st;
}

static enum status ctl_run_template_list(struct ctl *c)
{
    enum status st;

    if (wants_compare && c->nargs == 0)
        return ctl_usage(c, "template list --compare needs a SUBJECT");
    if ((st = ctl_model_open(c, wants_compare ? STORE_WRITE : STORE_READ)) != ST_OK)
        return st;
    return wants_compare ? compare_templates(c) : list_templates(c);
}

static enum status ctl_run_template_show(struct ctl *c)
{
    struct store_template t;
    const enum status st = store_template_get(c->store, c->actor, c->args[0], &t, &c->e);

    if (st == ST_OK)
        ctl_template_tell(c, &t);
    return st;
}

static enum status export_template(struct ctl *c)
{
    struct store_template t = {.points = 0};
    struct surface_face *f = NULL;
    enum status st;

    if (c->dir == NULL)
        return ctl_usage(c, "template export needs --out FILE");
    if ((st = ctl_may_pipe(c, 0)) != ST_OK)
        return st;
    if ((st = ctl_model_open(c, STORE_WRITE)) == ST_OK)
        st = store_template_load(c->store, c->actor, c->args[0], &t, c->work, &f, &c->e);
    if (st == ST_OK) /* before: what leaves the database is in the events in any case */
        st = store_event(c->store, "export_template", c->actor, t.subject, t.id,
                         "written", &c->e);
    if (st == ST_OK && (st = ctl_write_face(c, c->dir, f)) == ST_OK) {
        json_text(c->out, "template_id", t.id);
        json_text(c->out, "subject", t.subject);
        json_text(c->out, "file", c->dir);
        json_number(c->out, "points", t.points);
        json_number(c->out, "triangles", t.triangles);
        ctl_say(c, "%s: %u points, %u triangles\n", c->dir, t.points, t.triangles);
    }
    surface_face_free(f);
    return st;
}

/* ---- encoded again, by this engine */

enum result { UNDONE, REENCODED, CURRENT, GONE, FAILED, RESULTS };

struct outcome { /* of a template */
    enum result result;
    struct errinfo e; /* FAILED: why */
};

struct batch {
    struct ctl *c;
    char (*id)[STORE_ID_LEN + 1];
    size_t n;
    struct outcome *outcome; /* [n] */
};

static enum status do_one(void *arg, size_t i, struct surface_work *w, struct errinfo *e)
{
    const struct batch *b = arg;
    struct outcome *o = &b->outcome[i];
    bool done = false;
    const enum status st =
        store_reencode(b->c->store, b->c->actor, b->id[i], w, &done, &o->e);

    if (st == ST_OK)
        o->result = done ? REENCODED : CURRENT;
    else if (st == ST_ENOTFOUND)
        o->result = GONE;
    else if (st == ST_EVERSION || st == ST_ECORRUPT)
        o->result = FAILED;
    else
        return errinfo_set(e, st, "%s", o->e.msg);
    return ST_OK;
}

/* Returns how many failed. */
static size_t ctl_template_report(const struct batch *b)
{
    struct ctl *c = b->c;
    size_t count[RESULTS] = {0};

    json_text(c->out, "engine", c->engine);
    json_array(c->out, "failures");
    for (size_t i = 0; i < b->n; i++) {
        const struct outcome *o = &b->outcome[i];

        count[o->result]++;
        if (o->result != FAILED)
            continue;
        json_object(c->out, NULL);
        json_text(c->out, "template_id", b->id[i]);
        json_text(c->out, "detail", o->e.msg);
        json_close(c->out);
        (void)fprintf(stderr, "surfacectl: %s\n", o->e.msg);
    }
    json_close(c->out);
    json_number(c->out, "templates", (double)b->n);
    json_number(c->out, "reencoded", (double)count[REENCODED]);
    json_number(c->out, "current", (double)count[CURRENT]);
    json_number(c->out, "gone", (double)count[GONE]);
    json_number(c->out, "failed", (double)count[FAILED]);
    json_number(c->out, "undone", (double)count[UNDONE]);
    ctl_say(c, "%" PRIu64 " template%s: %zu re-encoded by %s, %zu current, %zu failed\n",
            CTL_COUNT(b->n), count[REENCODED], c->engine, count[CURRENT], count[FAILED]);
    if (count[GONE] > 0)
        ctl_say(c, "%zu were deleted meanwhile\n", count[GONE]);
    if (count[UNDONE] > 0)
        ctl_say(c, "%zu were not tried\n", count[UNDONE]);
    return count[FAILED];
}

static enum status reencode(struct batch *b, size_t *failed)
{
    struct ctl *c = b->c;
    enum status st = store_reencode_due(b->c->store, &b->id, &b->n, &c->e);

    if (st != ST_OK)
        return st;
    if ((b->outcome = calloc(b->n + 1, sizeof *b->outcome)) == NULL)
        return errinfo_memory(&c->e);
    if (b->n > 0)
        st = pool_run("re-encoding", c->threads, c->model, b->n, do_one, b, &c->e);
    *failed = ctl_template_report(b);
    return st;
}

static enum status reencode_them(struct ctl *c)
{
    struct batch b = {.c = c};
    size_t failed = 0;
    enum status st = reencode(&b, &failed);

    free(b.id);
    free(b.outcome);
    if (st == ST_OK && failed > 0)
        st = errinfo_set(&c->e, ST_EVERSION,
                         "%zu of %" PRIu64 " template%s not re-encoded", failed,
                         CTL_COUNT(b.n));
    return st;
}

/* ---- the commands */

const struct ctl_command ctl_template_list = {
    .name = "template list",
    .args = "[SUBJECT]",
    .takes = {0, 1},
    .database = CTL_NEEDS_DATABASE,
    .shared = CTL_MODEL,
    .options = {CTL_OPTION("compare", NULL, command_flag, &wants_compare,
                           "compare the subject's templates with each other")},
    .exits = {"done", "a template does not fit the others"},
    .run = ctl_run_template_list,
    .summary = "list the templates",
    .help =
        "Of one subject or of all, oldest first. Templates of another engine are marked (template\n"
        "reencode). With --compare each of a subject's templates is compared with each: one that\n"
        "matches fewer of the others than it does not match is of another person, or of a bad\n"
        "sitting. Nothing is stored but an entry of the audit log.",
    .example = "surfacectl --db faces.db template list alice"};

const struct ctl_command ctl_template_show = {
    .name = "template show",
    .args = "ID",
    .takes = {1, 1},
    .database = CTL_READS_DATABASE,
    .shared = CTL_MODEL,
    .run = ctl_run_template_show,
    .summary = "describe a template",
    .help = "Its subject, time, engine and quality.",
    .example = "surfacectl --db faces.db template show 0123456789abcdef0123456789abcdef"};

const struct ctl_command ctl_template_export = {
    .name = "template export",
    .args = "ID",
    .takes = {1, 1},
    .database = CTL_NEEDS_DATABASE,
    .shared = CTL_MODEL | CTL_OUT | CTL_FORCE,
    .run = export_template,
    .summary = "write a template's points and triangles",
    .help = "PLY, millimetres. It is biometric data: only its owner can read the file.",
    .example =
        "surfacectl --db faces.db template export 0123456789abcdef0123456789abcdef -o a.ply"};

const struct ctl_command ctl_template_reencode = {
    .name = "template reencode",
    .database = CTL_WRITES_DATABASE,
    .shared = CTL_MODEL | CTL_THREADS,
    .exits = {"all of these templates are now of this engine"},
    .run = reencode_them,
    .summary = "re-encode templates of another engine",
    .help =
        "Stores what each program otherwise computes when it loads such a template, with the same\n"
        "decisions. A template that this engine does not accept as a face is listed and not\n"
        "changed.",
    .example = "surfacectl --db faces.db template reencode"};
