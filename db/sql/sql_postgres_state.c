#include "sql_postgres_state.h"

#include <string.h>

/* ST_EBUSY: the next attempt may succeed, on a new connection if this one is not kept.
 * ST_EIO, ST_ENOMEM: the server lacks disk, memory or a permission; its operator can help.
 * ST_ECORRUPT: the server has found damage, or its tables are not those of the schema.
 * ST_EDB: the request fails, and says nothing of the next: a value, a constraint, a limit, a trigger or
 * function that is not ours, a defect of the server.
 * A connection is kept only if a rollback alone makes it good: its prepared statements, its session and
 * its process are then known to be as they were.  A code stands before its class. */
static const struct sql_postgres_state table[] = {
    /* the connection, its session and its prepared statements */
    {"08", ST_EBUSY, false},
    {"0A", ST_EBUSY, false}, /* cached plan must not change result type */
    {"0B", ST_EBUSY, false},
    {"24", ST_EBUSY, false},
    {"25", ST_EBUSY, false}, /* timeouts, a failed transaction, a standby */
    {"26", ST_EBUSY, false},
    {"2D", ST_EBUSY, false},
    {"34", ST_EBUSY, false},
    {"3B", ST_EBUSY, false},
    {"42P03", ST_EBUSY, false}, /* a cursor of this name exists */
    {"42P05", ST_EBUSY, false}, /* a prepared statement of this name exists */
    /* other transactions, the operator */
    {"40", ST_EBUSY, true},
    {"53300", ST_EBUSY, false},
    {"55P03", ST_EBUSY, true}, /* lock_timeout */
    {"55", ST_EBUSY, false},
    {"57014", ST_EBUSY, true}, /* a statement was cancelled */
    {"57", ST_EBUSY, false},
    {"72", ST_EBUSY, true},
    /* resources, permissions */
    {"28", ST_EIO, false},
    {"3D", ST_EIO, false},
    {"3F", ST_EIO, false},
    {"42501", ST_EIO, false},
    {"53200", ST_ENOMEM, false},
    {"53", ST_EIO, false},
    {"58", ST_EIO, false},
    {"F0", ST_EIO, false},
    /* damage, other tables */
    {"42", ST_ECORRUPT, false},
    {"XX001", ST_ECORRUPT, false},
    {"XX002", ST_ECORRUPT, false},
    /* values, constraints */
    {"22", ST_EDB, true},
    {"23", ST_EDB, true},
    {"", ST_EDB,
     false}, /* the other classes, among them those of success and of code that is not ours */
};

const struct sql_postgres_state *sql_postgres_state_of(const char *code)
{
    const struct sql_postgres_state *s = table;

    while (strncmp(code, s->code, strlen(s->code)) != 0)
        s++;
    return s;
}
