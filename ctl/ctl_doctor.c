/* doctor: what is wrong around a database, and what to do.  Nothing is changed. */
#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include "crypt_file.h"
#include "ctl_command.h"
#include "ctl_model.h"

#define LEAST_FREE    (UINT64_C(64) << 20) /* bytes */
#define MANY_TRIED    10                   /* subjects in a day */
#define MANY_FAILURES 3 /* in a row, by one token: as many lock it out */
#define FIND_ALL      "surfacectl check-database lists all damage"
#define DAY_MS        INT64_C(86400000)
#define STICKY        01000 /* S_ISVTX, which POSIX leaves to XSI */

enum level { FINE, NOTE, TROUBLE };

struct doctor {
    struct ctl *c;
    unsigned troubles;
    char key[PATH_MAX],
        next[PATH_MAX]; /* the key's file, and where rekey puts a new one */
    bool used;          /* another process has the database open */
};

/* One finding, and what to do about it. */
__attribute__((format(printf, 5, 6))) static void say(struct doctor *d, enum level level,
                                                      const char *about, const char *todo,
                                                      const char *format, ...)
{
    static const char *const word[] = {"ok", "note", "trouble"};
    char text[400];
    va_list args;

    va_start(args, format);
    (void)vsnprintf(text, sizeof text, format, args);
    va_end(args);
    d->troubles += level == TROUBLE;
    json_object(d->c->out, NULL);
    json_text(d->c->out, "level", word[level]);
    json_text(d->c->out, "about", about);
    json_text(d->c->out, "finding", text);
    if (level != FINE)
        json_text(d->c->out, "todo", todo);
    json_close(d->c->out);
    if (d->c->json)
        return;
    (void)printf("%-8s %-9s %s\n", word[level], about, text);
    if (level != FINE)
        (void)printf("%19s%s\n", "-> ", todo);
}

/* ---- files */

static bool look_at_file(struct doctor *d)
{
    const char *db = d->c->db;
    struct stat sb;

    if (stat(db, &sb) != 0 || !S_ISREG(sb.st_mode)) {
        say(d, TROUBLE, "database", "name it with --db, or make one: surfacectl init",
            "there is no file %s", db);
        return false;
    }
    if ((sb.st_mode & 077) != 0)
        say(d, TROUBLE, "database", "chmod 600 FILE, unless a group is meant to read it",
            "%s may be read or changed by others (mode %03o)", db,
            (unsigned)sb.st_mode & 0777);
    else if (access(db, R_OK | W_OK) != 0)
        say(d, TROUBLE, "database", "run this as its owner, as with runuser -u surfaced",
            "%s belongs to user %u, and this user may not read and write it", db,
            (unsigned)sb.st_uid);
    else
        say(d, FINE, "database", "", "only its owner can read %s", db);
    return access(db, R_OK) == 0;
}

static void look_at_folder(struct doctor *d)
{
    const char *db = d->c->db, *slash = strrchr(db, '/');
    char dir[PATH_MAX];
    struct stat sb;
    struct statvfs fs;
    char text[32];
    uint64_t left;

    (void)snprintf(dir, sizeof dir, "%.*s", slash == NULL ? 1 : (int)(slash - db + 1),
                   slash == NULL ? "." : db);
    if (stat(dir, &sb) != 0 || statvfs(dir, &fs) != 0)
        return;
    if ((sb.st_mode & 022) != 0 && (sb.st_mode & STICKY) == 0)
        say(d, TROUBLE, "folder", "chmod go-w FOLDER",
            "others may replace files in %s (mode %03o)", dir,
            (unsigned)sb.st_mode & 0777);
    else if (access(dir, W_OK | X_OK) != 0)
        say(d, TROUBLE, "folder", "chown it to the daemon's user; chmod 700",
            "no file can be created in %s, and the WAL needs one", dir);
    else
        say(d, FINE, "folder", "", "%s can be written", dir);
    left = (uint64_t)fs.f_bavail * fs.f_frsize;
    if (left < LEAST_FREE)
        say(d, TROUBLE, "disk", "free some space: enrolments fail when the disk is full",
            "%s free", ctl_bytes(left, text));
    else
        say(d, FINE, "disk", "", "%s free", ctl_bytes(left, text));
}

