/* verify and compare: a scan against a subject, or against another scan. */
#include <math.h>
#include <stdio.h>

#include "describe.h"
#include "minimal.h"
#include "replay.h"
#include "scan.h"
#include "verdict.h"
#include "ctl_command.h"
#include "ctl_face.h"
#include "ctl_sample.h"

static void print_result(struct ctl *c, const struct describe_comparison *x)
{
    const struct face_result *r = x->result;

    describe_comparison(c->out, x);
    if (c->json)
        return;
    (void)printf("decision     %s\n", verdict_decision(r->decision));
    ctl_face_score(stdout, r);
    (void)printf("common       %.0f %% of the template's face\n", 100 * r->overlap);
    ctl_face_alignment(stdout, &r->align);
    ctl_face_regions(stdout, r);
    ctl_face_minimal(stdout, x->minimal);
    ctl_face_scan(stdout, x->probe);
    ctl_sample_warnings(stdout, "warnings", x->scan);
    if (x->other != NULL)
        ctl_sample_warnings(stdout, "warnings of A", x->other);
    (void)printf("time         %.1f ms\n", x->times->total);
}

/* Anyone who has the database is not locked out of it: attempts are not counted. */
static enum status settle(struct ctl *c, const struct ctl_nearest *best,
                          const struct scan_found *found, const struct face *f)
{
    struct store_probe probe = {0};
    struct store_settled out = {.may = false};
    const enum face_decision decision = best->nearest.result.decision;
    const struct store_settle what = {.subject = &best->subject,
                                      .as = STORE_SETTLE_UNCOUNTED,
                                      .actor = c->actor,
                                      .kind = "verify",
                                      .template_id = best->tmpl.id,
                                      .outcome = verdict_decision(decision),
                                      .probe = decision == FACE_MATCH ? &probe : NULL};
    enum status st = replay_probe(&best->tmpl, found, f, &probe, &c->e);

    if (st == ST_OK)
        st = store_settle(c->store, &what, &out, &c->e);
    return st == ST_OK && out.replayed ? replay_refuse(&c->e) : st;
}

static enum status verify(struct ctl *c)
{
    const char *subject = c->args[0];
    const double start = ctl_clock_ms();
    struct scan_found found;
    struct face probe = {0};
    struct ctl_nearest best;
    enum status st = ctl_sample_read(c, c->args[1], false, c->work, &probe, &found);

    if (st == ST_OK)
        st = ctl_face_nearest(c, subject, &probe, &best);
    if (st == ST_OK)
        st = settle(c, &best, &found, &probe);
    if (st == ST_OK)
        st = nearest_judge(&best.nearest, &c->e);
    if (st == ST_OK) {
        c->code = ctl_face_exit(best.nearest.result.decision);
        print_result(
            c, &(struct describe_comparison){
                   .result = &best.nearest.result,
                   .minimal = &best.minimal,
                   .probe = &probe,
                   .scan = &found,
                   .engine = c->engine,
                   .subject = subject,
                   .template_id = best.tmpl.id,
                   .templates_compared = best.nearest.compared,
                   .measure = true,
                   .times = &(struct describe_times){
                       NAN, NAN, best.nearest.score_ms, best.nearest.result.align_ms,
                       best.minimal.ms, ctl_clock_ms() - start}});
        ctl_say(c, "template     %s (the nearest of %u of %s, enrolled %s)\n",
                best.tmpl.id, best.nearest.compared, subject, best.tmpl.created);
    }
    face_free(&probe);
    return st;
}

static enum status compare(struct ctl *c)
{
    const double start = ctl_clock_ms();
    struct scan_found found[2];
    struct face a = {0}, b = {0};
    struct face_result r = {0};
    struct minimal least = {0};
    enum status st;

    if ((st = ctl_sample_read(c, c->args[0], false, c->work, &a, &found[0])) == ST_OK &&
        (st = ctl_sample_read(c, c->args[1], false, c->work, &b, &found[1])) == ST_OK &&
        ((st = face_compare(&a, &b, (double)NAN, ctl_clock_ms, c->work, &r)) != ST_OK ||
         (st = face_minimal(&a, &b, ctl_clock_ms, c->work, &r, &least)) != ST_OK ||
         (st = face_weigh(&a, &b, c->work, &least)) != ST_OK ||
         (st = face_regions(&a, &b, c->work, &r)) != ST_OK))
        (void)errinfo_set(&c->e, st, "comparing: %s", status_message(st));
    if (st == ST_OK)
        print_result(
            c, &(struct describe_comparison){
                   .result = &r,
                   .minimal = &least,
                   .probe = &b,
                   .scan = &found[1],
                   .other = &found[0],
                   .engine = c->engine,
                   .templates_compared = 1,
                   .measure = true,
                   .times = &(struct describe_times){NAN, NAN, r.score_ms, r.align_ms,
                                                     least.ms, ctl_clock_ms() - start}});
    face_free(&a);
    face_free(&b);
    c->code = ctl_face_exit(r.decision);
    return st;
}

const struct ctl_command ctl_verify = {
    .name = "verify",
    .args = "SUBJECT FILE",
    .takes = {2, 2},
    .database = CTL_WRITES_DATABASE,
    .shared = CTL_SCANS | CTL_MODEL,
    .exits = {"match", "no match", CTL_INCONCLUSIVE},
    .run = verify,
    .summary = "compare a scan with a subject's templates",
    .help =
        "The template with the highest score decides; of n templates the score is lowered by\n"
        "ln n, since each is a chance for a false match.",
    .example = "surfacectl --db faces.db verify alice probe.ply"};

const struct ctl_command ctl_verify_compare = {
    .name = "compare",
    .args = "A B",
    .takes = {2, 2},
    .shared = CTL_SCANS | CTL_MODEL,
    .exits = {"match", "no match", CTL_INCONCLUSIVE},
    .run = compare,
    .summary = "compare two scans, without a database",
    .help = "B is moved onto A.  Nothing is stored.",
    .example = "surfacectl compare monday.ply tuesday.ply"};
