#include "admin_restore.h"

#include <errno.h>
#include <inttypes.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "admin_copy.h"
#include "crypt_file.h"
#include "log_anchor.h"
#include "log_row.h"
#include "newfile.h"
#include "rows_device.h"
#include "rows_digest.h"
#include "rows_root.h"
#include "rows_template.h"
#include "rows_token.h"
#include "sql_file.h"
#include "store.h"
#include "store_txn.h"

#define PAGE 1000

struct restoring {
    const char *path, *from, *from_key;
    const struct store_key *key;
    struct store *held; /* the database that is there; NULL: there is none */
    struct store *backup;
    bool same_key;           /* the backup is opened by the database's key */
    struct log_end end;      /* of the backup's change log */
    struct log_entry *since; /* [n], changes of the database that is there after that */
    size_t n;
    struct log_act by;
    struct crypt_root root; /* of the restored database */
    struct crypt *made;     /* its keys, where neither store has them */
    struct admin_restored *out;
};

/* ---- the database that is there */

static void first_problem(void *arg, enum log_name log, uint64_t seq, const char *line)
{
    struct errinfo *first = arg;

    if (first->code == ST_OK)
        (void)errinfo_set(
            first, ST_EREFUSED,
            "the log of the database that is there is not as it was written "
            "(%s, entry %" PRIu64 ": %s): move it away first; then those who "
            "were erased since the backup are back",
            log_word(log), seq, line);
}

/* Nothing of it is believed but a log that verifies. */
static enum status walk_held(struct restoring *r, struct errinfo *e)
{
    unsigned char public[CRYPT_KEY];
    struct errinfo first = {ST_OK, ""};
    struct log_walk w;
    struct log_txn t;
    enum status st;

    crypt_public(r->held->crypt, public);
    log_walk_begin(&w, r->held->crypt, public, first_problem, &first);
    if ((st = store_begin(r->held, SQL_READ, &t, e)) != ST_OK ||
        (st = store_end(r->held, &t, log_walk_all(t.sql, &w, e), e)) != ST_OK)
        return st;
    return first.code == ST_OK ? ST_OK : errinfo_set(e, first.code, "%s", first.msg);
}

static enum status open_held(struct restoring *r, bool dry, struct errinfo *e)
{
    struct store_key by = *r->key;
    struct errinfo why;
    enum status st;

    if (access(r->path, F_OK) != 0 && errno == ENOENT) {
        if (sql_file_has_wal(r->path)) /* SQLite would take it for the new one's */
            return errinfo_set(e, ST_EEXISTS,
                               "there is a %.160s-wal without its database: move it away "
                               "first",
                               r->path);
        return ST_OK;
    }
    by.anchor = NULL; /* it may be the older one that is to be replaced */
    st = store_open(r->path, dry ? STORE_READ : STORE_ALONE, &by, &r->held, &why);
    if (st == ST_EBUSY || st == ST_ENOMEM)
        return errinfo_set(e, st, "%s", why.msg);
    if (st != ST_OK)
        return errinfo_set(e, st,
                           "%.300s: move it away first; then those who were erased since "
                           "the backup are back",
                           why.msg);
    return walk_held(r, e);
}

/* ---- the backup */

/* SQLite takes what is missing of the last page for zeros, which is not noticed where they
 * were zeros. */
static enum status is_whole(struct sql_txn *t, const char *from, struct errinfo *e)
{
    struct stat sb;
    uint64_t bytes = 0;
    const enum status st = sql_file_bytes(t, &bytes, e);

    if (st != ST_OK || sql_file_has_wal(from))
        return st;
    if (stat(from, &sb) != 0 || (uint64_t)sb.st_size < bytes)
        return errinfo_set(e, ST_ECORRUPT,
                           "%.160s is cut short: it should have %llu bytes", from,
                           (unsigned long long)bytes);
    return ST_OK;
}

static enum status open_backup(struct restoring *r, struct errinfo *e)
{
    struct store_key by = *r->key;
    enum crypt_kind kind;
    char *usual = NULL;
    struct log_txn t;
    enum status st;