static void look_at_wal(struct doctor *d)
{
    char name[PATH_MAX];
    struct stat sb;
    int64_t pid;

    if ((d->used = store_in_use(d->c->db, &pid)))
        say(d, FINE, "in use", "", "process %lld has the database open", (long long)pid);
    (void)snprintf(name, sizeof name, "%s-wal", d->c->db);
    if (stat(name, &sb) != 0 || sb.st_size == 0)
        return;
    if (access(name, R_OK | W_OK) != 0)
        say(d, TROUBLE, "WAL", "chown it to the database's owner, and PATH-shm too",
            "%s belongs to user %u, and this user may not write it", name,
            (unsigned)sb.st_uid);
    else if (!d->used)
        say(d, NOTE, "WAL",
            "nothing: the next command checkpoints it; never copy or remove the database or its "
            "WAL alone",
            "%s is left, %lld bytes: a process that had the database open was killed",
            name, (long long)sb.st_size);
}

/* Files that commands left: killed ones, or completed ones for a person to remove. */
static void look_at_left(struct doctor *d)
{
    static const struct {
        const char *suffix, *finding, *todo;
    } left[] = {
        {".part", "was left by a restore or an upgrade that was killed",
         "nothing: the next one overwrites it; or delete it while none is running"},
        {".before-restore", "is the database from before a restore",
         "delete it when you no longer need it: it may contain subjects that are now "
         "erased"},
        {".before-restore.part", "was left by a restore that was killed",
         "nothing: the next one overwrites it; or delete it while none is running"},
    };
    char name[PATH_MAX];

    for (size_t i = 0; i < sizeof left / sizeof *left; i++) {
        (void)snprintf(name, sizeof name, "%s%s", d->c->db, left[i].suffix);
        if (access(name, F_OK) == 0)
            say(d, NOTE, "left", left[i].todo, "%s %s", name, left[i].finding);
    }
}

/* ---- what is in them */

static bool look_at_schema(struct doctor *d)
{
    enum crypt_kind kind;
    struct errinfo e;
    const enum status st = store_kind(d->c->db, &kind, &e);

    if (st == ST_EVERSION)
        say(d, TROUBLE, "schema", "use the program that made it, or a newer one", "%s",
            e.msg);
    else if (st == ST_ENOTFOUND)
        say(d, TROUBLE, "schema", "surfacectl init", "the database is empty");
    else if (st != ST_OK)
        say(d, TROUBLE, "schema", "restore a backup: surfacectl restore", "%s", e.msg);
    else
        say(d, FINE, "schema", "", "the version of this program");
    return st == ST_OK;
}

/* Does a key's file, or for NULL what is usual, open the database? */
static enum status try_key(struct doctor *d, const char *path, struct errinfo *e)
{
    const struct store_key key = {
        .path = path, .make = CRYPT_FILE, .plaintext = d->c->plaintext};
    struct store *s = NULL;
    const enum status st = store_open(d->c->db, STORE_READ, &key, &s, e);

    store_close(s);
    return st;
}

static void look_at_next(struct doctor *d)
{
    if (access(d->next, F_OK) != 0)
        return;
    if (try_key(d, d->next, NULL) == ST_OK)
        say(d, TROUBLE, "key",
            "rename it over the old key: nothing else opens the database",
            "rekey was interrupted: the key is %s", d->next);
    else
        say(d, NOTE, "key", "remove it, or surfacectl rekey will",
            "%s was left by a rekey that did not finish", d->next);
}

