/* sql_open.h -- opens a database by the driver for it. */
#ifndef DB_SQL_OPEN_H
#define DB_SQL_OPEN_H
#include "sql.h"

/* sql_open_is_url(where): Returns true if `where` is the URL of a database on a server, postgresql://..., and
 * not a file. */
bool sql_open_is_url(const char *where);

/* sql_open(where, how, out, e): Opens the database of a file or of a URL.
 *   out  the database, to be released by sql_close(); NULL after a failure
 * ST_ENOTFOUND: there is none; ST_ECORRUPT: it is another program's; ST_EVERSION: its schema is newer than
 * this program; ST_EBUSY: SQL_OPEN_ALONE, and another process has it open; ST_EINVAL: the URL has a
 * password. */
enum status sql_open(const char *where, enum sql_open how, struct sql **out,
                     struct errinfo *e);

#endif
