/* doctor: problems around a database, and advice.  Nothing is changed. */
#include <limits.h>
#include <math.h>
#include <pwd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include "admin_rekey.h"
#include "ctl_command.h"
#include "ctl_model.h"
#include "findings.h"
#include "newfile.h"

#define LEAST_FREE (UINT64_C(64) << 20) /* bytes */
#define STICKY     01000                /* S_ISVTX, which POSIX leaves to XSI */

struct doctor {
    struct ctl *c;
    struct findings found;
    char key[PATH_MAX]; /* the key's file */
    bool used;          /* another process has the database open */
};

#define say(d, ...) findings_say(&(d)->found, __VA_ARGS__)

static void ctl_doctor_tell(void *arg, const struct finding *f)
{
    struct ctl *c = arg;

    json_object(c->out, NULL);
    findings_describe(c->out, f);
    json_close(c->out);
    ctl_say(c, "%-8s %-9s %s\n", findings_word(f->severity), f->about, f->what);
    if (f->todo[0] != '\0')
        ctl_say(c, "%19s%s\n", "-> ", f->todo);
}

/* ---- files */

/* Returns the advice for a file that this user may not use: to run the command as the database's owner, if that
 * user owns the file.  chown would take the file from the daemon. */
static const char *as_owner(const struct doctor *d, const char *path,
                            const char *otherwise, char text[200])
{
    const struct passwd *owner;
    struct stat db, sb;

    if (stat(d->c->db, &db) != 0 || stat(path, &sb) != 0 || db.st_uid != sb.st_uid ||
        db.st_uid == geteuid() || (owner = getpwuid(db.st_uid)) == NULL)
        return otherwise;
    (void)snprintf(text, 200, "run this as its owner: runuser -u %s -- surfacectl ...",
                   owner->pw_name);
    return text;
}

static bool look_at_file(struct doctor *d)
{
    const char *db = d->c->db;
    char text[200];
    struct stat sb;

    if (stat(db, &sb) != 0 || !S_ISREG(sb.st_mode)) {
        say(d, FINDINGS_ERROR, "database",
            "name it with --db, or make one: surfacectl init", "there is no file %s", db);
        return false;
    }
    if ((sb.st_mode & 077) != 0)
        say(d, FINDINGS_ERROR, "database",
            "chmod 600 FILE, unless a group is meant to read it",
            "%s may be read or changed by others (mode %03o)", db,
            (unsigned)sb.st_mode & 0777);
    else if (access(db, R_OK | W_OK) != 0)
        say(d, FINDINGS_ERROR, "database", as_owner(d, db, "chmod 600 FILE", text),
            "%s belongs to user %u, and this user may not read and write it", db,
            (unsigned)sb.st_uid);
    else
        say(d, FINDINGS_OK, "database", "", "only its owner can read %s", db);
    return access(db, R_OK) == 0;
}

static void look_at_folder(struct doctor *d)
{
    const char *db = d->c->db, *slash = strrchr(db, '/');
    char dir[PATH_MAX];
    struct stat sb;
    struct statvfs fs;
    char text[32], advice[200];
    uint64_t left;

    (void)snprintf(dir, sizeof dir, "%.*s", slash == NULL ? 1 : (int)(slash - db + 1),
                   slash == NULL ? "." : db);
    if (stat(dir, &sb) != 0 || statvfs(dir, &fs) != 0)
        return;
    if ((sb.st_mode & 022) != 0 && (sb.st_mode & STICKY) == 0)
        say(d, FINDINGS_ERROR, "folder", "chmod go-w FOLDER",
            "other users can replace files in %s (mode %03o)", dir,
            (unsigned)sb.st_mode & 0777);
    else if (access(dir, W_OK | X_OK) != 0)
        say(d, FINDINGS_ERROR, "folder",
            as_owner(d, dir, "chown it to the database's owner; chmod 700", advice),
            "no file can be created in %s, and the WAL needs one", dir);
    else
        say(d, FINDINGS_OK, "folder", "", "%s can be written", dir);
    left = (uint64_t)fs.f_bavail * fs.f_frsize;
    if (left < LEAST_FREE)
        say(d, FINDINGS_ERROR, "disk",
            "free some space: enrolments fail when the disk is full", "%s free",
            ctl_bytes(left, text));
    else
        say(d, FINDINGS_OK, "disk", "", "%s free", ctl_bytes(left, text));
}