/* Is there a key that opens the database? */
static bool look_at_key(struct doctor *d)
{
    enum crypt_kind kind;
    struct errinfo e;
    enum status st = store_kind(d->c->db, &kind, &e);

    if (st == ST_OK && kind == CRYPT_PLAINTEXT &&
        (st = try_key(d, d->c->key, &e)) == ST_EDENIED) {
        say(d, TROUBLE, "key",
            "surfacectl restore, or --plaintext-database if that is intended", "%s",
            e.msg);
        return false;
    }
    if (st == ST_OK && kind == CRYPT_PLAINTEXT) {
        say(d, NOTE, "key", "surfacectl rekey gives it a key",
            "the database has no key: anyone who has the file can read it");
        return true;
    }
    if (st == ST_OK && kind == CRYPT_PASSPHRASE && access(d->key, F_OK) != 0) {
        say(d, NOTE, "key", "name a file with the passphrase with --key to try it",
            "the database is encrypted with a passphrase, which was not tried");
        return false;
    }
    if (st == ST_OK)
        st = try_key(d, d->key, &e);
    if (st == ST_OK)
        say(d, FINE, "key", "", "%s opens the database", d->key);
    else if (st == ST_ENOTFOUND)
        say(d, TROUBLE, "key",
            "restore the key file from its copy, or name it with --key", "%s", e.msg);
    else if (st == ST_EDENIED)
        say(d, TROUBLE, "key", "chmod 600 and chown it, or name the right one with --key",
            "%s", e.msg);
    else
        say(d, TROUBLE, "key", "surfacectl check-database says more", "%s", e.msg);
    return st == ST_OK;
}

/* The database, opened once for what follows; NULL: it cannot be.  Is it the newest? */
static struct store *look_at_anchor(struct doctor *d)
{
    struct store_key key = {
        .path = d->c->key, .make = CRYPT_FILE, .plaintext = d->c->plaintext};
    struct store *s = NULL;
    struct errinfo e;

    if (d->c->anchor == NULL || strcmp(d->c->anchor, "none") == 0) {
        say(d, NOTE, "anchor", "keep one on another disk or host: anchor = FILE",
            "none: surfaced cannot notice that the database was replaced by an older "
            "copy");
    } else {
        key.anchor = d->c->anchor;
        if (store_open(d->c->db, STORE_READ, &key, &s, &e) == ST_OK) {
            say(d, FINE, "anchor", "", "the database is as new as its anchor");
            return s;
        }
        say(d, TROUBLE, "anchor",
            "find out who restored it; operation.md, \"A difference was found\"", "%s",
            e.msg);
        key.anchor = NULL;
    }
    if (store_open(d->c->db, STORE_READ, &key, &s, &e) != ST_OK)
        say(d, TROUBLE, "database", "surfacectl check-database", "%s", e.msg);
    return s;
}

/* Are the rows those of the last change, as the daemon looks when it starts? */
static void look_at_state(struct doctor *d, struct store *s)
{
    struct log_end end;
    struct errinfo e;
    enum status st = store_last_change(s, &end, &e);

    if (st == ST_OK)
        st = store_verify(s, NULL, NULL, &e);
    if (st == ST_OK)
        say(d, FINE, "state", "", "the rows match the change log (%llu changes)",
            (unsigned long long)end.seq);
    else
        say(d, TROUBLE, "state",
            "surfacectl check-database lists what is wrong; restore a backup from before",
            "%s", e.msg);
}

static void look_at_templates(struct doctor *d, struct store *s)
{
    struct store_stats all;
    struct errinfo e;
    uint64_t others = 0;
    enum status st = store_stats(s, &all, &e);

    store_use_model(s, d->c->model);
    if (st == ST_OK)
        st = store_reencode_count(s, &others, &e);
    if (st != ST_OK)
        say(d, TROUBLE, "templates", FIND_ALL, "%s", e.msg);
    else if (others > 0)
        say(d, TROUBLE, "templates",
            "surfacectl template reencode, or name their model with --model",
            "%llu of %llu were made by another engine than %s",
            (unsigned long long)others, (unsigned long long)all.templates, d->c->engine);
    else
        say(d, FINE, "templates", "", "%llu, made by this engine",
            (unsigned long long)all.templates);
}

