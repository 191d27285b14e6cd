#include "admin_backup.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "admin_check.h"
#include "admin_copy.h"
#include "newfile.h"
#include "sql_file.h"
#include "store_txn.h"

/* ---- verifying */

static void keep_first(void *arg, const char *line)
{
    struct errinfo *first = arg;

    if (first->code == ST_OK)
        (void)errinfo_set(first, ST_ECORRUPT, "%s", line);
}

enum status admin_verify_store(struct store *s, struct admin_copied *found,
                               struct errinfo *e)
{
    struct errinfo first = {ST_OK, ""};
    struct store_stats stats;
    struct admin_check check;
    enum status st;

    memset(found, 0, sizeof *found);
    if ((st = admin_check(s, false, keep_first, &first, &check, e)) != ST_OK)
        return st;
    if (first.code != ST_OK)
        return errinfo_set(e, ST_ECORRUPT, "%s", first.msg);
    if ((st = store_stats(s, &stats, e)) == ST_OK)
        *found = (struct admin_copied){stats.subjects, stats.templates, stats.events,
                                       stats.file_bytes};
    return st;
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
