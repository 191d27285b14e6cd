/* Templates: listed, described, written as a scan, deleted. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "describe.h"
#include "ctl.h"
#include "ctl_dir.h"

#define PAGE 1000 /* subjects read at a time */

void ctl_template_tell(struct ctl *c, const struct store_template *t)
{
    const bool stale = !face_same_engine(t->engine, c->engine);

    describe_template(ctl_out_document(c->out), t, NULL);
    ctl_out_flag(c->out, "stale", stale);
    if (c->json)
        return;
    (void)printf("template  %s\n", t->id);
    (void)printf("  subject   %s\n", t->subject);
    if (t->label[0] != '\0')
        (void)printf("  label     %s\n", t->label);
    (void)printf("  created   %s by %s%s\n", t->created, t->engine,
                 stale ? " (stale)" : "");
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
            ctl_out_object(c->out, NULL);
            ctl_template_tell(c, &t[i]);
            ctl_out_close(c->out);
            continue;
        }
        if (*total == 0 && i == 0)
            (void)printf("%-32s  %-24s  %7s  %7s  %s\n", "TEMPLATE", "CREATED", "POINTS",
                         "QUALITY", "SUBJECT");
        (void)printf("%-32s  %-24s  %7u  %7.2f  %s%s%s%s\n", t[i].id, t[i].created,
                     t[i].points, t[i].quality.score, t[i].subject,
                     t[i].label[0] != '\0' ? "  " : "", t[i].label,
                     face_same_engine(t[i].engine, c->engine) ? "" : "  (stale)");
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

int ctl_template_list(struct ctl *c)
{
    struct store *s = NULL;
    size_t total = 0;
    enum status st = ctl_open(c, STORE_READ, &s);

    ctl_out_array(c->out, "templates");
    if (st == ST_OK)
        st = c->nargs > 0 ? list_one(c, s, c->args[0], &total) : list_all(c, s, &total);
    ctl_out_close(c->out);
    store_close(s);
    if (st != ST_OK)
        return ctl_fail(c, st);
    if (!c->json && total == 0)
        (void)printf("no templates\n");
    return EXIT_FINE;
}

int ctl_template_show(struct ctl *c)
{
    struct store_template t;
    struct store *s = NULL;
    enum status st = ctl_open(c, STORE_READ, &s);

    if (st == ST_OK && (st = store_template_get(s, c->args[0], &t, &c->e)) == ST_OK)
        ctl_template_tell(c, &t);
    store_close(s);
    return st == ST_OK ? EXIT_FINE : ctl_fail(c, st);
}

int ctl_template_export(struct ctl *c)
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
    st = ctl_open(c, STORE_WRITE, &s);
    if (st == ST_OK)
        st = store_template_load(s, c->args[0], &t, w, &f, &c->e);
    if (st == ST_OK) /* before: what leaves the database is in the events in any case */
        st = store_event(s, "export_template", CTL_ACTOR, t.subject, t.id, "written",
                         &c->e);
    if (st == ST_OK && (st = ctl_dir_mesh(c->dir, &f.surface.mesh, &c->e)) == ST_OK) {
        ctl_out_text(c->out, "template_id", t.id);
        ctl_out_text(c->out, "subject", t.subject);
        ctl_out_text(c->out, "file", c->dir);
        ctl_out_number(c->out, "points", t.points);
        ctl_out_number(c->out, "triangles", t.triangles);
        if (!c->json)
            (void)printf("%s: %u points, %u triangles\n", c->dir, t.points, t.triangles);
    }
    store_close(s);
    face_free(&f);
    face_work_free(w);
    return st == ST_OK ? EXIT_FINE : ctl_fail(c, st);
}

int ctl_template_remove(struct ctl *c, struct store *s, const struct store_template *t)
{
    struct store_subject one;
    char what[256];
    enum status st;

    (void)snprintf(what, sizeof what, "deletes template %s of %s", t->id, t->subject);
    if (c->dry_run) {
        st = store_subject_get(s, t->subject, &one, &c->e);
        return st == ST_OK ? ctl_subject_would(c, &one, 1, what) : ctl_fail(c, st);
    }
    if (!ctl_confirmed(c, what, t->id))
        return EXIT_USAGE;
    if ((st = store_template_delete(s, CTL_ACTOR, t->id, &c->e)) != ST_OK)
        return ctl_fail(c, st);
    ctl_out_text(c->out, "template_id", t->id);
    ctl_out_number(c->out, "templates_deleted", 1);
    if (!c->json)
        (void)printf("deleted template %s of %s\n", t->id, t->subject);
    return EXIT_FINE;
}

int ctl_template_delete(struct ctl *c)
{
    struct store_template t;
    struct store *s = NULL;
    enum status st = ctl_open(c, c->dry_run ? STORE_READ : STORE_WRITE, &s);
    int code;

    if (st == ST_OK)
        st = store_template_get(s, c->args[0], &t, &c->e);
    code = st == ST_OK ? ctl_template_remove(c, s, &t) : ctl_fail(c, st);
    store_close(s);
    return code;
}
