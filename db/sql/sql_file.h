/* sql_file.h -- what a database in a file can do and one behind a server cannot, or does by
 * itself.  Errors as in sql.h; on a server there is no copy, a compaction is ST_EINVAL, and the rest does
 * nothing. */
#ifndef DB_SQL_FILE_H
#define DB_SQL_FILE_H
#include <stdbool.h>
#include <stdint.h>
#include "status.h"

struct errinfo;
struct sql;
struct sql_txn;

/* sql_file_in_use(path, pid): has another process the database open?  *pid: one that has, 0
 * where that is not known.  Not while this process has it open.
 * sql_file_has_wal(path): is there a WAL of the database, or a journal, with something in it?
 * sql_file_may_be(path, e): may another file get that name?  ST_EEXISTS: there is one, by which SQLite
 * would change that file.
 * sql_file_same(a, b): are they one file, under whatever names? */
bool sql_file_in_use(const char *path, int64_t *pid);
bool sql_file_has_wal(const char *path);
enum status sql_file_may_be(const char *path, struct errinfo *e);
bool sql_file_same(const char *a, const char *b);

/* sql_file_is(t): is the database in a file? */
bool sql_file_is(const struct sql_txn *t);

/* sql_file_in_place(t, e): Returns ST_EREFUSED if the file was moved, removed or replaced since it was
 * opened; ST_EIO if that cannot be found out for now. */
enum status sql_file_in_place(struct sql_txn *t, struct errinfo *e);

/* sql_file_forget(t): what t reads from here on is read from the file, not from memory: a page that
 * was changed behind SQLite's back is seen.  So do all other connections, from their next transaction
 * on: none keeps a page or a schema that others do not see any more. */
void sql_file_forget(struct sql_txn *t);

/* sql_file_check(t, report, arg, e): pages, indexes, references; report() is called once a
 * problem with a line of text. */
enum status sql_file_check(struct sql_txn *t, void (*report)(void *arg, const char *line),
                           void *arg, struct errinfo *e);

/* sql_file_reindex(t, e): every index built again from its table.  ST_EDB: a UNIQUE one cannot. */
enum status sql_file_reindex(struct sql_txn *t, struct errinfo *e);

/* sql_file_copy(t, path, e): all that t sees, into a file that is there and empty: one file
 * without a WAL.  It is not on the disk yet.
 * sql_file_fold(d, e): as one file without a WAL; SQL_OPEN_ALONE. */
enum status sql_file_copy(struct sql_txn *t, const char *path, struct errinfo *e);
enum status sql_file_fold(struct sql *d, struct errinfo *e);

/* sql_file_compact(d, e): every page rewritten (VACUUM), without free ones and with nothing
 * in them but rows.  Others read meanwhile; writers wait, up to 5 s. */
enum status sql_file_compact(struct sql *d, struct errinfo *e);

/* sql_file_scrub(d, ms): deleted bytes, which were overwritten in the database's pages, leave
 * the WAL too: a checkpoint, the WAL truncated, and that on the disk.  Readers are waited for
 * as long as ms; if one is still in the way, the end of each following write tries again.
 * sql_file_scrub_later(d): the end of the next write tries. */
void sql_file_scrub(struct sql *d, int ms);
void sql_file_scrub_later(struct sql *d);

#endif
