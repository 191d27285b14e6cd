/* surfacectl explain: why a comparison was decided as it was. */
#include <math.h>
#include <unistd.h>

#include "ctl_command.h"
#include "ctl_dir.h"
#include "ctl_face.h"
#include "ctl_model.h"
#include "cloudpoints.h"
#include "ctl_sample.h"
#include "explain.h"
#include "explain_cloud.h"
#include "explain_plot.h"
#include "explain_text.h"

/* A from the database: the template of a subject that decides, or the template named.
 * *none: there is neither. */
static enum status template_stored(struct ctl *c, struct explanation *x,
                                   struct store_template *t, bool *none)
{
    struct ctl_nearest best;
    enum status st = ctl_model_open(c, STORE_WRITE);

    if (st != ST_OK)
        return st;
    st = ctl_face_nearest(c, &(struct templates_of){.subject = x->a}, &x->probe, &best);
    if (st == ST_ENOTFOUND && ident_id_valid(x->a))
        st = ctl_face_nearest(c, &(struct templates_of){.template_id = x->a}, &x->probe,
                              &best);
    *none = st == ST_ENOTFOUND;
    if (st == ST_OK) {
        x->compared = best.nearest.compared;
        x->result = best.nearest.result;
        x->minimal = best.minimal;
        st = store_template_load(c->store, best.tmpl.id, t, c->work, &x->tmpl, &c->e);
        x->subject = t->subject;
        x->template_id = t->id;
    }
    if (st == ST_OK)
        st = store_event(c->store, "explain", c->actor, t->subject, t->id,
                         templates_decision(x->result.decision), &c->e);
    return st;
}

static enum status compare(struct ctl *c, struct explanation *x, struct store_template *t)
{
    bool scan = true; /* A is one */
    struct scan_found found;
    struct cloudpoints p;
    enum status st = ctl_sample_parse(c, x->b, &p);

    if (st == ST_OK)
        st = ctl_sample_build(c, x->b, &p, false, c->work, &x->probe, &found);
    x->pts = p.at;
    x->n = p.n;
    p.at = NULL; /* it is x's */
    cloudpoints_free(&p);
    if (st == ST_OK && c->db != NULL && ident_subject_valid(x->a)) {
        bool none = false;

        st = template_stored(c, x, t, &none);
        scan = none && access(x->a, F_OK) == 0;
        st = scan ? ST_OK : st;
    }
    if (st == ST_OK && scan) {
        st = ctl_sample_read(c, x->a, false, c->work, &x->tmpl, &found);
        if (st == ST_OK)
            st =
                face_compare(&x->tmpl, &x->probe, (double)NAN, NULL, c->work, &x->result);
        if (st == ST_OK)
            st =
                face_minimal(&x->tmpl, &x->probe, NULL, c->work, &x->result, &x->minimal);
        if (st == ST_OK)
            st = face_weigh(&x->tmpl, &x->probe, c->work, &x->minimal);
        if (st == ST_OK)
            st = face_regions(&x->tmpl, &x->probe, c->work, &x->result);
    }
    if (st == ST_OK)
        st = explain_fields(x, c->work);
    if (st != ST_OK && c->e.msg[0] == '\0')
        (void)errinfo_set(&c->e, st, "comparing: %s", status_message(st));
    return st;
}

static const struct {
    const char *name;
    enum status (*write)(FILE *to, const void *x, struct errinfo *e);
    bool picture;
} file[] = {{"explain.txt", explain_text, false},
            {"explain.json", explain_text_json, false},
            {"explain.ply", explain_cloud, false},
            {"explain.png", explain_plot, true}};
#define FILES (sizeof file / sizeof *file)

static enum status may_write_all(struct ctl *c, const char *folder)
{
    char path[PATH_MAX];
    enum status st = ST_OK;

    for (size_t i = 0; st == ST_OK && i < FILES; i++) {
        (void)snprintf(path, sizeof path, "%s/%s", folder, file[i].name);
        st = ctl_dir_may_write(c, path, c->nargs);
    }
    return st;
}

/* Every file, or as many as there can be: without gnuplot no picture, which is no failure.
 * *picture: is it there? */
static enum status write_all(struct ctl *c, const struct explanation *x, const char *path,
                             bool *picture)
{
    int dir;
    enum status st = ctl_dir_open(path, &dir, &c->e);

    /* What an earlier comparison left must not stand beside this one's. */
    for (size_t i = 0; st == ST_OK && c->force && i < FILES; i++)
        st = ctl_dir_remove(dir, file[i].name, &c->e);
    *picture = true;
    for (size_t i = 0; st == ST_OK && i < FILES; i++) {
        st = ctl_dir_write(dir, file[i].name, c->force, file[i].write, x, &c->e);
        if (st == ST_ENOTFOUND && file[i].picture) {
            *picture = false;
            st = ST_OK;
        } else if (st == ST_EINVAL) {
            st = ST_EINTERNAL; /* the script that gnuplot refused is this program's */
        }
    }
    if (dir >= 0)
        (void)close(dir);
    return st;
}

static enum status run(struct ctl *c)
{
    const char *path;
    struct explanation x = {
        .a = c->args[0], .b = c->args[1], .engine = c->engine, .compared = 1};
    struct store_template t = {0};
    bool picture = false;
    enum status st = ctl_dir_folder(c, "explanation", &path);

    if (st != ST_OK || (st = may_write_all(c, path)) != ST_OK)
        return st;
    if ((st = compare(c, &x, &t)) == ST_OK)
        st = write_all(c, &x, path, &picture);
    if (st == ST_OK) {
        explain_text_out(c->out, &x);
        json_text(c->out, "directory", path);
        json_flag(c->out, "picture", picture);
        if (!c->json) {
            (void)explain_text(stdout, &x, NULL);
            (void)printf("written to   %s\n", path);
        }
        if (!picture)
            (void)fprintf(stderr, "surfacectl: no picture: %s\n", c->e.msg);
    }
    explain_free(&x);
    c->code = ctl_face_exit(x.result.decision);
    return st;
}

const struct ctl_command ctl_explain = {
    .name = "explain",
    .args = "A B",
    .takes = {2, 2},
    .database = CTL_TAKES_DATABASE,
    .shared = CTL_SCANS | CTL_MODEL | CTL_OUT | CTL_FORCE,
    .exits = {"match", "no match", CTL_INCONCLUSIVE},
    .run = run,
    .summary = "compare two scans and show where they differ",
    .help =
        "B is moved onto A.  A is a subject or a template of the database, where one is named\n"
        "and has it, or else a scan (./FILE is always a scan).\n"
        "These files are written into the folder --out (./explanation): explain.txt and\n"
        "explain.json, explain.ply (the points of B), and by gnuplot explain.png: the gap as\n"
        "measured beside what decided.  They are biometric data: only their owner can read them.",
    .example = "surfacectl explain monday.ply tuesday.ply --out why"};
