#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "surfacectl.h"

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
            st = surfacectl_subject_tell(c, s, &one);
        else
            surfacectl_template_tell(c, &t);
    }
    store_close(s);
    return st == ST_OK ? EXIT_FINE : surfacectl_fail(c, st);
}

int surfacectl_admin_delete(struct surfacectl *c)
{
    struct store_subject one;
    struct store_template t;
    struct store *s = NULL;
    bool subject = false;
    enum status st = surfacectl_open(c, c->dry_run ? STORE_READ : STORE_WRITE, &s);
    int code;

    if (st == ST_OK)
        st = find(c, s, c->args[0], &one, &t, &subject);
    if (st != ST_OK)
        code = surfacectl_fail(c, st);
    else
        code = subject ? surfacectl_subject_remove(c, s, &one)
                       : surfacectl_template_remove(c, s, &t);
    store_close(s);
    return code;
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
    surfacectl_out_number(c->out, "events", (double)found.events);
    surfacectl_out_flag(c->out, "ok", found.problems == 0);
    if (!c->json)
        (void)printf(
            "%s: %llu templates, %llu bad; %llu events; %llu problems in all\n",
            found.problems == 0 ? "ok" : "NOT ok", (unsigned long long)found.templates,
            (unsigned long long)found.bad_templates, (unsigned long long)found.events,
            (unsigned long long)found.problems);
    return found.problems == 0 ? EXIT_FINE : EXIT_NO;
}

int surfacectl_admin_stats(struct surfacectl *c)
{
    struct store_stats t;
    struct store *s = NULL;
    char text[32];
    uint64_t stale = 0;
    enum status st = surfacectl_open(c, STORE_READ, &s);

    if (st == ST_OK) {
        store_use_model(s, c->model);
        if ((st = store_stats(s, &t, &c->e)) == ST_OK)
            st = store_renew_count(s, &stale, &c->e);
    }
    store_close(s);
    if (st != ST_OK)
        return surfacectl_fail(c, st);
    surfacectl_out_number(c->out, "subjects", (double)t.subjects);
    surfacectl_out_number(c->out, "templates", (double)t.templates);
    surfacectl_out_number(c->out, "stale", (double)stale);
    surfacectl_out_number(c->out, "points", (double)t.points);
    surfacectl_out_number(c->out, "template_bytes", (double)t.template_bytes);
    surfacectl_out_number(c->out, "file_bytes", (double)t.file_bytes);
    surfacectl_out_number(c->out, "events", (double)t.events);
    surfacectl_out_number(c->out, "tokens", (double)t.tokens);
    surfacectl_out_number(c->out, "schema", t.schema);
    if (c->json)
        return EXIT_FINE;
    (void)printf("subjects     %llu\n", (unsigned long long)t.subjects);
    (void)printf("templates    %llu", (unsigned long long)t.templates);
    if (stale > 0)
        (void)printf(", %llu by another engine (template reprocess)",
                     (unsigned long long)stale);
    (void)printf("\n");
    (void)printf("points       %llu\n", (unsigned long long)t.points);
    (void)printf("models       %s\n", surfacectl_bytes(t.template_bytes, text));
    (void)printf("file         %s\n", surfacectl_bytes(t.file_bytes, text));
    if (t.points > 0)
        (void)printf("per point    %.1f bytes of model, %.1f of file\n",
                     (double)t.template_bytes / (double)t.points,
                     (double)t.file_bytes / (double)t.points);
    (void)printf("events       %llu\n", (unsigned long long)t.events);
    (void)printf("tokens       %llu\n", (unsigned long long)t.tokens);
    (void)printf("schema       %u\n", t.schema);
    return EXIT_FINE;
}

int surfacectl_admin_vacuum(struct surfacectl *c)
{
    struct store_stats before, after;
    struct store *s = NULL;
    char was[32], is[32];
    enum status st = surfacectl_open(c, STORE_WRITE, &s);

    if (st == ST_OK && (st = store_stats(s, &before, &c->e)) == ST_OK &&
        (st = store_vacuum(s, &c->e)) == ST_OK)
        st = store_stats(s, &after, &c->e);
    store_close(s);
    if (st != ST_OK)
        return surfacectl_fail(c, st);
    surfacectl_out_number(c->out, "bytes_before", (double)before.file_bytes);
    surfacectl_out_number(c->out, "bytes_after", (double)after.file_bytes);
    if (!c->json)
        (void)printf("%s: %s before, %s now\n", c->db,
                     surfacectl_bytes(before.file_bytes, was),
                     surfacectl_bytes(after.file_bytes, is));
    return EXIT_FINE;
}
