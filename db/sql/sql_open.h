/* sql_open.h -- a database, opened by the driver that it takes. */
#ifndef DB_SQL_OPEN_H
#define DB_SQL_OPEN_H
#include "sql.h"

/* sql_open_is_url(where): is it postgresql://..., and not a file?
 * sql_open(where, how, out, e): a file or a URL.  ST_ENOTFOUND: there is none; ST_ECORRUPT: another program's;
 * ST_EVERSION: of a newer version than this program's; ST_EBUSY: SQL_OPEN_ALONE, and another
 * process has it open.  ST_EINVAL: a URL with a password. */
bool sql_open_is_url(const char *where);
enum status sql_open(const char *where, enum sql_open how, struct sql **out,
                     struct errinfo *e);

#endif
