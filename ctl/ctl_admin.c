#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "ctl.h"

/* The file of a key that was made, or NULL: it is told where it is, since what it opens is
 * lost without it. */
static void tell_key(struct ctl *c, const char *path, bool made)
{
    ctl_out_text(c->out, "key", path);
    if (made && !c->json)
        (void)printf(
            "The key is in %s: keep a copy of it elsewhere.  Without it nothing in "
            "the database can be read.\n",
            path);
}

/* Make or upgrade; the key's file is new where there was none before. */
static enum status open_new(struct ctl *c, enum store_mode mode, const char *word)
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
    if ((st = ctl_open(c, mode, &s)) != ST_OK)
        return st;
    store_close(s);
    ctl_out_text(c->out, "database", c->db);
    if (!c->json)
        (void)printf("%s: %s\n", c->db, word);
    if (access(path, F_OK) == 0)
        tell_key(c, path, !there);
    return ST_OK;
}

int ctl_admin_init(struct ctl *c)
{
    enum vault_kind kind;
    const bool there = store_kind(c->db, &kind, NULL) == ST_OK;
    const enum status st =
        open_new(c, STORE_CREATE, there ? "was initialised before" : "initialised");

    if (st != ST_OK)
        return ctl_fail(c, st);
    ctl_out_flag(c->out, "created", !there);
    return EXIT_FINE;
}

