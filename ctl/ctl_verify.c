/* verify and compare: a scan against a subject, or against another scan. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "verify.h"
#include "ctl_command.h"
#include "ctl_face.h"
#include "ctl_session.h"

static void print_result(struct ctl *c, const struct describe_comparison *x)
{
    const struct surface_comparison *r = x->result;

    describe_comparison(c->out, x);
    if (c->json)
        return;
    (void)printf("decision     %s\n", templates_decision(r->decision));
    ctl_face_score(stdout, r);
    (void)printf("common       %.0f %% of the template's face\n", 100 * r->overlap);
    ctl_face_alignment(stdout, x->minimal);
    ctl_face_regions(stdout, x->parts);
    ctl_face_minimal(stdout, x->minimal);
    ctl_face_scan(stdout, x->probe);
    ctl_face_warnings(stdout, "warnings", x->scan);
    if (x->other != NULL)
        ctl_face_warnings(stdout, "warnings of A", x->other);
    (void)printf("time         %.1f ms\n", x->times->total);
}

/* Compares probe.  Failed attempts are not counted: anyone who has the database could compare without them. */
static enum status ctl_verify_run(struct ctl *c, struct session *probe,
                                  const struct verify_request *of)
{
    const double start = command_clock_ms();
    struct templates_context with = ctl_face_context(c, c->work);
    struct describe_comparison x;
    struct surface_face *face = NULL;
    struct verify_request r = *of;
    struct verification v;
    enum status st;

    r.probe = probe;
    r.face = &face;
    r.detail = VERIFY_MEASURE;
    r.scores = true;
    st = verify_run(&with, &r, &v, &c->e);
    ctl_face_passed_over(&v.templates);
    if (probe->files)
        ctl_session_tell(c, probe);
    if (st == ST_OK) {
        v.times.parse = NAN;
        v.times.total = command_clock_ms() - start;
        x = verify_describe(&v, c->engine);
        c->code = ctl_face_exit(v.best.result.decision);
        print_result(c, &x);
    }
    if (st == ST_OK && r.other == NULL) {
        const struct store_template *t = &v.templates.of.t[v.best.index];

        ctl_say(c, "template     %s (the nearest of %u of %s, enrolled %s)\n", t->id,
                v.best.compared, r.of.subject, t->created);
    }
    verify_free(&v);
    surface_face_free(face);
    return st;
}

static enum status ctl_verify_verify(struct ctl *c)
{
    struct verify_request r = {.of = {.subject = c->args[0], .token = c->actor}};
    struct ctl_session *s = calloc(1, sizeof *s);
    enum status st = s != NULL ? ctl_session_list(c, 1, s) : errinfo_memory(&c->e);

    if (st == ST_OK && (st = ctl_session_read(c, s)) == ST_OK)
        st = ctl_verify_run(c, &s->session, &r);
    if (s != NULL)
        ctl_session_free(s);
    free(s);
    return st;
}

static enum status ctl_run_verify_compare(struct ctl *c)
{
    struct surface_face *face = NULL;
    struct session *s = calloc(2, sizeof *s);
    struct verify_request r = {.other = s, .other_face = &face};
    enum status st = s != NULL ? ST_OK : errinfo_memory(&c->e);

    for (int i = 0; st == ST_OK && i < 2; i++) {
        s[i].n = 1;
        s[i].frame[0].name = c->args[i];
        st = ctl_face_parse(c, c->args[i], &s[i].frame[0].points);
    }
    if (st == ST_OK)
        st = ctl_verify_run(c, &s[1], &r);
    for (int i = 0; s != NULL && i < 2; i++)
        session_free(&s[i]);
    surface_face_free(face);
    free(s);
    return st;
}

const struct ctl_command ctl_verify = {
    .name = "verify",
    .args = "SUBJECT FILE...",
    .takes = {2, CTL_MANY},
    .database = CTL_WRITES_DATABASE,
    .shared = CTL_SCANS | CTL_MODEL,
    .exits = {"match", "no match", CTL_INCONCLUSIVE},
    .run = ctl_verify_verify,
    .summary = "compare a scan with a subject's templates",
    .help =
        "Several FILEs, or a folder, are frames of one capture session, at most 20, and become\n"
        "one probe. The template with the highest score decides.",
    .example = "surfacectl --db faces.db verify alice probe.ply"};

const struct ctl_command ctl_verify_compare = {
    .name = "compare",
    .args = "A B",
    .takes = {2, 2},
    .shared = CTL_SCANS | CTL_MODEL,
    .exits = {"match", "no match", CTL_INCONCLUSIVE},
    .run = ctl_run_verify_compare,
    .summary = "compare two scans, without a database",
    .help = "B is moved onto A.  Nothing is stored.",
    .example = "surfacectl compare monday.ply tuesday.ply"};
