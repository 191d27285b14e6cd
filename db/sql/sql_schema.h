/* sql_schema.h -- the schema of SQLite databases: schema.sql, embedded. */
#ifndef DB_SQL_SCHEMA_H
#define DB_SQL_SCHEMA_H

/* sql_schema_text(): the statements.  sql_schema_newest(): their version. */
const char *sql_schema_text(void);
int sql_schema_newest(void);

#endif
