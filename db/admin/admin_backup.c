#include "admin_backup.h"

#include <sys/stat.h>

#include "newfile.h"
#include "sql_file.h"
#include "store_txn.h"

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
    struct newfile n = NEWFILE_NONE;
    struct store *copy;
    struct log_txn t;
    enum status st;

    if ((st = store_begin(s, SQL_READ, &t, e)) != ST_OK)
        return st;
    if ((st = replaceable(path, s->path, e)) == ST_OK &&
        (st = newfile_open(path, &n, e)) == ST_OK)
        st = sql_file_copy(t.sql, n.part, e);
    st = store_end(s, &t, st, e);
    if (st == ST_OK && (st = admin_open(n.part, key, NULL, &copy, out, e)) == ST_OK) {
        store_close(copy);
        st = newfile_commit(&n, e);
    }
    newfile_close(&n);
    return st;
}