    by.anchor = NULL;
    if (r->from_key != NULL) {
        by.path = r->from_key;
        by.given = NULL;
    } else if (by.path == NULL) {
        if ((usual = admin_name(r->path, ".key")) == NULL)
            return errinfo_set(e, ST_ENOMEM, "out of memory");
        by.path = usual;
    }
    st = store_open(r->from, STORE_READ, &by, &r->backup, e);
    free(usual);
    if (st == ST_EDENIED && r->from_key == NULL && !by.plaintext &&
        store_kind(r->from, &kind, NULL) == ST_OK && kind != CRYPT_PLAINTEXT)
        return errinfo_set(e, st,
                           "the backup %.150s was made under another key than the "
                           "database's: give that key by --backup-key FILE",
                           r->from);
    if (st != ST_OK || (st = store_begin(r->backup, SQL_READ, &t, e)) != ST_OK)
        return st;
    r->same_key = r->from_key == NULL;
    r->end = t.changes;
    if ((st = store_end(r->backup, &t, is_whole(t.sql, r->from, e), e)) != ST_OK)
        return st;
    return admin_verify_store(r->backup, &r->out->backup, e);
}

/* ---- what must not be undone by going back in time */

static enum status has_change(struct store *s, const struct log_end *at, bool *has,
                              struct errinfo *e)
{
    struct log_txn t;
    const enum status st = store_begin(s, SQL_READ, &t, e);

    return st == ST_OK ? store_end(s, &t, log_has(&t, at, has, e), e) : st;
}

static enum status relate(struct restoring *r, struct errinfo *e)
{
    struct log_filter after = {.after = r->end.seq};
    struct store_stats stats;
    struct log_end end;
    struct log_txn t;
    bool goes_on = false, older = false;
    enum status st;

    if (r->held == NULL)
        return ST_OK;
    r->out->was_there = true;
    if ((st = store_begin(r->held, SQL_READ, &t, e)) != ST_OK)
        return st;
    end = t.changes;
    if ((st = log_has(&t, &r->end, &goes_on, e)) == ST_OK && goes_on)
        st = log_list(t.sql, LOG_CHANGES, &after, &r->since, &r->n, e);
    if ((st = store_end(r->held, &t, st, e)) != ST_OK ||
        (st = store_stats(r->held, &stats, e)) != ST_OK)
        return st;
    r->out->had_subjects = stats.subjects;
    r->out->had_templates = stats.templates;
    if (goes_on)
        return ST_OK;
    if ((st = has_change(r->backup, &end, &older, e)) != ST_OK || older)
        return st; /* the backup has all that it has, and more */
    return errinfo_set(
        e, ST_EMISMATCH,
        "the backup is not of the same database as %.160s, or both have gone on "
        "since an earlier restore: move that away first; then those who were "
        "erased in it since are back",
        r->path);
}

static enum status erase_again(struct restoring *r, struct log_txn *to,
                               const unsigned char uid[STORE_UID], struct errinfo *e)
{
    struct rows_subject of;
    enum status st = rows_subject_get(to, uid, &of, e);

    if (st == ST_ENOTFOUND) /* no older archive brings it back either */
        return log_change(to, &r->by, "delete_subject", uid, "", "erased before", e);
    if (st == ST_OK &&
        (st = store_erase_rows(to, &r->by, &of, "erased again", NULL, e)) == ST_OK)
        r->out->erased++;
    sodium_memzero(&of, sizeof of);
    return st;
}

static enum status revoke_again(struct restoring *r, struct log_txn *to, const char *id,
                                struct errinfo *e)
{
    struct rows_token one;
    enum status st = rows_token_get(to, id, &one, e);

    if (st != ST_OK || one.token.revoked)
        return st == ST_ENOTFOUND ? ST_OK : st;
    memcpy(one.revoked, r->by.at, sizeof one.revoked);
    if ((st = rows_token_write(to, &one, e)) != ST_OK)
        return st;
    r->out->revoked++;
    return log_change(to, &r->by, "revoke_token", NULL, id, one.token.name, e);
}

static enum status remove_again(struct restoring *r, struct log_txn *to, const char *id,
                                struct errinfo *e)
{
    struct rows_device *list = NULL;
    size_t n;
    enum status st = rows_device_list(to, &list, &n, e);

    for (size_t i = 0; i < n && st == ST_OK; i++)
        if (strcmp(list[i].one.id, id) == 0 &&
            (st = rows_device_delete(to, &list[i], e)) == ST_OK) {
            r->out->revoked++;
            st = log_change(to, &r->by, "remove_device", NULL, id, list[i].one.name, e);
        }
    free(list);
    return st;
}

