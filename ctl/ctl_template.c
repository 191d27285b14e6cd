/* Templates: listed, described, written as a scan, deleted. */
#include "ctl_template.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "describe.h"
#include "ctl_command.h"
#include "ctl_dir.h"
#include "ctl_each.h"
#include "ctl_model.h"

void ctl_template_tell(struct ctl *c, const struct store_template *t)
{
    const bool other = !face_same_engine(t->engine, c->engine);

    describe_template(c->out, t, NULL, true);
    json_flag(c->out, "to_reencode", other);
    ctl_say(c, "template  %s\n", t->id);
    ctl_say(c, "  subject   %s\n", t->subject);
    if (t->label[0] != '\0')
        ctl_say(c, "  label     %s\n", t->label);
    ctl_say(c, "  created   %s by %s%s\n", t->created, t->engine,
            other ? " (to re-encode)" : "");
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

struct listing {
    struct ctl *c;
    size_t n;
};

/* A subject's templates as lines of a list. */
static enum status list_subject(struct listing *l, const char *subject)
{
    struct ctl *c = l->c;
    struct store_template *t = NULL;
    size_t n;
    enum status st = store_template_list(c->store, subject, &t, &n, &c->e);

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
                face_same_engine(t[i].engine, c->engine) ? "" : "  (to re-encode)");
    }
    free(t);
    return st;
}

static enum status list_one(void *arg, const struct store_subject *one, struct errinfo *e)
{
    (void)e;
    return list_subject(arg, one->id);
}

static enum status list(struct ctl *c)
{
    struct listing l = {.c = c};
    enum status st;

    json_array(c->out, "templates");
    st = c->nargs > 0 ? list_subject(&l, c->args[0])
                      : ctl_each_subject(c->store, list_one, &l, &c->e);
    json_close(c->out);
    if (st == ST_OK && l.n == 0)
        ctl_say(c, "no templates\n");
    return st;
}

static enum status show(struct ctl *c)
{
    struct store_template t;
    const enum status st = store_template_get(c->store, c->args[0], &t, &c->e);

    if (st == ST_OK)
        ctl_template_tell(c, &t);
    return st;
}

static enum status export_template(struct ctl *c)
{
    struct store_template t = {.points = 0};
    struct face_work *w;
    struct face f = {0};
    enum status st;

    if (c->dir == NULL)
        return ctl_usage(c, "template export needs --out FILE");
    if ((st = ctl_dir_may_pipe(c, 0)) != ST_OK)
        return st;
    if ((w = face_work_new(c->model)) == NULL)
        return errinfo_set(&c->e, ST_ENOMEM, "out of memory");
    if ((st = ctl_model_open(c, STORE_WRITE)) == ST_OK)
        st = store_template_load(c->store, c->args[0], &t, w, &f, &c->e);
    if (st == ST_OK) /* before: what leaves the database is in the events in any case */
        st = store_event(c->store, "export_template", c->actor, t.subject, t.id,
                         "written", &c->e);
    if (st == ST_OK && (st = ctl_dir_mesh(c, c->dir, &f.surface.mesh)) == ST_OK) {
        json_text(c->out, "template_id", t.id);
        json_text(c->out, "subject", t.subject);
        json_text(c->out, "file", c->dir);
        json_number(c->out, "points", t.points);
        json_number(c->out, "triangles", t.triangles);
        ctl_say(c, "%s: %u points, %u triangles\n", c->dir, t.points, t.triangles);
    }
    face_free(&f);
    face_work_free(w);
    return st;
}

/* ---- the commands */

const struct ctl_command ctl_template_list = {
    .name = "template list",
    .args = "[SUBJECT]",
    .takes = {0, 1},
    .database = CTL_READS_DATABASE,
    .shared = CTL_MODEL,
    .run = list,
    .summary = "list the templates",
    .help =
        "Of one subject, oldest first, or of all subjects.  Those that another engine or model\n"
        "made are marked (template reencode).",
    .example = "surfacectl --db faces.db template list alice"};

const struct ctl_command ctl_template_show = {
    .name = "template show",
    .args = "ID",
    .takes = {1, 1},
    .database = CTL_READS_DATABASE,
    .shared = CTL_MODEL,
    .run = show,
    .summary = "describe a template",
    .help = "Its subject, its age, the engine that made it, and its quality.",
    .example = "surfacectl --db faces.db template show 0123456789abcdef0123456789abcdef"};

const struct ctl_command ctl_template_export = {
    .name = "template export",
    .args = "ID",
    .takes = {1, 1},
    .database = CTL_NEEDS_DATABASE,
    .shared = CTL_MODEL | CTL_OUT | CTL_FORCE,
    .run = export_template,
    .summary = "write a template's points and triangles",
    .help =
        "To the file --out (PLY, millimetres; -: standard output).  It is biometric data: only\n"
        "its owner can read it.  An event records the export.",
    .example =
        "surfacectl --db faces.db template export 0123456789abcdef0123456789abcdef -o a.ply"};