static void look_at_wal(struct doctor *d)
{
    char name[PATH_MAX], text[200], size[32];
    struct stat sb;
    int64_t pid;

    if ((d->used = store_in_use(d->c->db, &pid)))
        say(d, FINDINGS_OK, "in use", "", "process %lld has the database open",
            (long long)pid);
    (void)snprintf(name, sizeof name, "%s-wal", d->c->db);
    if (stat(name, &sb) != 0 || sb.st_size == 0)
        return;
    if (access(name, R_OK | W_OK) != 0)
        say(d, FINDINGS_ERROR, "WAL",
            as_owner(d, name, "chown it to the database's owner, and PATH-shm too", text),
            "%s belongs to user %u, and this user may not write it", name,
            (unsigned)sb.st_uid);
    else if (!d->used)
        say(d, FINDINGS_WARNING, "WAL",
            "nothing: the next command checkpoints it; never copy or remove the database or its "
            "WAL alone",
            "%s is left, %s: a process that had the database open was killed", name,
            ctl_bytes((uint64_t)sb.st_size, size));
}

/* Files that commands left: killed ones, or completed ones for a person to remove. */
static void look_at_left(struct doctor *d)
{
    static const struct {
        const char *suffix, *finding, *todo;
    } left[] = {
        {".part", "was left by a restore or a rekey that was killed",
         "nothing: the next one overwrites it; or delete it while none is running"},
        {".before-restore", "is the database from before a restore",
         "delete it when you no longer need it: it may contain subjects that are now "
         "erased"},
        {".discard", "is the old database of a rekey that was interrupted",
         "surfacectl rekey completes it; keep the file until then"},
    };
    char name[PATH_MAX];

    for (size_t i = 0; i < sizeof left / sizeof *left; i++) {
        (void)snprintf(name, sizeof name, "%s%s", d->c->db, left[i].suffix);
        if (access(name, F_OK) == 0)
            say(d, FINDINGS_WARNING, "left", left[i].todo, "%s %s", name,
                left[i].finding);
    }
}

/* ---- a server */

static bool look_at_server(struct doctor *d)
{
    struct store_server is;
    struct errinfo e;
    const enum status st = store_server(d->c->db, &is, &e);

    if (st != ST_OK) {
        say(d, FINDINGS_ERROR, "database",
            "start the server, or name the right one with --db; surfacectl init makes the tables",
            "%s", e.msg);
        return false;
    }
    say(d, FINDINGS_OK, "database", "", "PostgreSQL %s", is.version);
    if (!is.encrypted && !is.local)
        say(d, FINDINGS_ERROR, "network", "sslmode=verify-full in the URL, the default",
            "the connection to the server is not encrypted");
    else
        say(d, FINDINGS_OK, "network", "",
            is.local ? "a socket on this machine" : "encrypted by TLS");
    if (!is.keeps)
        say(d, FINDINGS_ERROR, "server", "fsync = on and full_page_writes = on",
            "a power failure undoes commits, and may destroy the database");
    else
        say(d, FINDINGS_OK, "server", "",
            is.waits ? "a commit is on its disk, and on a standby"
                     : "a commit is on its disk; no standby has it yet");
    if (is.ahead_ms > STORE_CLOCKS_MS || is.ahead_ms < -STORE_CLOCKS_MS)
        say(d, FINDINGS_ERROR, "clock", "set both by one source (chrony)",
            "the server's is %.1f s %s of this machine's",
            fabs((double)is.ahead_ms) / 1000, is.ahead_ms > 0 ? "ahead" : "behind");
    if (is.may_define)
        say(d, FINDINGS_WARNING, "role",
            "own the tables by another role, and GRANT this one SELECT, INSERT, UPDATE, DELETE",
            "the role of the URL may make and drop tables");
    else
        say(d, FINDINGS_OK, "role", "", "it may change rows, and no tables");
    if (is.others > 0)
        say(d, FINDINGS_OK, "in use", "", "by %u other connections", (unsigned)is.others);
    return true;
}

