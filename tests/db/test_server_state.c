/* What each SQLSTATE of PostgreSQL 15 means: a case for each class that differs from the unknown ones, and
 * for each code that differs from its class. */
#include "sql_postgres_state.h"
#include "unit.h"

static const struct {
    const char *code;
    enum status st;
    bool keep;
} wanted[] = {
    {"08006", ST_EBUSY, false}, /* connection exception: failure */
    {"08P01", ST_EBUSY, false}, /* protocol violation */
    {"0A000", ST_EBUSY, false}, /* feature not supported: a cached plan's result type */
    {"0B000", ST_EBUSY, false}, /* invalid transaction initiation */
    {"22012", ST_EDB, true},    /* data exception: division by zero */
    {"23505", ST_EDB, true},    /* integrity constraint violation: unique */
    {"24000", ST_EBUSY, false}, /* invalid cursor state */
    {"25006", ST_EBUSY, false}, /* invalid transaction state: read only */
    {"25P02", ST_EBUSY, false}, /* in failed transaction */
    {"25P03", ST_EBUSY, false}, /* idle in transaction timeout */
    {"26000", ST_EBUSY, false}, /* invalid SQL statement name */
    {"28P01", ST_EIO, false},   /* invalid authorization: password */
    {"2D000", ST_EBUSY, false}, /* invalid transaction termination */
    {"34000", ST_EBUSY, false}, /* invalid cursor name */
    {"3B001", ST_EBUSY, false}, /* savepoint exception */
    {"3D000", ST_EIO, false},   /* invalid catalog name */
    {"3F000", ST_EIO, false},   /* invalid schema name */
    {"40001", ST_EBUSY, true},  /* transaction rollback: serialization failure */
    {"40P01", ST_EBUSY, true},  /* deadlock */
    {"42P01", ST_ECORRUPT, false}, /* undefined table */
    {"42703", ST_ECORRUPT, false}, /* undefined column */
    {"42883", ST_ECORRUPT, false}, /* undefined function */
    {"42601", ST_ECORRUPT, false}, /* syntax error */
    {"42501", ST_EIO, false},      /* insufficient privilege */
    {"42P03", ST_EBUSY, false},    /* duplicate cursor */
    {"42P05", ST_EBUSY, false},    /* duplicate prepared statement */
    {"53100", ST_EIO, false},      /* insufficient resources: disk full */
    {"53200", ST_ENOMEM, false},   /* out of memory */
    {"53300", ST_EBUSY, false},    /* too many connections */
    {"53400", ST_EIO, false},      /* configuration limit exceeded */
    {"54000", ST_EDB, false},      /* program limit exceeded */
    {"55000", ST_EBUSY, false},    /* object not in prerequisite state */
    {"55P03", ST_EBUSY, true},     /* lock not available */
    {"57014", ST_EBUSY, true},     /* operator intervention: query cancelled */
    {"57P01", ST_EBUSY, false},    /* admin shutdown */
    {"57P02", ST_EBUSY, false},    /* crash shutdown */
    {"57P03", ST_EBUSY, false},    /* cannot connect now */
    {"57P04", ST_EBUSY, false},    /* database dropped */
    {"57P05", ST_EBUSY, false},    /* idle session timeout */
    {"58030", ST_EIO, false},      /* system error: I/O */
    {"72000", ST_EBUSY, true},     /* snapshot too old */
    {"F0000", ST_EIO, false},      /* configuration file error */
    {"P0001", ST_EDB, false},      /* PL/pgSQL error: raised by a function */
    {"XX001", ST_ECORRUPT, false}, /* data corrupted */
    {"XX002", ST_ECORRUPT, false}, /* index corrupted */
    {"ZZ999", ST_EDB, false},      /* none */
    {"", ST_EDB, false},
};

TEST(test_states)
{
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++) {
        const struct sql_postgres_state *is = sql_postgres_state_of(wanted[i].code);

        if (is->st != wanted[i].st || is->keep != wanted[i].keep)
            fail_msg("%s: status %d, kept %d", wanted[i].code, is->st, is->keep);
    }
}
