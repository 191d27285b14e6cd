/* sql_file.h -- functions for a database in a file.  A server does these things by itself, or cannot do
 * them.  Errors as in sql.h.  On a server a compaction is ST_EINVAL, sql_file_copy() must not be called, and
 * the others do nothing. */
#ifndef DB_SQL_FILE_H
#define DB_SQL_FILE_H
#include "sql.h"

/* sql_file_in_use(path, pid): Returns true if another process has the database open, and sets *pid to the id
 * of one such process, or to 0 if unknown.  This process must not have the database open. */
bool sql_file_in_use(const char *path, int64_t *pid);

/* sql_file_has_wal(path): Returns true if the file has a WAL or a journal that is not empty. */
bool sql_file_has_wal(const char *path);

/* sql_file_may_be(path, e): Checks that a new file may get the name path.  ST_EEXISTS: there is a WAL or a
 * journal of that name, by which SQLite would change the new file. */
enum status sql_file_may_be(const char *path, struct errinfo *e);

/* sql_file_same(a, b): Returns true if both paths lead to one file. */
bool sql_file_same(const char *a, const char *b);

/* sql_file_is(t): Returns true if the database is in a file. */
bool sql_file_is(const struct sql_txn *t);

/* sql_file_in_place(t, e): Returns ST_EREFUSED if the file was moved, removed or replaced since it was
 * opened; ST_EIO if that cannot be found out for now. */
enum status sql_file_in_place(struct sql_txn *t, struct errinfo *e);

/* sql_file_forget(t): Discards what SQLite remembers of the file, pages and schema.  t then sees a page that
 * was changed behind SQLite's back, and all other connections see it from their next transaction on. */
void sql_file_forget(struct sql_txn *t);

/* sql_file_check(t, report, arg, e): Checks pages, indexes and references.  Calls report() once for each
 * problem. */
enum status sql_file_check(struct sql_txn *t, sql_report *report, void *arg,
                           struct errinfo *e);

/* sql_file_reindex(t, e): Rebuilds every index from its table.  ST_EDB: a UNIQUE index cannot be built. */
enum status sql_file_reindex(struct sql_txn *t, struct errinfo *e);

/* sql_file_copy(t, path, e): Copies all that t sees to an existing empty file, which then needs no WAL.  Does
 * not flush it. */
enum status sql_file_copy(struct sql_txn *t, const char *path, struct errinfo *e);

/* sql_file_fold(d, e): Makes the database one file without a WAL.  d was opened by SQL_OPEN_ALONE. */
enum status sql_file_fold(struct sql *d, struct errinfo *e);

/* sql_file_compact(d, e): Rewrites every page (VACUUM): no free pages are left, and no bytes but those of
 * rows.  Other processes can read meanwhile; writers wait, up to 5 s. */
enum status sql_file_compact(struct sql *d, struct errinfo *e);

/* sql_file_scrub(d, ms): Removes deleted bytes from the WAL, after they were overwritten in the pages: runs a
 * checkpoint, truncates the WAL and flushes it.  Waits up to ms for readers.  If a reader is in the way
 * longer, the end of each following write tries again. */
void sql_file_scrub(struct sql *d, int ms);

/* sql_file_scrub_later(d): Lets the end of the next write do that. */
void sql_file_scrub_later(struct sql *d);

#endif