/* What an upgrade would do. */
static int migrate_dry(struct ctl *c, const struct store_look *l, bool old)
{
    ctl_out_flag(c->out, "upgraded", false);
    ctl_out_flag(c->out, "would_upgrade", old);
    ctl_out_number(c->out, "schema", l->version);
    ctl_out_number(c->out, "subjects", (double)l->subjects);
    ctl_out_number(c->out, "templates", (double)l->templates);
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

int ctl_admin_migrate(struct ctl *c)
{
    struct store_look l;
    char backup[PATH_MAX];
    bool old;
    enum status st = store_look(c->db, &l, &c->e);

    if (st != ST_OK)
        return ctl_fail(c, st);
    old = l.version > 0 && l.version < l.newest;
    if (c->dry_run)
        return migrate_dry(c, &l, old);
    st = open_new(c, STORE_MIGRATE,
                  old ? "upgraded to this version" : "is of this version");
    if (st != ST_OK)
        return ctl_fail(c, st);
    ctl_out_flag(c->out, "upgraded", old);
    if (old) {
        (void)snprintf(backup, sizeof backup, "%s.v%d.bak", c->db, l.version);
        ctl_out_text(c->out, "backup", backup);
        if (!c->json)
            (void)printf(
                "The old database is %s.  What stood open in it still does there: "
                "delete it when all is well.\n",
                backup);
    }
    return EXIT_FINE;
}

/* What an id names: a subject (one is filled), else a template (t is). */
static enum status find(struct ctl *c, struct store *s, const char *id,
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

int ctl_admin_show(struct ctl *c)
{
    struct store_subject one;
    struct store_template t;
    struct store *s = NULL;
    bool subject;
    enum status st = ctl_open(c, STORE_READ, &s);

    if (st == ST_OK && (st = find(c, s, c->args[0], &one, &t, &subject)) == ST_OK) {
        if (subject)
            st = ctl_subject_tell(c, s, &one);
        else
            ctl_template_tell(c, &t);
    }
    store_close(s);
    return st == ST_OK ? EXIT_FINE : ctl_fail(c, st);
}

int ctl_admin_delete(struct ctl *c)
{
    struct store_subject one;
    struct store_template t;
    struct store *s = NULL;
    bool subject = false;
    enum status st = ctl_open(c, c->dry_run ? STORE_READ : STORE_WRITE, &s);
    int code;

    if (st == ST_OK)
        st = find(c, s, c->args[0], &one, &t, &subject);
    if (st != ST_OK)
        code = ctl_fail(c, st);
    else
        code = subject ? ctl_subject_remove(c, s, &one) : ctl_template_remove(c, s, &t);
    store_close(s);
    return code;
}

static void report(void *arg, const char *line)
{
    const struct ctl *c = arg;

    ctl_out_text(c->out, NULL, line);
    if (!c->json)
        (void)printf("%s\n", line);
}

int ctl_admin_check(struct ctl *c)
{
    struct store_check found;
    struct store *s = NULL;
    enum status st = ctl_open(c, STORE_READ, &s);

    ctl_out_array(c->out, "problems");
    if (st == ST_OK)
        st = store_check(s, report, c, &found, &c->e);
    ctl_out_close(c->out);
    store_close(s);
    if (st != ST_OK)
        return ctl_fail(c, st);
    ctl_out_number(c->out, "templates", (double)found.templates);
    ctl_out_number(c->out, "bad_templates", (double)found.bad_templates);
    ctl_out_number(c->out, "events", (double)found.events);
    ctl_out_flag(c->out, "ok", found.problems == 0);
    if (!c->json)
        (void)printf(
            "%s: %llu templates, %llu bad; %llu events; %llu problems in all\n",
            found.problems == 0 ? "ok" : "NOT ok", (unsigned long long)found.templates,
            (unsigned long long)found.bad_templates, (unsigned long long)found.events,
            (unsigned long long)found.problems);
    return found.problems == 0 ? EXIT_FINE : EXIT_NO;
}

int ctl_admin_stats(struct ctl *c)
{
    struct store_stats t;
    struct store *s = NULL;
    char text[32];
    uint64_t stale = 0;
    enum status st = ctl_open(c, STORE_READ, &s);

    if (st == ST_OK) {
        store_use_model(s, c->model);
        if ((st = store_stats(s, &t, &c->e)) == ST_OK)
            st = store_renew_count(s, &stale, &c->e);
    }
    store_close(s);
    if (st != ST_OK)
        return ctl_fail(c, st);
    ctl_out_number(c->out, "subjects", (double)t.subjects);
    ctl_out_number(c->out, "templates", (double)t.templates);
    ctl_out_number(c->out, "stale", (double)stale);
    ctl_out_number(c->out, "points", (double)t.points);
    ctl_out_number(c->out, "template_bytes", (double)t.template_bytes);
    ctl_out_number(c->out, "file_bytes", (double)t.file_bytes);
    ctl_out_number(c->out, "events", (double)t.events);
    ctl_out_number(c->out, "tokens", (double)t.tokens);
    ctl_out_number(c->out, "schema", t.schema);
    if (c->json)
        return EXIT_FINE;
    (void)printf("subjects     %llu\n", (unsigned long long)t.subjects);
    (void)printf("templates    %llu", (unsigned long long)t.templates);
    if (stale > 0)
        (void)printf(", %llu by another engine (template reprocess)",
                     (unsigned long long)stale);
    (void)printf("\n");
    (void)printf("points       %llu\n", (unsigned long long)t.points);
    (void)printf("models       %s\n", ctl_bytes(t.template_bytes, text));
    (void)printf("file         %s\n", ctl_bytes(t.file_bytes, text));
    if (t.points > 0)
        (void)printf("per point    %.1f bytes of model, %.1f of file\n",
                     (double)t.template_bytes / (double)t.points,
                     (double)t.file_bytes / (double)t.points);
    (void)printf("events       %llu\n", (unsigned long long)t.events);
    (void)printf("tokens       %llu\n", (unsigned long long)t.tokens);
    (void)printf("schema       %u\n", t.schema);
    return EXIT_FINE;
}

int ctl_admin_vacuum(struct ctl *c)
{
    struct store_stats before, after;
    struct store *s = NULL;
    char was[32], is[32];
    enum status st = ctl_open(c, STORE_WRITE, &s);

    if (st == ST_OK && (st = store_stats(s, &before, &c->e)) == ST_OK &&
        (st = store_vacuum(s, &c->e)) == ST_OK)
        st = store_stats(s, &after, &c->e);
    store_close(s);
    if (st != ST_OK)
        return ctl_fail(c, st);
    ctl_out_number(c->out, "bytes_before", (double)before.file_bytes);
    ctl_out_number(c->out, "bytes_after", (double)after.file_bytes);
    if (!c->json)
        (void)printf("%s: %s before, %s now\n", c->db, ctl_bytes(before.file_bytes, was),
                     ctl_bytes(after.file_bytes, is));
    return EXIT_FINE;
}
