#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "surfacectl.h"

#define PAGE 1000 /* subjects read at a time */

/* The file of a key that was made, or NULL: it is told where it is, since what it opens is
 * lost without it. */
static void tell_key(struct surfacectl *c, const char *path, bool made)
{
    surfacectl_out_text(c->out, "key", path);
    if (made && !c->json)
        (void)printf(
            "The key is in %s: keep a copy of it elsewhere.  Without it nothing in "
            "the database can be read.\n",
            path);
}

/* Make or upgrade; the key's file is new where there was none before. */
static enum status open_new(struct surfacectl *c, enum store_mode mode, const char *word)
{
    struct store *s = NULL;
    char usual[PATH_MAX];
    const char *path = c->key != NULL ? c->key : usual;
    bool there;
    enum status st;

    if (c->plaintext && c->key != NULL)
        return errinfo_set(&c->e, ST_EINVAL, "--plaintext takes no key");
    (void)snprintf(usual, sizeof usual, "%s.key", c->db);
    there = access(path, F_OK) == 0;
    if ((st = surfacectl_open(c, mode, &s)) != ST_OK)
        return st;
    store_close(s);
    surfacectl_out_text(c->out, "database", c->db);
    if (!c->json)
        (void)printf("%s: %s\n", c->db, word);
    if (access(path, F_OK) == 0)
        tell_key(c, path, !there);
    return ST_OK;
}

int surfacectl_admin_init(struct surfacectl *c)
{
    enum vault_kind kind;
    const bool there = store_kind(c->db, &kind, NULL) == ST_OK;
    const enum status st =
        open_new(c, STORE_CREATE, there ? "was initialised before" : "initialised");

    if (st != ST_OK)
        return surfacectl_fail(c, st);
    surfacectl_out_flag(c->out, "created", !there);
    return EXIT_FINE;
}

/* What an upgrade would do. */
static int migrate_dry(struct surfacectl *c, const struct store_look *l, bool old)
{
    surfacectl_out_flag(c->out, "upgraded", false);
    surfacectl_out_flag(c->out, "would_upgrade", old);
    surfacectl_out_number(c->out, "schema", l->version);
    surfacectl_out_number(c->out, "subjects", (double)l->subjects);
    surfacectl_out_number(c->out, "templates", (double)l->templates);
    if (!c->json && old)
        (void)printf(
            "%s: schema version %d, would be upgraded to %d: %llu subjects, %llu "
            "templates; the old one would be kept as %s.v%d.bak\n",
            c->db, l->version, l->newest, (unsigned long long)l->subjects,
            (unsigned long long)l->templates, c->db, l->version);
    else if (!c->json)
        (void)printf("%s: is of this version\n", c->db);
    return EXIT_FINE;
}

int surfacectl_admin_migrate(struct surfacectl *c)
{
    struct store_look l;
    char backup[PATH_MAX];
    bool old;
    enum status st = store_look(c->db, &l, &c->e);

    if (st != ST_OK)
        return surfacectl_fail(c, st);
    old = l.version > 0 && l.version < l.newest;
    if (c->dry_run)
        return migrate_dry(c, &l, old);
    st = open_new(c, STORE_MIGRATE,
                  old ? "upgraded to this version" : "is of this version");
    if (st != ST_OK)
        return surfacectl_fail(c, st);
    surfacectl_out_flag(c->out, "upgraded", old);
    if (old) {
        (void)snprintf(backup, sizeof backup, "%s.v%d.bak", c->db, l.version);
        surfacectl_out_text(c->out, "backup", backup);
        if (!c->json)
            (void)printf(
                "The old database is %s.  What stood open in it still does there: "
                "delete it when all is well.\n",
                backup);
    }
    return EXIT_FINE;
}

int surfacectl_admin_list(struct surfacectl *c)
{
    struct store_subject *page = NULL;
    struct store *s = NULL;
    int64_t after = 0;
    size_t n = 0, total = 0;
    enum status st = surfacectl_open(c, STORE_READ, &s);

    if (st != ST_OK)
        return surfacectl_fail(c, st);
    surfacectl_out_array(c->out, "subjects");
    while ((st = store_subject_list(s, after, PAGE, &page, &n, &c->e)) == ST_OK &&
           n > 0) {
        if (!c->json && total == 0)
            (void)printf("%-32s %9s  %s\n", "SUBJECT", "TEMPLATES", "CREATED");
        for (size_t i = 0; i < n; i++) {
            surfacectl_out_object(c->out, NULL);
            surfacectl_out_text(c->out, "subject", page[i].id);
            surfacectl_out_number(c->out, "templates", page[i].templates);
            surfacectl_out_text(c->out, "created", page[i].created);
            surfacectl_out_close(c->out);
            if (!c->json)
                (void)printf("%-32s %9u  %s\n", page[i].id, page[i].templates,
                             page[i].created);
        }
        total += n;
        after = page[n - 1].key;
        free(page);
    }
    surfacectl_out_close(c->out);
    store_close(s);
    if (st != ST_OK)
        return surfacectl_fail(c, st);
    if (!c->json && total == 0)
        (void)printf("no subjects\n");
    return EXIT_FINE;
}

