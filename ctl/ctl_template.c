/* Templates: listed, described, written as a scan, deleted. */
#include "ctl_template.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "describe.h"
#include "ctl_command.h"
#include "ctl_dir.h"
#include "ctl_erase.h"
#include "ctl_key.h"

#define PAGE 1000 /* subjects read at a time */

void ctl_template_tell(struct ctl *c, const struct store_template *t)
{
    const bool other = !face_same_engine(t->engine, c->engine);

    describe_template(c->out, t, NULL);
    json_flag(c->out, "to_reencode", other);
    if (c->json)
        return;
    (void)printf("template  %s\n", t->id);
    (void)printf("  subject   %s\n", t->subject);
    if (t->label[0] != '\0')
        (void)printf("  label     %s\n", t->label);
    (void)printf("  created   %s by %s%s\n", t->created, t->engine,
                 other ? " (to re-encode)" : "");
    (void)printf("  points    %u, %u triangles, %.2f mm apart\n", t->points, t->triangles,
                 t->quality.density_mm);
    (void)printf("  quality   %.2f (coverage %.0f %%, noise %.3f mm)\n", t->quality.score,
                 100 * t->quality.coverage, t->quality.noise_mm);
    (void)printf("  digest    %s\n", t->digest);
}

/* A subject's templates as lines of a list; *total counts them. */
static enum status list_one(struct ctl *c, struct store *s, const char *subject,
                            size_t *total)
{
    struct store_template *t = NULL;
    size_t n;
    enum status st = store_template_list(s, subject, &t, &n, &c->e);

    for (size_t i = 0; st == ST_OK && i < n; i++) {
        if (c->json) {
            json_object(c->out, NULL);
            ctl_template_tell(c, &t[i]);
            json_close(c->out);
            continue;
        }
        if (*total == 0 && i == 0)
            (void)printf("%-32s  %-24s  %7s  %7s  %s\n", "TEMPLATE", "CREATED", "POINTS",
                         "QUALITY", "SUBJECT");
        (void)printf("%-32s  %-24s  %7u  %7.2f  %s%s%s%s\n", t[i].id, t[i].created,
                     t[i].points, t[i].quality.score, t[i].subject,
                     t[i].label[0] != '\0' ? "  " : "", t[i].label,
                     face_same_engine(t[i].engine, c->engine) ? "" : "  (to re-encode)");
    }
    if (st == ST_OK)
        *total += n;
    free(t);
    return st;
}

static enum status list_all(struct ctl *c, struct store *s, size_t *total)
{
    struct store_subject *page = NULL;
    int64_t after = 0;
    size_t n = 0;
    enum status st;

    while ((st = store_subject_list(s, after, PAGE, &page, &n, &c->e)) == ST_OK &&
           n > 0) {
        for (size_t i = 0; st == ST_OK && i < n; i++)
            if ((st = list_one(c, s, page[i].id, total)) == ST_ENOTFOUND)
                st = ST_OK; /* deleted since it was listed */
        after = page[n - 1].key;
        free(page);
        if (st != ST_OK)
            break;
    }
    return st;
}

static enum status list(struct ctl *c, struct store *s)
{
    size_t total = 0;
    enum status st;

    json_array(c->out, "templates");
    st = c->nargs > 0 ? list_one(c, s, c->args[0], &total) : list_all(c, s, &total);
    json_close(c->out);
    if (st == ST_OK && !c->json && total == 0)
        (void)printf("no templates\n");
    return st;
}

static enum status show(struct ctl *c, struct store *s)
{
    struct store_template t;
    const enum status st = store_template_get(s, c->args[0], &t, &c->e);

    if (st == ST_OK)
        ctl_template_tell(c, &t);
    return st;
}

