#include "store_backup.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "errinfo.h"
#include "newfile.h"
#include "row_template.h"
#include "sql_file.h"
#include "store_check.h"
#include "store_open.h"
#include "store_subject.h"
#include "store_txn.h"
#include "store_walk.h"

#define PAGE 1000

/* ---- verifying */

struct verifying {
    struct errinfo first; /* problem */
    struct store_copied *found;
};

static void problem(void *arg, const char *line)
{
    struct verifying *v = arg;

    if (v->first.code == ST_OK)
        (void)errinfo_set(&v->first, ST_ECORRUPT, "%s", line);
}

/* What the template's key authenticates is as it was written. */
static enum status count_template(void *arg, const struct store_template *t,
                                  const void *model, size_t len, struct errinfo *e)
{
    struct verifying *v = arg;

    (void)t;
    (void)model;
    (void)len;
    (void)e;
    v->found->templates++;
    return ST_OK;
}

static enum status verify_subjects(struct store *s, struct store_copied *found,
                                   struct errinfo *e)
{
    struct store_subject *page = NULL;
    int64_t after = 0;
    size_t n;
    enum status st;

    while ((st = store_subject_list(s, after, PAGE, &page, &n, e)) == ST_OK && n > 0) {
        found->subjects += n;
        after = page[n - 1].key;
        free(page);
    }
    return st;
}

static void audit_problem(void *arg, enum store_chain chain, uint64_t seq,
                          const char *line)
{
    char text[240];

    (void)snprintf(text, sizeof text, "audit log, %s, entry %" PRIu64 ": %s",
                   store_chain_word(chain), seq, line);
    problem(arg, text);
}

static enum status verify_store(struct store *s, struct store_copied *found,
                                struct errinfo *e)
{
    struct verifying v = {.found = found};
    struct store_audit audit = {0};
    struct store_txn t;
    enum status st;

    if ((st = store_check_rows(s, problem, &v, e)) != ST_OK ||
        (st = verify_subjects(s, found, e)) != ST_OK ||
        (st = row_template_each(s, 0, 1, count_template, problem, &v, e)) != ST_OK ||
        (st = store_audit_verify(s, audit_problem, &v, &audit, e)) != ST_OK ||
        (st = store_txn_begin(s, SQL_READ, &t, e)) != ST_OK)
        return st;
    found->events = audit.entries;
    st = store_txn_end(&t, sql_file_bytes(t.sql, &found->bytes, e), e);
    if (st == ST_OK && v.first.code != ST_OK)
        st = errinfo_set(e, ST_ECORRUPT, "%s", v.first.msg);
    return st;
}

enum status store_backup_verify(const char *path, const struct store_key *key,
                                struct store_copied *found, struct errinfo *e)
{
    struct store_key by = {.make = VAULT_FILE};
    struct errinfo why = {ST_OK, ""};
    struct store *s;
    enum status st;

    memset(found, 0, sizeof *found);
    if (key != NULL)
        by = *key;
    by.copy = true;
    if ((st = store_open(path, STORE_READ, &by, &s, e)) != ST_OK)
        return st;
    st = verify_store(s, found, &why);
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
                             "%.160s is there and no backup: it is not overwritten",
                             path);
}

enum status store_backup(struct store *s, const char *path, const struct store_key *key,
                         struct store_copied *out, struct errinfo *e)
{
    struct newfile n = NEWFILE_NONE;
    struct store_txn t;
    enum status st;

    if ((st = store_txn_begin(s, SQL_READ, &t, e)) != ST_OK)
        return st;
    if ((st = replaceable(path, s->path, e)) == ST_OK &&
        (st = newfile_open(path, &n, e)) == ST_OK)
        st = sql_file_copy(t.sql, n.part, e);
    st = store_txn_end(&t, st, e);
    if (st == ST_OK && (st = store_backup_verify(n.part, key, out, e)) == ST_OK)
        st = newfile_commit(&n, e);
    newfile_close(&n);
    return st;
}