static void show_template(struct surfacectl *c, const struct store_template *t)
{
    surfacectl_out_text(c->out, "template_id", t->id);
    surfacectl_out_text(c->out, "subject", t->subject);
    surfacectl_out_text(c->out, "label", t->label);
    surfacectl_out_text(c->out, "created", t->created);
    surfacectl_out_number(c->out, "points", t->points);
    surfacectl_out_number(c->out, "triangles", t->triangles);
    surfacectl_out_text(c->out, "digest", t->digest);
    surfacectl_out_object(c->out, "quality");
    surfacectl_out_number(c->out, "score", t->quality.score);
    surfacectl_out_number(c->out, "coverage", t->quality.coverage);
    surfacectl_out_number(c->out, "density_mm", t->quality.density_mm);
    surfacectl_out_number(c->out, "noise_mm", t->quality.noise_mm);
    surfacectl_out_close(c->out);
    surfacectl_out_text(c->out, "engine", t->engine);
    if (c->json)
        return;
    (void)printf("template  %s\n", t->id);
    (void)printf("  subject   %s\n", t->subject);
    if (t->label[0] != '\0')
        (void)printf("  label     %s\n", t->label);
    (void)printf("  created   %s by %s\n", t->created, t->engine);
    (void)printf("  points    %u, %u triangles, %.2f mm apart\n", t->points, t->triangles,
                 t->quality.density_mm);
    (void)printf("  quality   %.2f (coverage %.0f %%, noise %.3f mm)\n", t->quality.score,
                 100 * t->quality.coverage, t->quality.noise_mm);
    (void)printf("  digest    %s\n", t->digest);
}

static enum status show_subject(struct surfacectl *c, struct store *s,
                                const struct store_subject *one)
{
    struct store_template *list;
    size_t n;
    enum status st = store_template_list(s, one->id, &list, &n, &c->e);

    if (st != ST_OK)
        return st;
    surfacectl_out_text(c->out, "subject", one->id);
    surfacectl_out_text(c->out, "created", one->created);
    surfacectl_out_array(c->out, "templates");
    if (!c->json)
        (void)printf("subject   %s, since %s, %zu template%s\n", one->id, one->created, n,
                     n == 1 ? "" : "s");
    for (size_t i = 0; i < n; i++) {
        surfacectl_out_object(c->out, NULL);
        show_template(c, &list[i]);
        surfacectl_out_close(c->out);
    }
    surfacectl_out_close(c->out);
    free(list);
    return ST_OK;
}

/* What an id names: a subject (one is filled), else a template (t is). */
static enum status find(struct surfacectl *c, struct store *s, const char *id,
                        struct store_subject *one, struct store_template *t,
                        bool *subject)
{
    enum status st = ST_ENOTFOUND;

    *subject = false;
    if (store_subject_valid(id))
        st = store_subject_get(s, id, one, &c->e);
    if (st == ST_OK)
        *subject = true;
    else if (st == ST_ENOTFOUND && store_id_valid(id))
        st = store_template_get(s, id, t, &c->e);
    if (st == ST_ENOTFOUND)
        (void)errinfo_set(&c->e, st, "there is no subject or template %.128s", id);
    return st;
}

int surfacectl_admin_show(struct surfacectl *c)
{
    struct store_subject one;
    struct store_template t;
    struct store *s = NULL;
    bool subject;
    enum status st = surfacectl_open(c, STORE_READ, &s);

    if (st == ST_OK && (st = find(c, s, c->args[0], &one, &t, &subject)) == ST_OK) {
        if (subject)
            st = show_subject(c, s, &one);
        else
            show_template(c, &t);
    }
    store_close(s);
    return st == ST_OK ? EXIT_FINE : surfacectl_fail(c, st);
}

/* Ask a person, on a terminal, to type the id again. */
static bool confirmed(const struct surfacectl *c, const char *what)
{
    char line[STORE_SUBJECT_MAX + 8];
    size_t n;

    if (c->yes)
        return true;
    if (!isatty(STDIN_FILENO))
        return false;
    (void)fprintf(stderr, "This deletes %s for good.\nType the id to go on: ", what);
    if (fgets(line, sizeof line, stdin) == NULL)
        return false;
    n = strcspn(line, "\r\n");
    line[n] = '\0';
    return strcmp(line, c->args[0]) == 0;
}