/* ---- contents */

/* What to do about an error that says nothing of the database itself. */
static const char *advice_on(enum status st)
{
    return st == ST_EBUSY
               ? "try again when the other process has ended, or the server answers"
           : st == ST_ENOMEM ? "try again with more memory"
           : st == ST_EIO    ? "look after the disk and the permissions, then try again"
                             : "surfacectl check-database says more";
}

static bool look_at_schema(struct doctor *d)
{
    enum crypt_kind kind;
    struct errinfo e;
    const enum status st = store_kind(d->c->db, &kind, &e);

    if (st == ST_EVERSION)
        say(d, FINDINGS_ERROR, "schema", "use the program that made it, or a newer one",
            "%s", e.msg);
    else if (st == ST_ENOTFOUND)
        say(d, FINDINGS_ERROR, "schema", "surfacectl init", "the database is empty");
    else if (st == ST_ECORRUPT)
        say(d, FINDINGS_ERROR, "schema", "restore a backup: surfacectl restore", "%s",
            e.msg);
    else if (st != ST_OK)
        say(d, FINDINGS_ERROR, "schema", advice_on(st), "%s", e.msg);
    else
        say(d, FINDINGS_OK, "schema", "", "the version of this program");
    return st == ST_OK;
}

/* Opens the database with the key in the file; NULL: the usual file. */
static enum status try_key(struct doctor *d, const char *path, struct errinfo *e)
{
    const struct store_key key = {
        .path = path, .make = CRYPT_FILE, .plaintext = d->c->plaintext};
    struct store *s = NULL;
    const enum status st = store_open(d->c->db, STORE_READ, &key, &s, e);

    store_close(s);
    return st;
}

/* As rekey itself decides: a key is useless only if it was tried, and does not fit. */
static void look_at_next(struct doctor *d)
{
    const struct store_key key = {.path = d->key, .plaintext = d->c->plaintext};
    enum admin_left left;
    char *next = NULL;
    struct errinfo e;

    if (newfile_beside(d->key, STORE_KEY_NEW, &next, &e) != ST_OK ||
        admin_rekey_left(d->c->db, &key, &left, &e) != ST_OK)
        say(d, FINDINGS_ERROR, "key",
            "keep it and a new key beside it, and try again when both can be read",
            "whether rekey was interrupted is not known: %s", e.msg);
    else if (left == ADMIN_LEFT_KEY)
        say(d, FINDINGS_ERROR, "key",
            "surfacectl rekey completes it; keep the file: nothing else opens the database",
            "rekey was interrupted: the key is %s", next);
    else if (left == ADMIN_LEFT_UNKNOWN)
        say(d, FINDINGS_ERROR, "key", "keep it, but move it away",
            "%s is not the key of this database, and may be the key of another", next);
    else if (left == ADMIN_LEFT_USELESS)
        say(d, FINDINGS_WARNING, "key", "surfacectl rekey removes it",
            "%s was left by a rekey that did not finish, and opens nothing here", next);
    free(next);
}

/* Does what the database is in, with all that is beside it, let it be opened? */
static bool look_around(struct doctor *d)
{
    if (store_on_server(d->c->db))
        return look_at_server(d);
    if (!look_at_file(d))
        return false;
    look_at_folder(d);
    look_at_wal(d); /* before it is brought in */
    look_at_left(d);
    return true;
}