static int run_export(struct ctl *c)
{
    struct store_template t;
    struct store *s = NULL;
    struct face_work *w;
    struct face f = {0};
    enum status st;

    if (c->dir == NULL)
        return ctl_usage(c, "template export needs --out FILE");
    if ((w = face_work_new(c->model)) == NULL)
        return ctl_fail(c, errinfo_set(&c->e, ST_ENOMEM, "out of memory"));
    st = ctl_key_open(c, STORE_WRITE, &s);
    if (st == ST_OK)
        st = store_template_load(s, c->args[0], &t, w, &f, &c->e);
    if (st == ST_OK) /* before: what leaves the database is in the events in any case */
        st = store_event(s, "export_template", CTL_ACTOR, t.subject, t.id, "written",
                         &c->e);
    if (st == ST_OK && (st = ctl_dir_mesh(c->dir, &f.surface.mesh, &c->e)) == ST_OK) {
        json_text(c->out, "template_id", t.id);
        json_text(c->out, "subject", t.subject);
        json_text(c->out, "file", c->dir);
        json_number(c->out, "points", t.points);
        json_number(c->out, "triangles", t.triangles);
        ctl_say(c, "%s: %u points, %u triangles\n", c->dir, t.points, t.triangles);
    }
    store_close(s);
    face_free(&f);
    face_work_free(w);
    return st == ST_OK ? EXIT_FINE : ctl_fail(c, st);
}

static int delete_one(struct ctl *c, struct store *s, const struct store_template *t)
{
    struct store_subject one;
    char what[256];
    enum status st;

    (void)snprintf(what, sizeof what, "deletes template %s of %s", t->id, t->subject);
    if (c->dry_run) {
        st = store_subject_get(s, t->subject, &one, &c->e);
        return st == ST_OK ? ctl_erase_would(c, &one, 1, what) : ctl_fail(c, st);
    }
    if (!ctl_confirmed(c, what, t->id))
        return EXIT_USAGE;
    if ((st = store_template_delete(s, CTL_ACTOR, t->id, &c->e)) != ST_OK)
        return ctl_fail(c, st);
    json_text(c->out, "template_id", t->id);
    json_number(c->out, "templates_removed", 1);
    ctl_say(c, "deleted template %s of %s\n", t->id, t->subject);
    return EXIT_FINE;
}

static int run_delete(struct ctl *c)
{
    struct store_template t;
    struct store *s = NULL;
    enum status st = ctl_key_open(c, c->dry_run ? STORE_READ : STORE_WRITE, &s);
    int code;

    if (st == ST_OK)
        st = store_template_get(s, c->args[0], &t, &c->e);
    code = st == ST_OK ? delete_one(c, s, &t) : ctl_fail(c, st);
    store_close(s);
    return code;
}

/* ---- the commands */

const struct ctl_command ctl_template_list = {
    .name = "template list",
    .args = "[SUBJECT]",
    .takes = {0, 1},
    .database = CTL_NEEDS_DATABASE,
    .shared = CTL_MODEL,
    .work = list,
    .mode = STORE_READ,
    .summary = "list the templates",
    .help =
        "Of one subject, oldest first, or of all subjects.  Those that another engine or model\n"
        "made are marked (template reencode).",
    .example = "surfacectl --db faces.db template list alice"};

const struct ctl_command ctl_template_show = {
    .name = "template show",
    .args = "ID",
    .takes = {1, 1},
    .database = CTL_NEEDS_DATABASE,
    .shared = CTL_MODEL,
    .work = show,
    .mode = STORE_READ,
    .summary = "describe a template",
    .help = "Its subject, its age, the engine that made it, and its quality.",
    .example = "surfacectl --db faces.db template show 0123456789abcdef0123456789abcdef"};

const struct ctl_command ctl_template_export = {
    .name = "template export",
    .args = "ID",
    .takes = {1, 1},
    .database = CTL_NEEDS_DATABASE,
    .shared = CTL_MODEL | CTL_OUT,
    .run = run_export,
    .summary = "write a template's points and triangles",
    .help =
        "To the file --out (PLY, millimetres).  It is biometric data: only its owner can read\n"
        "it.  An event records the export.",
    .example =
        "surfacectl --db faces.db template export 0123456789abcdef0123456789abcdef -o a.ply"};

const struct ctl_command ctl_template_delete = {
    .name = "template delete",
    .args = "ID",
    .takes = {1, 1},
    .database = CTL_NEEDS_DATABASE,
    .shared = CTL_DRY_RUN | CTL_YES,
    .run = run_delete,
    .summary = "delete one template",
    .help = "On a terminal the id has to be typed again; elsewhere --yes is required.",
    .example =
        "surfacectl --db faces.db template delete 0123456789abcdef0123456789abcdef --yes"};