int surfacectl_admin_delete(struct surfacectl *c)
{
    const char *id = c->args[0];
    struct store_subject one;
    struct store_template t;
    struct store *s = NULL;
    uint32_t removed = 1;
    bool subject = false;
    char what[256];
    enum status st = surfacectl_open(c, STORE_WRITE, &s);

    if (st != ST_OK || (st = find(c, s, id, &one, &t, &subject)) != ST_OK)
        goto out;
    if (subject)
        (void)snprintf(what, sizeof what, "subject %s with %u template%s", id,
                       one.templates, one.templates == 1 ? "" : "s");
    else
        (void)snprintf(what, sizeof what, "template %s of %s", id, t.subject);
    if (!confirmed(c, what)) {
        store_close(s);
        (void)errinfo_set(&c->e, ST_EDENIED,
                          "nothing was deleted: %s needs --yes, or the id "
                          "typed on a terminal",
                          what);
        return EXIT_USAGE;
    }
    st = subject ? store_subject_delete(s, SURFACECTL_ACTOR, id, &removed, &c->e)
                 : store_template_delete(s, SURFACECTL_ACTOR, id, &c->e);
    if (st == ST_OK) {
        surfacectl_out_text(c->out, subject ? "subject" : "template_id", id);
        surfacectl_out_number(c->out, "templates_deleted", removed);
        if (!c->json)
            (void)printf("deleted %s\n", what);
    }
out:
    store_close(s);
    return st == ST_OK ? EXIT_FINE : surfacectl_fail(c, st);
}

static void report(void *arg, const char *line)
{
    const struct surfacectl *c = arg;

    surfacectl_out_text(c->out, NULL, line);
    if (!c->json)
        (void)printf("%s\n", line);
}

int surfacectl_admin_check(struct surfacectl *c)
{
    struct store_check found;
    struct store *s = NULL;
    enum status st = surfacectl_open(c, STORE_READ, &s);

    surfacectl_out_array(c->out, "problems");
    if (st == ST_OK)
        st = store_check(s, report, c, &found, &c->e);
    surfacectl_out_close(c->out);
    store_close(s);
    if (st != ST_OK)
        return surfacectl_fail(c, st);
    surfacectl_out_number(c->out, "templates", (double)found.templates);
    surfacectl_out_number(c->out, "bad_templates", (double)found.bad_templates);
    surfacectl_out_flag(c->out, "ok", found.problems == 0);
    if (!c->json)
        (void)printf(
            "%s: %llu templates, %llu bad, %llu problems in all\n",
            found.problems == 0 ? "ok" : "NOT ok", (unsigned long long)found.templates,
            (unsigned long long)found.bad_templates, (unsigned long long)found.problems);
    return found.problems == 0 ? EXIT_FINE : EXIT_NO;
}

static void print_bytes(const char *name, uint64_t n)
{
    static const char *const unit[] = {"bytes", "kB", "MB", "GB", "TB"};
    double v = (double)n;
    int i = 0;

    for (; v >= 1000 && i < 4; i++)
        v /= 1000;
    (void)printf("%-12s %.*f %s\n", name, i == 0 ? 0 : 1, v, unit[i]);
}

int surfacectl_admin_stats(struct surfacectl *c)
{
    struct store_stats t;
    struct store *s = NULL;
    enum status st = surfacectl_open(c, STORE_READ, &s);

    if (st == ST_OK)
        st = store_stats(s, &t, &c->e);
    store_close(s);
    if (st != ST_OK)
        return surfacectl_fail(c, st);
    surfacectl_out_number(c->out, "subjects", (double)t.subjects);
    surfacectl_out_number(c->out, "templates", (double)t.templates);
    surfacectl_out_number(c->out, "points", (double)t.points);
    surfacectl_out_number(c->out, "template_bytes", (double)t.template_bytes);
    surfacectl_out_number(c->out, "file_bytes", (double)t.file_bytes);
    surfacectl_out_number(c->out, "events", (double)t.events);
    surfacectl_out_number(c->out, "tokens", (double)t.tokens);
    surfacectl_out_number(c->out, "schema", t.schema);
    if (c->json)
        return EXIT_FINE;
    (void)printf("subjects     %llu\n", (unsigned long long)t.subjects);
    (void)printf("templates    %llu\n", (unsigned long long)t.templates);
    (void)printf("points       %llu\n", (unsigned long long)t.points);
    print_bytes("models", t.template_bytes);
    print_bytes("file", t.file_bytes);
    if (t.points > 0)
        (void)printf("per point    %.1f bytes of model, %.1f of file\n",
                     (double)t.template_bytes / (double)t.points,
                     (double)t.file_bytes / (double)t.points);
    (void)printf("events       %llu\n", (unsigned long long)t.events);
    (void)printf("tokens       %llu\n", (unsigned long long)t.tokens);
    (void)printf("schema       %u\n", t.schema);
    return EXIT_FINE;
}