/* Is there a key that opens the database? */
static bool look_at_key(struct doctor *d)
{
    enum crypt_kind kind;
    struct errinfo e;
    char text[200];
    enum status st = store_kind(d->c->db, &kind, &e);

    if (st == ST_OK && kind == CRYPT_PLAINTEXT &&
        (st = try_key(d, d->c->key, &e)) == ST_EDENIED) {
        say(d, FINDINGS_ERROR, "key",
            "surfacectl restore, or --plaintext-database if that is intended", "%s",
            e.msg);
        return false;
    }
    if (st == ST_OK && kind == CRYPT_PLAINTEXT) {
        say(d, FINDINGS_WARNING, "key", "surfacectl rekey gives it a key",
            "the database has no key: anyone who has the file can read it");
        return true;
    }
    if (st == ST_OK && kind == CRYPT_PASSPHRASE && access(d->key, F_OK) != 0) {
        say(d, FINDINGS_WARNING, "key",
            "name a file with the passphrase with --key to try it",
            "the database is encrypted with a passphrase, which was not tried");
        return false;
    }
    if (st == ST_OK)
        st = try_key(d, d->key, &e);
    if (st == ST_OK)
        say(d, FINDINGS_OK, "key", "", "%s opens the database", d->key);
    else if (st == ST_ENOTFOUND)
        say(d, FINDINGS_ERROR, "key",
            "restore the key file from its copy, or name it with --key", "%s", e.msg);
    else if (st == ST_EDENIED)
        say(d, FINDINGS_ERROR, "key",
            as_owner(
                d, d->key,
                "chmod 600 and chown it to the database's owner, or name the right one "
                "with --key",
                text),
            "%s", e.msg);
    else
        say(d, FINDINGS_ERROR, "key", advice_on(st), "%s", e.msg);
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
        say(d, FINDINGS_WARNING, "anchor",
            "keep one on another disk or host: anchor = FILE",
            "none: surfaced cannot notice that the database was replaced by an older "
            "copy");
    } else {
        key.anchor = d->c->anchor;
        if (store_open(d->c->db, STORE_READ, &key, &s, &e) == ST_OK) {
            say(d, FINDINGS_OK, "anchor", "", "the database is as new as its anchor");
            return s;
        }
        say(d, FINDINGS_ERROR, "anchor",
            e.code == ST_EREFUSED
                ? "find out who restored it; operation.md, \"A difference was found\""
                : advice_on(e.code),
            "%s", e.msg);
        key.anchor = NULL;
    }
    if (store_open(d->c->db, STORE_READ, &key, &s, &e) != ST_OK)
        say(d, FINDINGS_ERROR, "database", advice_on(e.code), "%s", e.msg);
    return s;
}

/* Verifies the rows against the last change, as the daemon does when it starts. */
static void look_at_state(struct doctor *d, struct store *s)
{
    char changes[FINDINGS_COUNT];
    struct log_end end;
    struct errinfo e;
    enum status st = store_last_change(s, &end, &e);

    if (st == ST_OK)
        st = store_verify(s, NULL, NULL, &e);
    if (st == ST_OK)
        say(d, FINDINGS_OK, "state", "", "the rows match the change log (%s changes)",
            findings_count(changes, end.seq));
    else
        say(d, FINDINGS_ERROR, "state",
            st == ST_EREFUSED ? "surfacectl check-database lists the problems; restore a "
                                "backup from before"
                              : advice_on(st),
            "%s", e.msg);
}

static enum status ctl_doctor_run(struct ctl *c)
{
    struct doctor d = {.c = c, .found = {.tell = ctl_doctor_tell, .arg = c}};
    struct store *s;

    if (c->key != NULL)
        (void)snprintf(d.key, sizeof d.key, "%s", c->key);
    else
        (void)snprintf(d.key, sizeof d.key, "%s.key", c->db);
    json_array(c->out, "findings");
    if (look_around(&d) && look_at_schema(&d)) {
        look_at_next(&d);
        if (look_at_key(&d) && (s = look_at_anchor(&d)) != NULL) {
            look_at_state(&d, s);
            store_use_model(s, c->model);
            findings_store(&d.found, s);
            store_close(s);
        }
    }
    json_close(c->out);
    json_flag(c->out, "ok", d.found.errors == 0);
    c->code = d.found.errors == 0 ? EXIT_FINE : EXIT_NO;
    return ST_OK;
}

const struct ctl_command ctl_doctor = {
    .name = "doctor",
    .database = CTL_NEEDS_DATABASE,
    .shared = CTL_MODEL,
    .exits = {"no error was found", "errors were found"},
    .run = ctl_doctor_run,
    .summary = "find problems with a database and its files",
    .help =
        "Checks permissions, key, anchor, schema, WAL, disk space, rows, templates and tokens,\n"
        "and says what to do. Nothing is changed.",
    .example = "surfacectl --db faces.db doctor"};
