#include <stdio.h>
#include <sys/stat.h>

#include "describe.h"
#include "ctl.h"
#include "ctl_crowd.h"

enum status ctl_enroll_face(struct ctl *c, struct store *s, const char *subject,
                            const char *label, const char *path, struct face_work *w,
                            const struct face *f, struct store_template *t, bool *created)
{
    const struct enrolment x = {.actor = CTL_ACTOR,
                                .subject = subject,
                                .label = label,
                                .face = f,
                                .force = c->force};
    struct enrolment_outcome out;
    struct errinfo e;
    const enum status st = ctl_face_enroll(c, s, &x, w, &out);

    if (st == ST_EMISMATCH) {
        e = c->e;
        (void)errinfo_set(&c->e, st, "%.100s: %s", path, e.msg);
    }
    *t = out.tmpl;
    *created = out.created;
    return st;
}

static enum status enroll_file(struct ctl *c, struct store *s, const char *subject,
                               const char *path, struct face_work *w, struct face *f)
{
    struct ctl_out *o = c->out;
    struct store_template t;
    bool created;
    enum status st = ctl_scan_read(c, path, w, f);

    if (st == ST_OK)
        st = ctl_enroll_face(c, s, subject, c->label != NULL ? c->label : "", path, w, f,
                             &t, &created);
    ctl_out_object(o, NULL);
    ctl_out_text(o, "file", path);
    if (st == ST_OK) {
        ctl_out_text(o, "template_id", t.id);
        ctl_out_flag(o, "created", created);
        ctl_out_number(o, "points", t.points);
        ctl_out_number(o, "triangles", t.triangles);
        ctl_out_text(o, "digest", t.digest);
        describe_quality(ctl_out_document(o), "quality", &t.quality, &f->frame);
        if (!c->json) {
            (void)printf("%s  %s  %u points, quality %.2f%s", t.id, path, t.points,
                         t.quality.score, created ? "" : " (was there already)");
            ctl_face_reasons(stdout, f);
        }
    } else {
        ctl_out_text(o, "error", c->e.msg);
        (void)fprintf(stderr, "surfacectl: %s\n", c->e.msg);
    }
    ctl_out_close(o);
    return st;
}

static int enroll_files(struct ctl *c)
{
    const char *subject = c->args[0];
    struct face_work *w = face_work_new(c->model);
    struct face f = {0};
    struct store *s = NULL;
    int failed = 0, code = EXIT_FINE;
    enum status st;

    if (w == NULL)
        return ctl_fail(c, errinfo_set(&c->e, ST_ENOMEM, "out of memory"));
    if (!store_subject_valid(subject))
        st = errinfo_set(&c->e, ST_EINVAL,
                         "'%.40s' is no subject id: 1 to %d of A-Z a-z 0-9 . _ - @ :",
                         subject, STORE_SUBJECT_MAX);
    else
        st = ctl_model_store(c, STORE_WRITE, &s);
    if (st != ST_OK) {
        code = ctl_fail(c, st);
        goto out;
    }
    ctl_out_text(c->out, "subject", subject);
    ctl_out_array(c->out, "templates");
    for (int i = 1; i < c->nargs; i++) /* one bad scan does not stop the others */
        if ((st = enroll_file(c, s, subject, c->args[i], w, &f)) != ST_OK) {
            failed++;
            code = ctl_fail(c, st);
        }
    ctl_out_close(c->out);
    ctl_out_number(c->out, "failed", failed);
    if (failed > 0)
        (void)errinfo_set(&c->e, c->e.code, "%d of %d scans were not enrolled", failed,
                          c->nargs - 1);
out:
    store_close(s);
    face_free(&f);
    face_work_free(w);
    return code;
}

int ctl_enroll(struct ctl *c)
{
    struct stat sb;

    if (c->nargs == 1) {
        if (stat(c->args[0], &sb) != 0)
            return ctl_usage(c,
                             "it is: surfacectl enroll SUBJECT FILE..., or "
                             "enroll DIR|MANIFEST, and there is no %.80s",
                             c->args[0]);
        return ctl_crowd_enroll(c);
    }
    if (c->kind != NULL || c->threads != 0)
        return ctl_usage(c, "--kind and --threads are for a folder or a table");
    return enroll_files(c);
}
