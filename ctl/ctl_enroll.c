/* enroll: the files of a subject; ctl_enroll_folder.h: many subjects. */
#include <stdio.h>
#include <sys/stat.h>

#include "describe.h"
#include "ctl_command.h"
#include "ctl_enroll_folder.h"
#include "ctl_face.h"
#include "ctl_model.h"
#include "ctl_sample.h"

static bool force;       /* --force */
static const char *kind; /* --kind */

static enum status enroll_file(struct ctl *c, const char *subject, const char *path,
                               struct face *f)
{
    struct scan_found found;
    const struct enrolment x = {.actor = CTL_ACTOR,
                                .subject = subject,
                                .label = c->label != NULL ? c->label : "",
                                .face = f,
                                .read = found.digest,
                                .force = force};
    struct json *o = c->out;
    struct enrolment_outcome out;
    enum status st = ctl_sample_read(c, path, true, c->work, f, &found);

    if (st == ST_OK)
        st = ctl_face_enroll(c, &x, path, c->work, &out);
    json_object(o, NULL);
    json_text(o, "file", path);
    if (st == ST_OK) {
        const struct store_template *t = &out.tmpl;

        json_flag(o, "new", out.created);
        describe_template(o, t, &f->frame);
        describe_scan(o, "scan", &found);
        if (!c->json) {
            (void)printf("%s  %s  %u points, quality %.2f%s", t->id, path, t->points,
                         t->quality.score, out.created ? "" : " (was there already)");
            ctl_face_reasons(stdout, f);
        }
    } else {
        json_text(o, "error", c->e.msg);
        (void)fprintf(stderr, "surfacectl: %s\n", c->e.msg);
    }
    json_close(o);
    return st;
}

static enum status enroll_files(struct ctl *c)
{
    const char *subject = c->args[0];
    struct face f = {0};
    int failed = 0;
    enum status st = ctl_face_subject(c, subject, ""), worst;

    if (st != ST_OK || (st = ctl_model_open(c, STORE_WRITE)) != ST_OK)
        return st;
    json_text(c->out, "subject", subject);
    json_array(c->out, "templates");
    worst = ST_OK;
    for (int i = 1; i < c->nargs; i++) /* one bad scan does not stop the others */
        if ((st = enroll_file(c, subject, c->args[i], &f)) != ST_OK) {
            failed++;
            worst = st;
        }
    json_close(c->out);
    json_number(c->out, "failed", failed);
    face_free(&f);
    if (failed == 0)
        return ST_OK;
    return errinfo_set(&c->e, worst, "%d of %d scans were not enrolled", failed,
                       c->nargs - 1);
}

static enum status run(struct ctl *c)
{
    struct stat sb;

    if (c->nargs == 1) {
        if (stat(c->args[0], &sb) != 0)
            return ctl_usage(c,
                             "it is: surfacectl enroll SUBJECT FILE..., or "
                             "enroll DIR|MANIFEST, and there is no %.80s",
                             c->args[0]);
        return ctl_enroll_folder(c, kind, force);
    }
    if (kind != NULL || c->threads != 0)
        return ctl_usage(c, "--kind and --threads are for a folder or a table");
    return enroll_files(c);
}

const struct ctl_command ctl_enroll = {
    .name = "enroll",
    .args = "SUBJECT FILE... | DIR | MANIFEST",
    .takes = {1, CTL_MANY},
    .database = CTL_NEEDS_DATABASE,
    .shared = CTL_SCANS | CTL_MODEL | CTL_LABEL | CTL_THREADS,
    .options = {CTL_OPTION("force", NULL, ctl_option_flag, &force,
                           "enroll scans that do not fit the subject's other samples"),
                CTL_OPTION("kind", "WORD", ctl_option_text, &kind,
                           "of a folder or a table, only the scans of this kind")},
    .run = run,
    .summary = "enroll scans of a subject, or of many",
    .help =
        "Each FILE (PLY, OBJ, STL, PCD, GLB, XYZ, PTS, CSV, depth PNG, JSON; - is standard input)\n"
        "becomes a template.  Enrolling the same scan again changes nothing.  A scan that matches\n"
        "none of the subject's templates, or does not tell (inconclusive), is refused unless\n"
        "--force is given.\n"
        "DIR holds scans named SUBJECT_KIND.ply, or an index.csv; MANIFEST is such a table, with\n"
        "the columns file and subject.  Their scans are enrolled on all cores.  If it is stopped\n"
        "and started again, it goes on where it was.\n"
        "What cannot be enrolled is listed at the end with the reason, and stops nothing else;\n"
        "surfacectl scan says more of a single scan.",
    .example = "surfacectl --db faces.db enroll alice alice-1.ply alice-2.ply"};
