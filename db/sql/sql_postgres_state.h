/* sql_postgres_state.h -- the SQLSTATEs of PostgreSQL (its manual, Appendix A): each gives the status of
 * the transaction, and decides if its connection is used again. */
#ifndef DB_SQL_POSTGRES_STATE_H
#define DB_SQL_POSTGRES_STATE_H
#include <stdbool.h>
#include "status.h"

struct sql_postgres_state {
    const char *code; /* an SQLSTATE, or its first two characters: a class */
    enum status st;
    bool keep; /* false: the connection is closed after the transaction */
};

/* sql_postgres_state_of(code): Returns the row of this SQLSTATE, else of its class.  The row of an
 * unknown class has ST_EDB and keep false. */
const struct sql_postgres_state *sql_postgres_state_of(const char *code);

#endif
