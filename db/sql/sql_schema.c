#include "sql_schema.h"

#include "schema_sql.h"

const char *sql_schema_text(void)
{
    return schema_sql;
}

int sql_schema_newest(void)
{
    return 1;
}