static void look_at_tokens(struct doctor *d, struct store *s)
{
    struct store_token *t = NULL;
    struct errinfo e;
    size_t n = 0, soon = 0;
    const enum status st = store_token_list(s, &t, &n, &e);

    for (size_t i = 0; i < n; i++) {
        const int64_t left = store_token_left(&t[i]);

        if (left == 0 || left > STORE_TOKEN_SOON_S)
            continue;
        soon++;
        say(d, NOTE, "token", "surfacectl token rotate ID --expires TIME",
            "%s (%s) expires at %s", t[i].id, t[i].name, t[i].expires);
    }
    free(t);
    if (st != ST_OK)
        say(d, TROUBLE, "tokens", FIND_ALL, "%s", e.msg);
    else if (soon == 0)
        say(d, FINE, "tokens", "", "none expires within 30 days");
}

/* Who fails: of one token, in the list from a[i] on (all of it are looked at). */
static void look_at_token(struct doctor *d, const struct store_attempts *a, size_t n,
                          size_t i)
{
    const char *token = a[i].token;
    unsigned tried = 0;

    for (size_t j = 0; j < n; j++)
        if (a[j].age_ms < STORE_TRIED_WARN_MS && strcmp(a[j].token, token) == 0) {
            if (j < i)
                return; /* was reported */
            tried++;
        }
    if (tried >= MANY_TRIED)
        say(d, NOTE, "attempts",
            "find out who uses it: surfacectl audit show, attempts list; token revoke ends it",
            "token %s tried %u subjects without a match within a day",
            token[0] != '\0' ? token : "(none)", tried);
}

static void look_at_attempts(struct doctor *d, struct store *s)
{
    struct store_attempts *a = NULL;
    struct errinfo e;
    size_t n = 0, locked = 0;

    if (store_attempts_list(s, &a, &n, &e) != ST_OK) {
        say(d, TROUBLE, "attempts", FIND_ALL, "%s", e.msg);
        n = 0;
    }
    for (size_t i = 0; i < n; i++) {
        locked += a[i].failures >= MANY_FAILURES && a[i].age_ms < DAY_MS;
        if (a[i].age_ms < STORE_TRIED_MS)
            look_at_token(d, a, n, i);
    }
    if (locked > 0)
        say(d, NOTE, "attempts", "see surfacectl attempts list",
            "%zu times in the last day %d verifications or more in a row failed", locked,
            MANY_FAILURES);
    free(a);
}

static enum status run(struct ctl *c)
{
    struct doctor d = {.c = c};
    struct store *s;

    if (c->key != NULL)
        (void)snprintf(d.key, sizeof d.key, "%s", c->key);
    else
        (void)snprintf(d.key, sizeof d.key, "%s.key", c->db);
    (void)snprintf(d.next, sizeof d.next, "%.*s.new", (int)sizeof d.next - 5, d.key);
    json_array(c->out, "findings");
    if (look_at_file(&d)) {
        look_at_folder(&d);
        look_at_wal(&d); /* before it is brought in */
        look_at_left(&d);
        if (look_at_schema(&d)) {
            look_at_next(&d);
            if (look_at_key(&d) && (s = look_at_anchor(&d)) != NULL) {
                look_at_state(&d, s);
                look_at_templates(&d, s);
                look_at_tokens(&d, s);
                look_at_attempts(&d, s);
                store_close(s);
            }
        }
    }
    json_close(c->out);
    json_flag(c->out, "ok", d.troubles == 0);
    c->code = d.troubles == 0 ? EXIT_FINE : EXIT_NO;
    return ST_OK;
}

const struct ctl_command ctl_doctor = {
    .name = "doctor",
    .database = CTL_NEEDS_DATABASE,
    .shared = CTL_MODEL,
    .exits = {"no trouble", "there is trouble"},
    .run = run,
    .summary = "find what is wrong with a database and its files",
    .help =
        "Also says what to do about it. Checks the permissions of the database, its folder and\n"
        "key; that the key opens it; a key left by an interrupted rekey; a database "
        "older than its\n"
        "anchor; schema, WAL, free disk space; rows that were changed; templates of another\n"
        "engine; tokens that expire soon, or that fail to verify many subjects. Nothing "
        "is changed.",
    .example = "surfacectl --db faces.db doctor"};