static enum status count_lost(struct restoring *r, struct log_txn *to, struct errinfo *e)
{
    struct sql_rows *rows;
    struct log_txn t;
    enum status st = store_begin(r->held, SQL_READ, &t, e);

    if (st != ST_OK)
        return st;
    st = sql_query(t.sql, "SELECT uid FROM subjects", NULL, 0, &rows, e);
    while (st == ST_OK && sql_next(rows)) {
        struct sql_rows *found;

        st = SQL_QUERY(to->sql, &found, e, "SELECT 1 FROM subjects WHERE uid = $1",
                       sql_column(rows, 0));
        r->out->lost += st == ST_OK && !sql_next(found);
        st = sql_done(found, st, e);
    }
    return store_end(r->held, &t, sql_done(rows, st, e), e);
}

static enum status amend(void *arg, struct log_txn *to, struct errinfo *e)
{
    struct restoring *r = arg;
    enum status st = ST_OK;

    for (size_t i = 0; i < r->n && st == ST_OK; i++) {
        const struct log_entry *c = &r->since[i];

        if (strcmp(c->kind, "delete_subject") == 0)
            st = erase_again(r, to, c->uid, e);
        else if (strcmp(c->kind, "revoke_token") == 0 ||
                 strcmp(c->kind, "rotate_token") == 0)
            st = revoke_again(r, to, c->object, e);
        else if (strcmp(c->kind, "remove_device") == 0)
            st = remove_again(r, to, c->object, e);
    }
    return st == ST_OK && r->held != NULL ? count_lost(r, to, e) : st;
}

/* ---- the restored database */

static enum status read_root(struct store *s, struct crypt_root *root, struct errinfo *e)
{
    struct log_txn t;
    const enum status st = store_begin(s, SQL_READ, &t, e);

    return st == ST_OK ? store_end(s, &t, rows_root_read(t.sql, root, e), e) : st;
}

/* New keys under the master key that the database is to have, where no database has it. */
static enum status make_keys(struct restoring *r, struct errinfo *e)
{
    char *path =
        r->key->path != NULL ? strdup(r->key->path) : admin_name(r->path, ".key");
    struct crypt_file *k = NULL;
    unsigned char key[CRYPT_KEY];
    enum status st;

    if (path == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    if ((st = crypt_file_read(path, &k, e)) == ST_OK &&
        (st = crypt_file_key(k, path, key, e)) == ST_OK)
        st = crypt_make(CRYPT_FILE, key, sizeof key, &r->root, &r->made, e);
    sodium_memzero(key, sizeof key);
    crypt_file_free(k);
    free(path);
    return st;
}

/* The configured key opens the result. */
static enum status choose_keys(struct restoring *r, const struct crypt **c,
                               struct errinfo *e)
{
    struct store *const of = r->same_key ? r->backup : r->held;
    enum status st;

    if (of == NULL) {
        st = make_keys(r, e);
        *c = r->made;
        return st;
    }
    *c = of->crypt;
    return read_root(of, &r->root, e);
}

static enum status copy_and_place(struct restoring *r, bool dry, struct errinfo *e)
{
    struct admin_copy what = {.root = &r->root,
                              .by = &r->by,
                              .kind = "restore",
                              .outcome = "restored",
                              .amend = amend,
                              .arg = r};
    struct store_key opens = *r->key;
    char *aside = admin_name(r->path, ".before-restore");
    char *usual = admin_name(r->path, ".key");
    struct newfile n = NEWFILE_NONE;
    struct admin_copied found;
    struct log_end end;
    enum status st;

    if (opens.path == NULL)
        opens.path = usual;
    if (aside == NULL || usual == NULL)
        st = errinfo_set(e, ST_ENOMEM, "out of memory");
    else if ((st = choose_keys(r, &what.crypt, e)) == ST_OK &&
             (st = newfile_open(r->path, &n, e)) == ST_OK &&
             (st = admin_copy(r->backup, n.part, &what, &end, e)) == ST_OK &&
             (st = admin_verify(n.part, &opens, &found, e)) == ST_OK && !dry &&
             (st = admin_swap(r->path, r->held, &n, aside, e)) == ST_OK &&
             r->key->anchor != NULL)
        st = log_anchor_write(r->key->anchor, what.crypt, &end, true, e);
    newfile_close(&n);
    free(aside);
    free(usual);
    return st;
}

enum status admin_restore(const char *path, const char *from, const struct store_key *key,
                          const char *from_key, const char *actor, bool dry,
                          struct admin_restored *out, struct errinfo *e)
{
    struct restoring r = {
        .path = path, .from = from, .key = key, .from_key = from_key, .out = out};
    enum status st;

