#include "admin_backup.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "admin_copy.h"
#include "newfile.h"
#include "rows_template.h"
#include "sql_file.h"
#include "store_audit.h"
#include "store_txn.h"

#define PAGE 1000

/* ---- verifying */

struct verifying {
    struct errinfo first; /* problem */
    struct admin_copied *found;
};

static void problem(void *arg, const char *line)
{
    struct verifying *v = arg;

    if (v->first.code == ST_OK)
        (void)errinfo_set(&v->first, ST_ECORRUPT, "%s", line);
}

static enum status count_template(void *arg, const struct rows_template *row,
                                  const struct rows_subject *of, const void *face,
                                  size_t len, struct errinfo *e)
{
    struct verifying *v = arg;

    (void)row;
    (void)of;
    (void)face;
    (void)len;
    (void)e;
    v->found->templates++;
    return ST_OK;
}

static enum status verify_subjects(struct log_txn *t, struct admin_copied *found,
                                   struct errinfo *e)
{
    struct store_subject *page = NULL;
    int64_t after = 0;
    size_t n;
    enum status st;

    while ((st = rows_subject_list(t, after, PAGE, &page, &n, e)) == ST_OK && n > 0) {
        found->subjects += n;
        after = page[n - 1].key;
        free(page);
    }
    return st;
}

static void audit_problem(void *arg, enum log_name log, uint64_t seq, const char *line)
{
    char text[240];

    (void)snprintf(text, sizeof text, "audit log, %s, entry %" PRIu64 ": %s",
                   log_word(log), seq, line);
    problem(arg, text);
}

static enum status verify_rows(struct log_txn *t, struct verifying *v, struct errinfo *e)
{
    enum status st;

    if ((st = sql_file_check(t->sql, problem, v, e)) != ST_OK ||
        (st = verify_subjects(t, v->found, e)) != ST_OK ||
        (st = rows_template_each(t, 0, 1, count_template, problem, v, e)) != ST_OK)
        return st;
    return sql_file_bytes(t->sql, &v->found->bytes, e);
}

enum status admin_verify_store(struct store *s, struct admin_copied *found,
                               struct errinfo *e)
{
    struct verifying v = {.found = found};
    struct log_walk walk;
    struct log_txn t;
    enum status st;

    memset(found, 0, sizeof *found);
    if ((st = store_begin(s, SQL_READ, &t, e)) != ST_OK ||
        (st = store_end(s, &t, verify_rows(&t, &v, e), e)) != ST_OK ||
        (st = store_audit_verify(s, audit_problem, &v, &walk, e)) != ST_OK)
        return st;
    found->events = walk.entries;
    return v.first.code == ST_OK ? ST_OK : errinfo_set(e, ST_ECORRUPT, "%s", v.first.msg);
}

enum status admin_verify(const char *path, const struct store_key *key,
                         struct admin_copied *found, struct errinfo *e)
{
    struct store_key by = *key;
    struct errinfo why = {ST_OK, ""};
    struct store *s;
    enum status st;

    memset(found, 0, sizeof *found);
    by.anchor = NULL; /* a copy is older than the database */
    if ((st = store_open(path, STORE_READ, &by, &s, e)) != ST_OK)
        return st;
    st = admin_verify_store(s, found, &why);
    store_close(s);
    return st == ST_OK ? st : errinfo_set(e, st, "the copy is of no use: %s", why.msg);
}

/* ---- a backup */

/* What is there may be replaced if it is a database of this program, and not this one; nor
 * one with a WAL, which SQLite would take for the backup's. */
static enum status replaceable(const char *path, const char *db, struct errinfo *e)
{
    struct sql *d = NULL;
    struct stat there;
    enum status st;

    if (stat(path, &there) != 0)
        return ST_OK;
    if (sql_file_same(path, db))
        return errinfo_set(e, ST_EINVAL, "%.160s is the database itself", path);
    if (sql_file_has_wal(path))
        return errinfo_set(e, ST_EEXISTS,
                           "%.160s is a database in use, or was when its program was "
                           "killed: it has a %.160s-wal",
                           path, path);
    st = S_ISREG(there.st_mode) ? sql_open(path, SQL_OPEN_LOOK, &d, NULL) : ST_EINVAL;
    sql_close(d);
    return st == ST_OK
               ? ST_OK
               : errinfo_set(e, ST_EEXISTS,
                             "%.160s exists and is not a backup: it is not overwritten",
                             path);
}

enum status admin_backup(struct store *s, const char *path, const struct store_key *key,
                         struct admin_copied *out, struct errinfo *e)
{
    char *const usual = admin_name(s->path, ".key");
    struct store_key by = *key;
    struct newfile n = NEWFILE_NONE;
    struct log_txn t;
    enum status st;

    if (usual == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    if (by.path == NULL)
        by.path = usual;
    if ((st = store_begin(s, SQL_READ, &t, e)) != ST_OK) {
        free(usual);
        return st;
    }
    if ((st = replaceable(path, s->path, e)) == ST_OK &&
        (st = newfile_open(path, &n, e)) == ST_OK)
        st = sql_file_copy(t.sql, n.part, e);
    st = store_end(s, &t, st, e);
    if (st == ST_OK && (st = admin_verify(n.part, &by, out, e)) == ST_OK)
        st = newfile_commit(&n, e);
    newfile_close(&n);
    free(usual);
    return st;
}
