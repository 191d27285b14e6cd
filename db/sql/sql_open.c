#include "sql_open.h"

#include "errinfo.h"
#include "sql_sqlite.h"
#ifdef WITH_POSTGRES
#include "sql_postgres.h"
#endif

bool sql_open_is_url(const char *where)
{
    return strncmp(where, "postgresql://", 13) == 0 ||
           strncmp(where, "postgres://", 11) == 0;
}

enum status sql_open(const char *where, enum sql_open how, struct sql **out,
                     struct errinfo *e)
{
    *out = NULL;
    if (!sql_open_is_url(where))
        return sql_sqlite_open(where, how, out, e);
#ifdef WITH_POSTGRES
    return sql_postgres_open(where, how, out, e);
#else
    return errinfo_set(e, ST_EINVAL, "this program was built without PostgreSQL");
#endif
}