    memset(out, 0, sizeof *out);
    if (sql_file_same(path, from))
        return errinfo_set(e, ST_EINVAL, "%.160s is the database itself", from);
    if ((st = log_act(&r.by, actor, e)) == ST_OK &&
        (st = open_held(&r, dry, e)) == ST_OK && (st = open_backup(&r, e)) == ST_OK &&
        (st = relate(&r, e)) == ST_OK)
        st = copy_and_place(&r, dry, e);
    store_close(r.backup);
    store_close(r.held);
    crypt_free(r.made);
    free(r.since);
    return st;
}

/* ---- as it is */

/* Each subject's templates are those that there are. */
static enum status accept_templates(struct log_txn *t, struct errinfo *e)
{
    struct store_subject *page = NULL;
    struct rows_subject of;
    int64_t after = 0;
    size_t n;
    enum status st;

    while ((st = rows_subject_list(t, after, PAGE, &page, &n, e)) == ST_OK && n > 0) {
        for (size_t i = 0; i < n && st == ST_OK; i++)
            if ((st = rows_subject_get(t, page[i].uid, &of, e)) == ST_OK)
                st = rows_template_accept(t, &of, e);
        after = page[n - 1].key;
        free(page);
        if (st != ST_OK)
            break;
    }
    sodium_memzero(&of, sizeof of);
    return st;
}

static enum status accept_rows(struct log_txn *t, const struct log_act *by,
                               store_report *report, void *arg,
                               struct admin_accepted *out, struct errinfo *e)
{
    char outcome[LOG_TEXT + 1];
    unsigned char sum[LOG_DIGEST];
    uint64_t orphans = 0, twins = 0, bad = 0;
    bool same = false;
    enum status st;

    if ((st = rows_digest_clear(t, report, arg, &out->removed, e)) != ST_OK ||
        (st = sql_file_reindex(t->sql, e)) != ST_OK ||
        (st = rows_digest_orphans(t, report, arg, &orphans, e)) != ST_OK ||
        (st = rows_digest_twice(t, report, arg, &twins, e)) != ST_OK ||
        (st = rows_digest(t, NULL, NULL, sum, &bad, e)) != ST_OK ||
        (st = log_txn_agrees(t, sum, &same, e)) != ST_OK)
        return st;
    if (twins > 0) /* which of them is right nobody can say */
        return errinfo_set(e, ST_ECORRUPT,
                           "two rows have what only one may have: restore a backup");
    out->removed += orphans;
    out->differed = !same;
    if (!same)
        report(arg, rows_digest_problem);
    log_txn_accept(t, sum);
    if ((st = accept_templates(t, e)) != ST_OK)
        return st;
    (void)snprintf(outcome, sizeof outcome, "%s, %" PRIu64 " rows removed",
                   same ? "rows as written" : "rows differed", out->removed);
    return log_change(t, by, "accept_state", NULL, "", outcome, e);
}

enum status admin_accept(const char *path, const struct store_key *key, const char *actor,
                         bool dry, store_report *report, void *arg,
                         struct admin_accepted *out, struct errinfo *e)
{
    struct store_key by_key = *key;
    struct log_end end = {.seq = 0};
    struct log_act by;
    struct log_txn t;
    struct store *s;
    enum status st;

    memset(out, 0, sizeof *out);
    by_key.anchor = NULL;
    if ((st = store_open(path, STORE_ALONE, &by_key, &s, e)) != ST_OK)
        return st;
    atomic_store(&s->verified, true); /* what is found is accepted */
    if ((st = store_act_begin(s, actor, SQL_WRITE, &by, &t, e)) == ST_OK) {
        st = accept_rows(&t, &by, report, arg, out, e);
        end = t.changes;
        if (st == ST_OK && dry)
            (void)store_end(s, &t, ST_EDENIED, NULL); /* rolled back */
        else
            st = store_end(s, &t, st, e);
    }
    if (st == ST_OK && !dry && key->anchor != NULL)
        st = log_anchor_write(key->anchor, s->crypt, &end, true, e);
    store_close(s);
    return st;
}
